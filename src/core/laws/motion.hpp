// SPDX-License-Identifier: BSD-3-Clause
// What all laws need of a displacement gradient, for lanes or for dual numbers. Everything is
// formed from H, never from F = I + H and its like minus I: at rest nothing is left to cancel.
#pragma once

#include "dual.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// What a law shall keep an eye on while it runs over the points of a batch.
template <class R> struct Watch {
    R least_J = R{} + static_cast<Scalar<R>>(1e30), least_at = R{};
    R greatest_exponent = R{} - static_cast<Scalar<R>>(1e30), greatest_at = R{};
    R point = R{}; // where it is now

    BEZSOMA_INLINE void jacobian(const R &J) { // written so that what is no number is seen
        least_at = J > least_J ? least_at : point;
        least_J = J > least_J ? least_J : J;
    }
    BEZSOMA_INLINE void exponent(const R &x) {
        greatest_at = x < greatest_exponent ? greatest_at : point;
        greatest_exponent = x < greatest_exponent ? greatest_exponent : x;
    }
};

/// exp(x), watched.
template <class S, class R> BEZSOMA_INLINE S watched_exp(const S &x, Watch<R> &watch) {
    watch.exponent(value(x));
    return exp(x);
}

/// F = I + H at finite strain. H row after row: H_kl = du_k/dx_l.
template <class S> struct Motion {
    S H[3][3];
    S cof[3][3]; // J F^-T
    S N[3][3];   // J (F - F^-T)
    S j;         // J - 1
    S inverse;   // 1 / J
    S trace;     // tr E, E = (H + H^T + H^T H) / 2

    template <class R> BEZSOMA_INLINE Motion(const S *gradient, Watch<R> &watch) {
        for (int k = 0; k < 9; ++k)
            H[k / 3][k % 3] = gradient[k];
        const S tr = H[0][0] + H[1][1] + H[2][2];
        S minor[3][3]; // cof H
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                const int a = (k + 1) % 3, b = (k + 2) % 3, c = (l + 1) % 3, d = (l + 2) % 3;
                minor[k][l] = H[a][c] * H[b][d] - H[a][d] * H[b][c];
            }
        // J = 1 + tr H + tr cof H + det H
        const S second = minor[0][0] + minor[1][1] + minor[2][2];
        const S higher =
            second + H[0][0] * minor[0][0] + H[0][1] * minor[0][1] + H[0][2] * minor[0][2];
        j = tr + higher;
        inverse = reciprocal(j + Plain<S>(1));
        S square = H[0][0] * H[0][0];
        for (int k = 1; k < 9; ++k)
            square += H[k / 3][k % 3] * H[k / 3][k % 3];
        trace = tr + square * half();
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                cof[k][l] = minor[k][l] - H[l][k];
                N[k][l] = (H[k][l] + H[l][k]) + (j * H[k][l] - minor[k][l]);
                if (k == l) {
                    cof[k][l] = cof[k][l] + (tr + Plain<S>(1));
                    N[k][l] += higher;
                }
            }
        watch.jacobian(value(j) + 1);
    }

    static constexpr Plain<S> half() { return Plain<S>(0.5); }

    /// Green's strain E, 2 E_kl for k != l not doubled: XX YY ZZ XY YZ ZX.
    BEZSOMA_INLINE void green(S (&E)[6]) const {
        for (int c = 0; c < 6; ++c) {
            const int k = c % 3, l = c < 3 ? k : (k + 1) % 3;
            E[c] = (H[k][l] + H[l][k] + H[0][k] * H[0][l] + H[1][k] * H[1][l] + H[2][k] * H[2][l]) *
                   half();
        }
    }

    /// P = F S for a symmetric S: XX YY ZZ XY YZ ZX.
    BEZSOMA_INLINE void pushed(const S (&s)[6], S *P) const {
        constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l)
                P[3 * k + l] = s[of[k][l]] + H[k][0] * s[of[0][l]] + H[k][1] * s[of[1][l]] +
                               H[k][2] * s[of[2][l]];
    }
};

/// I2(E) = ((tr E)^2 - E:E) / 2.
template <class S> BEZSOMA_INLINE S second_invariant(const S (&E)[6]) {
    return E[0] * E[1] + E[1] * E[2] + E[2] * E[0] - (E[3] * E[3] + E[4] * E[4] + E[5] * E[5]);
}

/// What an isotropic law needs of a motion: J - 1, 1/J, tr E and I2(E).
template <class S> struct Invariants {
    S j, inverse, trace, second;
};

