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

    /// The change dP of P for a change dH of H: dual numbers where they are the law's, by hand
    /// between those and P, where they would work out much that has no change.
    template <bool mixed, class T, class R>
    static BEZSOMA_INLINE void derivative(const T *par, int n, const R *H, const R *dH, R *dP,
                                          Watch<R> &watch) {
        if constexpr (weighs_F()) {
            const Changing<R> x(H, dH);
            const Weights<Dual<R>> w = Law::weights(par, x.invariants(), watch);
            Dual<R> volume = w.volume - w.shear;
            if constexpr (Law::splits)
                volume += changing_pressure<mixed>(par, H, dH, x.j, dP);
            x.weighted(w.shear * (x.j + T(1)), volume, dP);
        } else {
            const Squared<R> x(H, dH);
            Dual<R> s[6];
            if constexpr (Law::of_invariants) {
                isochoric_stress<Law>(par, x, s, watch);
            } else {
                Dual<R> E[6];
                for (int c = 0; c < 6; ++c)
                    E[c] = c < 3 ? x.C[c] * T(0.5) - T(0.5) : x.C[c] * T(0.5);
                Law::second_piola(par, n, E, s, watch);
            }
            if constexpr (Law::splits)
                x.swollen(changing_pressure<mixed>(par, H, dH, x.j(), dP), s);
            x.pushed(s, dP);
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
    /// Whether P is a sum of F and J F^-T.
    static constexpr bool weighs_F() {
        if constexpr (Law::of_invariants)
            return !Law::turns;
        return false;
    }

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

    template <bool mixed, class T, class R>
    static BEZSOMA_INLINE Dual<R> changing_pressure(const T *par, const R *H, const R *dH,
                                                    const Dual<R> &j, R *dP) {
        Dual<R> state[10], answer[10];
        if constexpr (mixed)
            state[9] = {H[9], dH[9]};
        const Dual<R> found = pressure<mixed>(par, state, j, answer);
        if constexpr (mixed)
            dP[9] = answer[9].d;
        return found;
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
        const Roots<S> of = roots(x);
        const S a = of.squared * of.inverse * par[1];
        return {a, a * x.trace * T(-2.0 / 3), S{}};
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, const Invariants<R> &x, Watch<R> &) {
        return first_isochoric(x, log_J(x)) * (par[1] / 2);
    }
};

/// P of an energy of both isochoric invariants whose derivatives by them are w1 and w2:
///   2 w1 J^(-2/3) (F - I1/3 F^-T) + 2 w2 J^(-4/3) (I1 F - F C - 2/3 I2 F^-T)
/// with C = I + 2 E, so that nothing cancels at rest.
template <class S, class W1, class W2>
BEZSOMA_INLINE Weights<S> isochoric_weights(const Invariants<S> &x, const Roots<S> &of,
                                            const W1 &w1, const W2 &w2) {
    using T = Plain<S>;
    const S turned = of.squared * of.squared * (w2 * T(4));
    const S one = of.squared * of.inverse * (w1 * T(2)), two = turned * of.inverse;
    return {one + two, one * x.trace * T(-2.0 / 3) - two * (x.trace + x.second) * T(4.0 / 3),
            turned};
}

/// The change of its S, with C and its cofactors.
template <class Law, class T, class R>
BEZSOMA_INLINE void isochoric_stress(const T *par, const Squared<R> &x, Dual<R> (&s)[6],
                                     Watch<R> &watch) {
    const R square = x.root * x.root;
    const Dual<R> I1 = x.C[0] + x.C[1] + x.C[2], I2 = x.K[0] + x.K[1] + x.K[2];
    const Dual<R> a = x.power(2, square);
    const auto w1 = Law::first_slope(par, a * I1 - T(3), watch);
    const Dual<R> one = a * (w1 * T(2));
    const Dual<R> two = x.power(4, square * square * (Law::second_slope(par) * 2));
    const Dual<R> plain = one + two * I1;
    const Dual<R> mean = (one * I1 + two * I2 * T(2)) * T(-1.0 / 3);
    const Dual<R> weight = mean * x.power(6, x.inverse * x.inverse);
    for (int c = 0; c < 6; ++c) {
        s[c] = c < 3 ? plain : Dual<R>{};
        s[c].v = c < 3 ? plain.v - two.v * x.C[c].v : -two.v * x.C[c].v;
        s[c].v += weight.v * x.K[c].v;
        s[c].d = c < 3 ? plain.d - two.d * x.C[c].v : -two.d * x.C[c].v;
        s[c].d -= two.v * x.C[c].d;
        s[c].d += weight.d * x.K[c].v;
        s[c].d += weight.v * x.K[c].d;
    }
}

/// A law of both isochoric invariants says the derivatives of its energy by them, the second of
/// which does not change.
template <class Law> struct Isochoric {
    static constexpr bool splits = true, of_invariants = true, turns = true;

    template <class T, class S, class R>
    static BEZSOMA_INLINE Weights<S> weights(const T *par, const Invariants<S> &x,
                                             Watch<R> &watch) {
        const Roots<S> of = roots(x);
        const S first = (of.squared - T(1)) * T(3) + of.squared * x.trace * T(2);
        return isochoric_weights(x, of, Law::first_slope(par, first, watch),
                                 Law::second_slope(par));
    }
};

/// c1 (I1bar - 3) + c2 (I2bar - 3); parameters kappa, c1, c2.
struct MooneyRivlin : Isochoric<MooneyRivlin> {
    template <class T, class S, class R>
    static BEZSOMA_INLINE T first_slope(const T *par, const S &, Watch<R> &) {
        return par[1];
    }
    template <class T> static T second_slope(const T *par) { return par[2]; }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, const Invariants<R> &x, Watch<R> &) {
        const R log = log_J(x);
        return first_isochoric(x, log) * par[1] + second_isochoric(x, log) * par[2];
    }
};

