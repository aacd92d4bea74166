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

/// J^(-2/3) and 1/J.
template <class S> struct Roots {
    S squared, inverse;
};
template <class R> BEZSOMA_INLINE Roots<R> roots(const Invariants<R> &x) {
    const R root = reciprocal_cube_root(x.j + 1), squared = root * root;
    return {squared, squared * root};
}
template <class R> BEZSOMA_INLINE Roots<Dual<R>> roots(const Invariants<Dual<R>> &x) {
    using T = Scalar<R>;
    const Roots<R> of = roots(Invariants<R>{x.j.v, {}, {}, {}});
    const R log = of.inverse * x.j.d; // the change of ln J
    return {{of.squared, of.squared * log * T(-2.0 / 3)}, {of.inverse, -of.inverse * log}};
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
                dcof[k][l] = F[a][c] * dF[b][d] - F[a][d] * dF[b][c] + dF[a][c] * F[b][d] -
                             dF[a][d] * F[b][c];
                j.d += cof[k][l] * dF[k][l];
            }
        for (int l = 0; l < 3; ++l)
            j.v += F[0][l] * cof[0][l];
    }

    /// But for I2.
    BEZSOMA_INLINE Invariants<Dual<R>> invariants() const {
        using T = Scalar<R>;
        Dual<R> trace = {R{} - T(1.5), R{}};
        for (int k = 0; k < 9; ++k) {
            const R &f = F[k / 3][k % 3];
            trace.v += f * (f * T(0.5));
            trace.d += f * dF[k / 3][k % 3];
        }
        return {j, reciprocal(j + T(1)), trace, Dual<R>{}};
    }

    /// The change of plain F + volume J F^-T.
    BEZSOMA_INLINE void weighted(const Dual<R> &plain, const Dual<R> &volume, R *dP) const {
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) { // one by one: products and sums fuse
                R found = plain.d * F[k][l];
                found += plain.v * dF[k][l];
                found += volume.d * cof[k][l];
                found += volume.v * dcof[k][l];
                dP[3 * k + l] = found;
            }
    }
};

/// The same for P = F S: symmetric tensors XX YY ZZ XY YZ ZX in place of F's nine.
template <class R> struct Squared {
    R F[3][3], dF[3][3];
    Dual<R> C[6], K[6]; // F^T F and its cofactors, J^2 C^-1
    R J, root, inverse; // J^(-1/3), 1/J
    R log;              // the change of ln J

    BEZSOMA_INLINE Squared(const R *H, const R *dH) {
        for (int k = 0; k < 9; ++k) {
            F[k / 3][k % 3] = k % 4 ? H[k] : H[k] + 1;
            dF[k / 3][k % 3] = dH[k];
        }
        for (int c = 0; c < 6; ++c) {
            const int k = c % 3, l = c < 3 ? k : (k + 1) % 3;
            C[c].v = F[0][k] * F[0][l] + F[1][k] * F[1][l] + F[2][k] * F[2][l];
            C[c].d = F[0][k] * dF[0][l] + F[1][k] * dF[1][l] + F[2][k] * dF[2][l];
            if (c < 3)
                C[c].d += C[c].d;
            else
                C[c].d = C[c].d + dF[0][k] * F[0][l] + dF[1][k] * F[1][l] + dF[2][k] * F[2][l];
        }
        constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        for (int c = 0; c < 6; ++c) {
            const int k = c % 3, l = c < 3 ? k : (k + 1) % 3;
            K[c] = difference(C[of[(k + 1) % 3][(l + 1) % 3]], C[of[(k + 2) % 3][(l + 2) % 3]],
                              C[of[(k + 1) % 3][(l + 2) % 3]], C[of[(k + 2) % 3][(l + 1) % 3]]);
        }
        J = F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]);
        J += F[0][1] * (F[1][2] * F[2][0] - F[1][0] * F[2][2]);
        J += F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]);
        root = reciprocal_cube_root(J);
        inverse = root * root * root;
        R shear = K[3].v * C[3].d, twice = K[0].v * C[0].d;
        for (int c = 1; c < 3; ++c) {
            shear += K[3 + c].v * C[3 + c].d;
            twice += K[c].v * C[c].d;
        }
        log = (twice * Scalar<R>(0.5) + shear) * (inverse * inverse);
    }

    /// J - 1, with its change.
    BEZSOMA_INLINE Dual<R> j() const { return {J - 1, J * log}; }

    /// `value` = factor J^(-k/3), with its change.
    BEZSOMA_INLINE Dual<R> power(int k, const R &value) const {
        return {value, value * log * Scalar<R>(-k / 3.0)};
    }

    /// Adds volume J C^-1.
    BEZSOMA_INLINE void swollen(const Dual<R> &volume, Dual<R> (&s)[6]) const {
        const Dual<R> weight = volume * power(3, inverse);
        for (int c = 0; c < 6; ++c) {
            s[c].v += weight.v * K[c].v;
            s[c].d += weight.d * K[c].v;
            s[c].d += weight.v * K[c].d;
        }
    }

    /// The change of F S.
    BEZSOMA_INLINE void pushed(const Dual<R> (&s)[6], R *dP) const {
        constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                R found = F[k][0] * s[of[0][l]].d;
                found += F[k][1] * s[of[1][l]].d;
                found += F[k][2] * s[of[2][l]].d;
                found += dF[k][0] * s[of[0][l]].v;
                found += dF[k][1] * s[of[1][l]].v;
                found += dF[k][2] * s[of[2][l]].v;
                dP[3 * k + l] = found;
            }
    }

private:
    /// a b - c d
    static BEZSOMA_INLINE Dual<R> difference(const Dual<R> &a, const Dual<R> &b, const Dual<R> &c,
                                             const Dual<R> &d) {
        return {a.v * b.v - c.v * d.v, a.v * b.d + a.d * b.v - c.v * d.d - c.d * d.v};
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
