// SPDX-License-Identifier: BSD-3-Clause
// Laws at finite strain: P = dW/dF from the displacement gradient H = F - I.
//
// Laws that split have an isochoric energy plus a volume: kappa/2 (J - 1)^2, or mixed
// - p (J - 1) - p^2/(2 kappa). They say the first, the frame here adds the second.
#pragma once

#include "motion.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// Law says isochoric(par, n, motion, P, watch) and energy(par, n, motion, watch); one that does
/// not split says all of its stress there.
template <class Law> struct FiniteStrain {
    static constexpr bool finite = true, has_energy = true, splits = Law::splits;
    static constexpr int components = 9;

    template <bool mixed, class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int n, const S *H, S *P, Watch<R> &watch) {
        const Motion<S> motion(H, watch);
        Law::stress(par, n, motion, P, watch);
        if constexpr (Law::splits) {
            S pressure;
            if constexpr (mixed) {
                pressure = -H[9];
                P[9] = -motion.j - H[9] * (1 / par[0]);
            } else {
                pressure = motion.j * par[0];
            }
            for (int k = 0; k < 9; ++k)
                P[k] += pressure * motion.cof[k / 3][k % 3];
        }
    }

    template <bool mixed, class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int n, const R *H, Watch<R> &watch) {
        const Motion<R> motion(H, watch);
        const R stored = Law::energy(par, n, motion, watch);
        if constexpr (!Law::splits)
            return stored;
        else if constexpr (mixed)
            return stored - H[9] * (motion.j + H[9] * (1 / (2 * par[0])));
        else
            return stored + motion.j * motion.j * (par[0] / 2);
    }
};

/// lambda/2 (tr E)^2 + mu E:E; parameters kappa, mu, lambda = kappa - 2 mu / 3.
struct StVenantKirchhoff {
    static constexpr bool splits = false;

    template <class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int, const Motion<S> &x, S *P, Watch<R> &) {
        S s[6];
        x.green(s);
        const S volume = x.trace * (par[0] - 2 * par[1] / 3);
        for (int c = 0; c < 6; ++c)
            s[c] = s[c] * (2 * par[1]);
        for (int c = 0; c < 3; ++c)
            s[c] += volume;
        x.pushed(s, P);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const Motion<R> &x, Watch<R> &) {
        R E[6];
        x.green(E);
        const R square = x.trace * x.trace; // E:E = (tr E)^2 - 2 I2(E)
        return square * (par[0] / 2 + 2 * par[1] / 3) - second_invariant(E) * (2 * par[1]);
    }
};

/// mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2; parameters kappa, mu.
struct NeoHooke {
    static constexpr bool splits = false;

    template <class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int, const Motion<S> &x, S *P, Watch<R> &) {
        const S shear = x.inverse * par[1];
        const S volume = log_J(x) * x.inverse * (par[0] - 2 * par[1] / 3);
        for (int k = 0; k < 9; ++k)
            P[k] = shear * x.N[k / 3][k % 3] + volume * x.cof[k / 3][k % 3];
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const Motion<R> &x, Watch<R> &) {
        const R log = log_J(x);
        return (x.trace - log) * par[1] + log * log * ((par[0] - 2 * par[1] / 3) / 2);
    }
};

/// J^(-2/3) I1 - 3 and J^(-4/3) I2 - 3, from log J.
template <class S> BEZSOMA_INLINE S first_isochoric(const Motion<S> &x, const S &log) {
    using T = Plain<S>;
    const S a = expm1(log * T(-2.0 / 3));
    return a * T(3) + (a + T(1)) * x.trace * T(2);
}
template <class S>
BEZSOMA_INLINE S second_isochoric(const Motion<S> &x, const S &I2, const S &log) {
    using T = Plain<S>;
    const S a = expm1(log * T(-4.0 / 3));
    return a * T(3) + (a + T(1)) * (x.trace + I2) * T(4);
}

/// mu/2 (J^(-2/3) I1 - 3); parameters kappa, mu.
struct NeoHookeIsochoric {
    static constexpr bool splits = true;

    template <class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int, const Motion<S> &x, S *P, Watch<R> &) {
        const S a = exp(log_J(x) * T(-5.0 / 3)) * par[1];
        const S b = x.trace * T(2.0 / 3);
        for (int k = 0; k < 9; ++k)
            P[k] = a * (x.N[k / 3][k % 3] - b * x.cof[k / 3][k % 3]);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const Motion<R> &x, Watch<R> &) {
        return first_isochoric(x, log_J(x)) * (par[1] / 2);
    }
};