/// c1 (exp(c2 (I1bar - 3)) - 1) - c1 c2/2 (I2bar - 3); parameters kappa, c1, c2.
struct VerondaWestmann : Isochoric<VerondaWestmann> {
    template <class T, class S, class R>
    static BEZSOMA_INLINE S first_slope(const T *par, const S &first, Watch<R> &watch) {
        return watched_exp(first * par[2], watch) * (par[1] * par[2]);
    }
    template <class T> static T second_slope(const T *par) { return -par[1] * par[2] / 2; }

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

    /// E:half, half being linear in E.
    template <class R> static BEZSOMA_INLINE R square(const R (&E)[6], const R (&half)[6]) {
        R normal = E[0] * half[0], shear = E[3] * half[3];
        for (int c = 1; c < 3; ++c) {
            normal += E[c] * half[c];
            shear += E[3 + c] * half[3 + c];
        }
        return normal + 2 * shear;
    }
    template <class R>
    static BEZSOMA_INLINE Dual<R> square(const Dual<R> (&E)[6], const Dual<R> (&half)[6]) {
        R strain[6], change[6], by[6];
        for (int c = 0; c < 6; ++c) {
            strain[c] = E[c].v;
            change[c] = E[c].d;
            by[c] = half[c].v;
        }
        return {square(strain, by), 2 * square(change, by)};
    }

    /// Q, and half its derivative by E.
    template <class T, class S>
    static BEZSOMA_INLINE S exponent(const T *par, const S (&E)[6], S (&half)[6]) {
        constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        const T *f = par + 5, across = par[4] - par[3], along = par[2] + par[3] - 2 * par[4];
        S z[3];
        for (int k = 0; k < 3; ++k)
            z[k] = E[of[k][0]] * f[0] + E[of[k][1]] * f[1] + E[of[k][2]] * f[2];
        const S more = (z[0] * f[0] + z[1] * f[1] + z[2] * f[2]) * (along / 2);
        for (int k = 0; k < 3; ++k)
            z[k] = z[k] * across + more * f[k];
        for (int c = 0; c < 6; ++c) {
            const int k = c % 3, l = c < 3 ? k : (k + 1) % 3;
            if (c < 3)
                half[c] = E[c] * par[3] + z[k] * (2 * f[k]);
            else
                half[c] = E[c] * par[3] + z[k] * f[l] + z[l] * f[k];
        }
        return square(E, half);
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