/// ln J.
template <class R> BEZSOMA_INLINE R log_J(const Invariants<R> &x) { return log1p(x.j); }
template <class R> BEZSOMA_INLINE Dual<R> log_J(const Invariants<Dual<R>> &x) {
    return {log1p(x.j.v), x.j.d * x.inverse.v};
}

/// An isotropic law: P = shear J (F - F^-T) + volume J F^-T + turned F (tr E I - E).
template <class S> struct Weights {
    S shear, volume, turned;
};

/// A motion with its change. A derivative is not small at rest, so F may stand here as it is.
template <class R> struct Changing {
    R F[3][3], dF[3][3], cof[3][3], dcof[3][3]; // cof = J F^-T
    Dual<R> j;                                  // J - 1

    BEZSOMA_INLINE Changing(const R *H, const R *dH) {
        for (int k = 0; k < 9; ++k) {
            F[k / 3][k % 3] = k % 4 ? H[k] : H[k] + 1;
            dF[k / 3][k % 3] = dH[k];
        }
        j = {R{} - 1, R{}};
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                const int a = (k + 1) % 3, b = (k + 2) % 3, c = (l + 1) % 3, d = (l + 2) % 3;
                cof[k][l] = F[a][c] * F[b][d] - F[a][d] * F[b][c];
                dcof[k][l] = crossed(F, dF, k, l);
                j.d += cof[k][l] * dF[k][l];
            }
        for (int l = 0; l < 3; ++l)
            j.v += F[0][l] * cof[0][l];
    }

    /// Entry kl of A x B, the form of which A x A = 2 cof A is the square.
    static BEZSOMA_INLINE R crossed(const R (&A)[3][3], const R (&B)[3][3], int k, int l) {
        const int a = (k + 1) % 3, b = (k + 2) % 3, c = (l + 1) % 3, d = (l + 2) % 3;
        return A[a][c] * B[b][d] - A[a][d] * B[b][c] + B[a][c] * A[b][d] - B[a][d] * A[b][c];
    }

    template <bool second> BEZSOMA_INLINE Invariants<Dual<R>> invariants() const {
        using T = Scalar<R>;
        Dual<R> trace = {R{} - T(1.5), R{}}, I2 = {R{} - T(0.75), R{}};
        for (int k = 0; k < 9; ++k) {
            const R &f = F[k / 3][k % 3], half = f * T(0.5);
            trace += {half * f, f * dF[k / 3][k % 3]};
        }
        if constexpr (second) { // I2(C) = cof:cof = 3 + 4 tr E + 4 I2(E)
            for (int k = 0; k < 9; ++k) {
                const R quarter = cof[k / 3][k % 3] * T(0.25);
                I2 += {quarter * cof[k / 3][k % 3], (quarter + quarter) * dcof[k / 3][k % 3]};
            }
            I2 = I2 - trace;
        }
        return {j, reciprocal(j + T(1)), trace, I2};
    }

    /// The change of P, with F (tr E I - E) = cof x F / 2 - F.
    template <bool turns> BEZSOMA_INLINE void weighted(const Weights<Dual<R>> &w, R *dP) const {
        using T = Scalar<R>;
        const Dual<R> volume = w.volume - w.shear, half = w.turned * T(0.5);
        Dual<R> plain = w.shear * (j + T(1));
        if constexpr (turns)
            plain = plain - w.turned;
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                R found = plain.d * F[k][l] + plain.v * dF[k][l];
                found += volume.d * cof[k][l] + volume.v * dcof[k][l];
                if constexpr (turns)
                    found += half.d * crossed(cof, F, k, l) +
                             half.v * (crossed(dcof, F, k, l) + crossed(cof, dF, k, l));
                dP[3 * k + l] = found;
            }
    }
};

/// The change of a stress, by dual numbers.
template <class Law, bool mixed, class T, class R>
BEZSOMA_INLINE void by_duals(const T *par, int n, const R *state, const R *change, R *found,
                             Watch<R> &watch) {
    constexpr int components = Law::components + mixed;
    Dual<R> x[components], answer[components];
    for (int c = 0; c < components; ++c)
        x[c] = {state[c], change[c]};
    Law::template stress<mixed>(par, n, x, answer, watch);
    for (int c = 0; c < components; ++c)
        found[c] = answer[c].d;
}

} // namespace bezsoma::BEZSOMA_ISA
