// SPDX-License-Identifier: BSD-3-Clause
// Laws at finite strain: P = dW/dF from the displacement gradient H = F - I.
//
// Laws that split have an isochoric energy plus a volume: kappa/2 (J - 1)^2, or mixed
// - p (J - 1) - p^2/(2 kappa). They say the first, the frame here adds the second.
#pragma once

#include "motion.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// A law is one function of numbers, with or without their change. One `of_invariants` says the
/// weights of P (Weights); others say S from Green's strain, and P = F S.
template <class Law> struct FiniteStrain {
    static constexpr bool finite = true, has_energy = true, splits = Law::splits;
    static constexpr int components = 9;

    template <bool mixed, class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int n, const S *H, S *P, Watch<R> &watch) {
        const Motion<S> x(H, watch);
        S volume = {}, E[6], s[6];
        if constexpr (Law::of_invariants) {
            const Weights<S> w = Law::weights(par, invariants(x), watch);
            volume = w.volume;
            for (int k = 0; k < 9; ++k)
                P[k] = w.shear * x.N[k / 3][k % 3];
            if constexpr (Law::turns) {
                x.green(E);
                for (int c = 0; c < 6; ++c)
                    s[c] = c < 3 ? w.turned * (x.trace - E[c]) : -w.turned * E[c];
                S more[9];
                x.pushed(s, more);
                for (int k = 0; k < 9; ++k)
                    P[k] += more[k];
            }
        } else {
            x.green(E);
            Law::second_piola(par, n, E, s, watch);
            x.pushed(s, P);
        }
        if constexpr (Law::splits)
            volume += pressure<mixed>(par, H, x.j, P);
        if constexpr (Law::of_invariants || Law::splits)
            for (int k = 0; k < 9; ++k)
                P[k] += volume * x.cof[k / 3][k % 3];
    }

    /// The change dP of P for a change dH of H: by dual numbers, but for what stands between the
    /// weights and P, where these would work out much that has no change.
    template <bool mixed, class T, class R>
    static BEZSOMA_INLINE void derivative(const T *par, int n, const R *H, const R *dH, R *dP,
                                          Watch<R> &watch) {
        if constexpr (Law::of_invariants) {
            const Changing<R> x(H, dH);
            Weights<Dual<R>> w = Law::weights(par, x.template invariants<Law::turns>(), watch);
            if constexpr (Law::splits) {
                Dual<R> state[10], answer[10];
                if constexpr (mixed)
                    state[9] = {H[9], dH[9]};
                w.volume += pressure<mixed>(par, state, x.j, answer);
                if constexpr (mixed)
                    dP[9] = answer[9].d;
            }
            x.template weighted<Law::turns>(w, dP);
        } else {
            by_duals<FiniteStrain, mixed>(par, n, H, dH, dP, watch);
        }
    }

    template <bool mixed, class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int n, const R *H, Watch<R> &watch) {
        const Motion<R> x(H, watch);
        R stored, E[6];
        if constexpr (Law::of_invariants) {
            stored = Law::energy(par, invariants(x), watch);
        } else {
            x.green(E);
            stored = Law::energy(par, n, E, watch);
        }
        if constexpr (!Law::splits)
            return stored;
        else if constexpr (mixed)
            return stored - H[9] * (x.j + H[9] * (1 / (2 * par[0])));
        else
            return stored + x.j * x.j * (par[0] / 2);
    }

private:
    /// kappa (J - 1), or mixed - p and c at P[9].
    template <bool mixed, class T, class S>
    static BEZSOMA_INLINE S pressure(const T *par, const S *H, const S &j, S *P) {
        if constexpr (mixed) {
            P[9] = -j - H[9] * (1 / par[0]);
            return -H[9];
        } else {
            return j * par[0];
        }
    }

    template <class S> static BEZSOMA_INLINE Invariants<S> invariants(const Motion<S> &x) {
        Invariants<S> of = {x.j, x.inverse, x.trace, S{}};
        if constexpr (Law::of_invariants && Law::turns) {
            S E[6];
            x.green(E);
            of.second = second_invariant(E);
        }
        return of;
    }
};