/// P of an energy of both isochoric invariants whose derivatives by them are w1 and w2:
///   2 w1 J^(-2/3) (F - I1/3 F^-T) + 2 w2 J^(-4/3) (I1 F - F C - 2/3 I2 F^-T)
/// with C = I + 2 E, so that nothing cancels at rest. `a` is J^(-2/3).
template <class S>
BEZSOMA_INLINE void isochoric_stress(const Motion<S> &x, const S (&E)[6], const S &I2, const S &a,
                                     const S &w1, const S &w2, S *P) {
    using T = Plain<S>;
    const S J = x.j + T(1), first = a * x.inverse * T(2), second = first * a * w2;
    const S shear = first * w1 + second * T(2);
    const S volume = first * w1 * x.trace * T(-2.0 / 3) - second * (x.trace + I2) * T(8.0 / 3);
    const S turned = second * J * T(2);
    S s[6];
    for (int c = 0; c < 6; ++c)
        s[c] = c < 3 ? turned * (x.trace - E[c]) : -turned * E[c];
    x.pushed(s, P);
    for (int k = 0; k < 9; ++k)
        P[k] += shear * x.N[k / 3][k % 3] + volume * x.cof[k / 3][k % 3];
}

/// c1 (I1bar - 3) + c2 (I2bar - 3); parameters kappa, c1, c2.
struct MooneyRivlin {
    static constexpr bool splits = true;

    template <class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int, const Motion<S> &x, S *P, Watch<R> &) {
        S E[6], w1 = {}, w2 = {};
        x.green(E);
        isochoric_stress(x, E, second_invariant(E), exp(log_J(x) * T(-2.0 / 3)), w1 + par[1],
                         w2 + par[2], P);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const Motion<R> &x, Watch<R> &) {
        R E[6];
        x.green(E);
        const R log = log_J(x);
        return first_isochoric(x, log) * par[1] +
               second_isochoric(x, second_invariant(E), log) * par[2];
    }
};

/// c1 (exp(c2 (I1bar - 3)) - 1) - c1 c2/2 (I2bar - 3); parameters kappa, c1, c2.
struct VerondaWestmann {
    static constexpr bool splits = true;

    template <class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int, const Motion<S> &x, S *P,
                                      Watch<R> &watch) {
        S E[6], w2 = {};
        x.green(E);
        const S a = exp(log_J(x) * T(-2.0 / 3));
        const S first = (a - T(1)) * T(3) + a * x.trace * T(2);
        const S w1 = watched_exp(first * par[2], watch) * (par[1] * par[2]);
        isochoric_stress(x, E, second_invariant(E), a, w1, w2 + (-par[1] * par[2] / 2), P);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const Motion<R> &x, Watch<R> &watch) {
        R E[6];
        x.green(E);
        const R log = log_J(x), exponent = first_isochoric(x, log) * par[2];
        watch.exponent(exponent);
        return expm1(exponent) * par[1] -
               second_isochoric(x, second_invariant(E), log) * (par[1] * par[2] / 2);
    }
};

/// C/2 (exp Q - 1), Q = sum_ij b_ij E_ij^2 in the frame of the fibres; parameters kappa, C, bf, bt,
/// bfs and the rows f, s, n of that frame.
struct Guccione {
    static constexpr bool splits = true;

    /// The strain in the frame of the fibres (both indices turned), and Q.
    template <class T, class S>
    static BEZSOMA_INLINE S in_frame(const T *par, const Motion<S> &x, S (&E)[6]) {
        S plain[6];
        x.green(plain);
        turned<false>(par + 5, plain, E);
        return E[0] * E[0] * par[2] + (E[1] * E[1] + E[2] * E[2] + E[4] * E[4] * T(2)) * par[3] +
               (E[3] * E[3] + E[5] * E[5]) * (2 * par[4]);
    }

    /// R E R^T, or R^T E R for `back`.
    template <bool back, class T, class S>
    static BEZSOMA_INLINE void turned(const T *frame, const S (&from)[6], S (&to)[6]) {
        constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        const auto r = [&](int k, int l) { return back ? frame[3 * l + k] : frame[3 * k + l]; };
        S half[3][3];
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l)
                half[k][l] =
                    from[of[0][l]] * r(k, 0) + from[of[1][l]] * r(k, 1) + from[of[2][l]] * r(k, 2);
        for (int c = 0; c < 6; ++c) {
            const int k = c % 3, l = c < 3 ? k : (k + 1) % 3;
            to[c] = half[k][0] * r(l, 0) + half[k][1] * r(l, 1) + half[k][2] * r(l, 2);
        }
    }

    template <class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int, const Motion<S> &x, S *P,
                                      Watch<R> &watch) {
        S E[6], s[6], back[6];
        const S g = watched_exp(in_frame(par, x, E), watch) * par[1];
        const T b[6] = {par[2], par[3], par[3], par[4], par[3], par[4]};
        for (int c = 0; c < 6; ++c)
            s[c] = g * E[c] * b[c];
        turned<true>(par + 5, s, back);
        x.pushed(back, P);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const Motion<R> &x, Watch<R> &watch) {
        R E[6];
        const R Q = in_frame(par, x, E);
        watch.exponent(Q);
        return expm1(Q) * (par[1] / 2);
    }
};

} // namespace bezsoma::BEZSOMA_ISA