/// lambda/2 (tr E)^2 + mu E:E; parameters kappa, mu, lambda = kappa - 2 mu / 3.
struct StVenantKirchhoff {
    static constexpr bool splits = false, of_invariants = false;

    template <class T, class S, class R>
    static BEZSOMA_INLINE void second_piola(const T *par, int, const S (&E)[6], S (&s)[6],
                                            Watch<R> &) {
        const S volume = (E[0] + E[1] + E[2]) * (par[0] - 2 * par[1] / 3);
        for (int c = 0; c < 6; ++c)
            s[c] = E[c] * (2 * par[1]);
        for (int c = 0; c < 3; ++c)
            s[c] += volume;
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const R (&E)[6], Watch<R> &) {
        const R tr = E[0] + E[1] + E[2]; // E:E = (tr E)^2 - 2 I2(E)
        return tr * tr * (par[0] / 2 + 2 * par[1] / 3) - second_invariant(E) * (2 * par[1]);
    }
};

/// mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2; parameters kappa, mu.
struct NeoHooke {
    static constexpr bool splits = false, of_invariants = true, turns = false;

    template <class T, class S, class R>
    static BEZSOMA_INLINE Weights<S> weights(const T *par, const Invariants<S> &x, Watch<R> &) {
        return {x.inverse * par[1], log_J(x) * x.inverse * (par[0] - 2 * par[1] / 3), S{}};
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, const Invariants<R> &x, Watch<R> &) {
        const R log = log_J(x);
        return (x.trace - log) * par[1] + log * log * ((par[0] - 2 * par[1] / 3) / 2);
    }
};

/// J^(-2/3) I1 - 3 and J^(-4/3) I2 - 3, from log J.
template <class S> BEZSOMA_INLINE S first_isochoric(const Invariants<S> &x, const S &log) {
    using T = Plain<S>;
    const S a = expm1(log * T(-2.0 / 3));
    return a * T(3) + (a + T(1)) * x.trace * T(2);
}
template <class S> BEZSOMA_INLINE S second_isochoric(const Invariants<S> &x, const S &log) {
    using T = Plain<S>;
    const S a = expm1(log * T(-4.0 / 3));
    return a * T(3) + (a + T(1)) * (x.trace + x.second) * T(4);
}

/// mu/2 (J^(-2/3) I1 - 3); parameters kappa, mu.
struct NeoHookeIsochoric {
    static constexpr bool splits = true, of_invariants = true, turns = false;

    template <class T, class S, class R>
    static BEZSOMA_INLINE Weights<S> weights(const T *par, const Invariants<S> &x, Watch<R> &) {
        const S a = exp(log_J(x) * T(-5.0 / 3)) * par[1];
        return {a, a * x.trace * T(-2.0 / 3), S{}};
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, const Invariants<R> &x, Watch<R> &) {
        return first_isochoric(x, log_J(x)) * (par[1] / 2);
    }
};

/// P of an energy of both isochoric invariants whose derivatives by them are w1 and w2:
///   2 w1 J^(-2/3) (F - I1/3 F^-T) + 2 w2 J^(-4/3) (I1 F - F C - 2/3 I2 F^-T)
/// with C = I + 2 E, so that nothing cancels at rest. `a` is J^(-2/3).
template <class S>
BEZSOMA_INLINE Weights<S> isochoric_weights(const Invariants<S> &x, const S &a, const S &w1,
                                            const S &w2) {
    using T = Plain<S>;
    const S first = a * x.inverse * T(2), one = first * w1, two = first * a * w2;
    return {one + two * T(2), one * x.trace * T(-2.0 / 3) - two * (x.trace + x.second) * T(8.0 / 3),
            two * (x.j + T(1)) * T(2)};
}

/// c1 (I1bar - 3) + c2 (I2bar - 3); parameters kappa, c1, c2.
struct MooneyRivlin {
    static constexpr bool splits = true, of_invariants = true, turns = true;

    template <class T, class S, class R>
    static BEZSOMA_INLINE Weights<S> weights(const T *par, const Invariants<S> &x, Watch<R> &) {
        const S zero = {};
        return isochoric_weights(x, exp(log_J(x) * T(-2.0 / 3)), zero + par[1], zero + par[2]);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, const Invariants<R> &x, Watch<R> &) {
        const R log = log_J(x);
        return first_isochoric(x, log) * par[1] + second_isochoric(x, log) * par[2];
    }
};

/// c1 (exp(c2 (I1bar - 3)) - 1) - c1 c2/2 (I2bar - 3); parameters kappa, c1, c2.
struct VerondaWestmann {
    static constexpr bool splits = true, of_invariants = true, turns = true;

    template <class T, class S, class R>
    static BEZSOMA_INLINE Weights<S> weights(const T *par, const Invariants<S> &x,
                                             Watch<R> &watch) {
        const S zero = {}, a = exp(log_J(x) * T(-2.0 / 3));
        const S first = (a - T(1)) * T(3) + a * x.trace * T(2);
        const S w1 = watched_exp(first * par[2], watch) * (par[1] * par[2]);
        return isochoric_weights(x, a, w1, zero - par[1] * par[2] / 2);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, const Invariants<R> &x, Watch<R> &watch) {
        const R log = log_J(x), exponent = first_isochoric(x, log) * par[2];
        watch.exponent(exponent);
        return expm1(exponent) * par[1] - second_isochoric(x, log) * (par[1] * par[2] / 2);
    }
};

/// C/2 (exp Q - 1); parameters kappa, C, bf, bt, bfs and the unit vector f along the fibres.
///   Q = bf Eff^2 + bt (Ess^2 + Enn^2 + 2 Esn^2) + 2 bfs (Efs^2 + Efn^2)
///     = bt E:E + 2 (bfs - bt) |E f|^2 + (bf + bt - 2 bfs) (f.E f)^2
/// for whichever two s and n stand across f.
struct Guccione {
    static constexpr bool splits = true, of_invariants = false;

    /// Q, and half its derivative by E.
    template <class T, class S>
    static BEZSOMA_INLINE S exponent(const T *par, const S (&E)[6], S (&half)[6]) {
        constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        const T *f = par + 5, across = par[4] - par[3], along = par[2] + par[3] - 2 * par[4];
        S Ef[3];
        for (int k = 0; k < 3; ++k)
            Ef[k] = E[of[k][0]] * f[0] + E[of[k][1]] * f[1] + E[of[k][2]] * f[2];
        const S stretch = Ef[0] * f[0] + Ef[1] * f[1] + Ef[2] * f[2], more = stretch * along;
        S Q = {};
        for (int c = 0; c < 6; ++c) {
            const int k = c % 3, l = c < 3 ? k : (k + 1) % 3;
            half[c] = E[c] * par[3] + (Ef[k] * f[l] + Ef[l] * f[k]) * across + more * (f[k] * f[l]);
            Q += E[c] * half[c] * T(c < 3 ? 1 : 2);
        }
        return Q;
    }

    template <class T, class S, class R>
    static BEZSOMA_INLINE void second_piola(const T *par, int, const S (&E)[6], S (&s)[6],
                                            Watch<R> &watch) {
        const S g = watched_exp(exponent(par, E, s), watch) * par[1];
        for (int c = 0; c < 6; ++c)
            s[c] = g * s[c];
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const R (&E)[6], Watch<R> &watch) {
        R half[6];
        const R Q = exponent(par, E, half);
        watch.exponent(Q);
        return expm1(Q) * (par[1] / 2);
    }
};

} // namespace bezsoma::BEZSOMA_ISA
