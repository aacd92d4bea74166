// SPDX-License-Identifier: BSD-3-Clause
// Ogden's law in principal stretches, which may coincide:
//
//   W = sum_i mu_i/alpha_i (lbar_1^alpha_i + lbar_2^alpha_i + lbar_3^alpha_i - 3)
//
// With l_a^2 = 1 + 2 e_a, e_a and q_a the eigenvalues and eigenvectors of Green's strain,
//
//   S = sum_a s_a q_a q_a^T,  s_a = b_a / l_a^2,  b_a = dW/d ln l_a = sum_i mu_i (z_ia - mean_b
//   z_ib)
//
// and z_ia = lbar_a^alpha_i - 1. The change of S has the divided differences (s_a - s_b) /
// (l_a^2 - l_b^2) off the diagonal of that frame (Daleckii and Krein 1965); they are formed so that
// equal stretches are no special case.
#pragma once

#include "finite_strain.hpp"

namespace bezsoma::BEZSOMA_ISA {

template <class R> struct Eigen {
    R value[3], vector[3][3]; // vector[k][a]: component k of the a-th
};

/// Whether any lane of x is true.
template <class I> BEZSOMA_INLINE bool any(const I &x) {
    bool found = false;
    for (unsigned l = 0; l < sizeof(I) / sizeof(x[0]); ++l)
        found |= x[l] != 0;
    return found;
}

/// Jacobi's rotations, all lanes together until the last is diagonal.
template <class R> BEZSOMA_INLINE Eigen<R> eigen(const R (&of)[6]) {
    using T = Scalar<R>;
    constexpr T tiny = sizeof(T) == 8 ? T(1e-150) : T(1e-18),
                done = sizeof(T) == 8 ? T(1e-34) : T(1e-16);
    R a[3][3] = {{of[0], of[3], of[5]}, {of[3], of[1], of[4]}, {of[5], of[4], of[2]}};
    R v[3][3] = {};
    for (int k = 0; k < 3; ++k)
        v[k][k] = R{} + 1;
    for (int sweep = 0; sweep < 8; ++sweep) {
        const R off = a[0][1] * a[0][1] + a[1][2] * a[1][2] + a[2][0] * a[2][0];
        const R on = a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2];
        if (!any(off > on * done + tiny * tiny))
            break;
#pragma GCC unroll 3
        for (int r = 0; r < 3; ++r) { // r is the axis turned about
            const int p = (r + 1) % 3, q = (r + 2) % 3;
            // cos and sin of twice the angle, then of the angle: none is near zero.
            const R d = a[q][q] - a[p][p], right = abs(d) + tiny;
            const R up = d < 0 ? -a[p][q] : a[p][q];
            const R length = reciprocal_root(right * right + 4 * (up * up));
            const R cc = right * length * T(0.5) + T(0.5), per_c = reciprocal_root(cc);
            const R c = cc * per_c, s = up * length * per_c, t = s * per_c;
            a[p][p] -= t * a[p][q];
            a[q][q] += t * a[p][q];
            a[p][q] = a[q][p] = R{};
            const R x = a[r][p], y = a[r][q];
            a[r][p] = a[p][r] = c * x - s * y;
            a[r][q] = a[q][r] = s * x + c * y;
            for (int k = 0; k < 3; ++k) {
                const R left = v[k][p], right = v[k][q];
                v[k][p] = c * left - s * right;
                v[k][q] = s * left + c * right;
            }
        }
    }
    Eigen<R> found;
    for (int k = 0; k < 3; ++k) {
        found.value[k] = a[k][k];
        for (int l = 0; l < 3; ++l)
            found.vector[k][l] = v[k][l];
    }
    return found;
}

/// sinh(y) / y for |y| below 1.3 or so.
template <int i, class R> BEZSOMA_INLINE R sinh_quotient(const R &yy) {
    constexpr auto here = static_cast<Scalar<R>>(inverse_factorial(2 * i + 1));
    if constexpr (i == 9)
        return R{} + here;
    else
        return sinh_quotient<i + 1>(yy) * yy + here;
}

/// Parameters kappa and n pairs mu_i, alpha_i.
struct Ogden {
    static constexpr bool splits = true, of_invariants = false;

    template <class R> struct Principal {
        Eigen<R> frame;
        R c[3], log[3]; // l_a^2, ln lbar_a
        R b[3];
    };

    template <class T, class R>
    static BEZSOMA_INLINE R power(const T *par, int i, const R &log, Watch<R> &watch) {
        const R exponent = log * par[2 + 2 * i];
        watch.exponent(exponent);
        return expm1(exponent);
    }

    template <class T, class R>
    static BEZSOMA_INLINE Principal<R> principal(const T *par, int n, const R (&E)[6],
                                                 Watch<R> &watch) {
        Principal<R> x{eigen(E), {}, {}, {}};
        R mean = {};
        for (int a = 0; a < 3; ++a) {
            const R twice = x.frame.value[a] + x.frame.value[a];
            x.c[a] = twice + 1;
            x.log[a] = log1p(twice) * T(0.5);
            mean += x.log[a] * T(1.0 / 3);
        }
        for (int a = 0; a < 3; ++a)
            x.log[a] -= mean;
        for (int i = 0; i < n; ++i) {
            R z[3];
            for (int a = 0; a < 3; ++a)
                z[a] = power(par, i, x.log[a], watch);
            const R third = (z[0] + z[1] + z[2]) * T(1.0 / 3);
            for (int a = 0; a < 3; ++a)
                x.b[a] += (z[a] - third) * par[1 + 2 * i];
        }
        return x;
    }

    /// sum_ab q_a m_ab q_b^T.
    template <class R>
    static BEZSOMA_INLINE void turned(const R (&v)[3][3], const R (&m)[3][3], R (&s)[6]) {
        R half[3][3];
        for (int k = 0; k < 3; ++k)
            for (int b = 0; b < 3; ++b)
                half[k][b] = v[k][0] * m[0][b] + v[k][1] * m[1][b] + v[k][2] * m[2][b];
        for (int c = 0; c < 6; ++c) {
            const int k = c % 3, l = c < 3 ? k : (k + 1) % 3;
            s[c] = half[k][0] * v[l][0] + half[k][1] * v[l][1] + half[k][2] * v[l][2];
        }
    }

    template <class R> static BEZSOMA_INLINE void second_piola(const Principal<R> &x, R (&s)[6]) {
        R m[3][3] = {};
        for (int a = 0; a < 3; ++a)
            m[a][a] = x.b[a] / x.c[a];
        turned(x.frame.vector, m, s);
    }

    template <class T, class R>
    static BEZSOMA_INLINE void second_piola(const T *par, int n, const R (&E)[6], R (&s)[6],
                                            Watch<R> &watch) {
        second_piola(principal(par, n, E, watch), s);
    }

    template <class T, class R>
    static BEZSOMA_INLINE void second_piola(const T *par, int n, const Dual<R> (&E)[6],
                                            Dual<R> (&s)[6], Watch<R> &watch) {
        R strain[6], change[6], found[6];
        for (int c = 0; c < 6; ++c) {
            strain[c] = E[c].v;
            change[c] = E[c].d;
        }
        const Principal<R> x = principal(par, n, strain, watch);
        second_piola(x, found);
        changed(par, n, x, change, strain, watch);
        for (int c = 0; c < 6; ++c)
            s[c] = {found[c], strain[c]};
    }

    /// The change dS of S for a change dE of the strain.
    template <class T, class R>
    static BEZSOMA_INLINE void changed(const T *par, int n, const Principal<R> &x, const R (&dE)[6],
                                       R (&dS)[6], Watch<R> &watch) {
        const R(&v)[3][3] = x.frame.vector;
        R back[3][3], six[6], m[3][3], per_c[3], dlog[3], mean = {};
        for (int k = 0; k < 3; ++k)
            for (int a = 0; a < 3; ++a)
                back[a][k] = v[k][a];
        const R full[3][3] = {{dE[0], dE[3], dE[5]}, {dE[3], dE[1], dE[4]}, {dE[5], dE[4], dE[2]}};
        turned(back, full, six); // dE in the principal frame
        for (int a = 0; a < 3; ++a) {
            per_c[a] = 1 / x.c[a];
            dlog[a] = six[a] * per_c[a];
            mean += dlog[a] * T(1.0 / 3);
            m[a][a] = -2 * x.b[a] * dlog[a] * per_c[a];
        }
        R difference[3] = {}; // (b_a - b_b) / (c_a - c_b) for ab = 01, 12, 20
        for (int i = 0; i < n; ++i) {
            const T mu = par[1 + 2 * i], alpha = par[2 + 2 * i];
            R z[3], dz[3];
            for (int a = 0; a < 3; ++a) {
                z[a] = power(par, i, x.log[a], watch);
                dz[a] = (z[a] + 1) * (dlog[a] - mean) * alpha;
            }
            const R third = (dz[0] + dz[1] + dz[2]) * T(1.0 / 3);
            for (int a = 0; a < 3; ++a) {
                const int b = (a + 1) % 3;
                m[a][a] += (dz[a] - third) * per_c[a] * mu;
                difference[a] += quotient(x, z, a, b, alpha) * mu;
            }
        }
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3;
            const R slope =
                difference[a] * (per_c[a] + per_c[b]) - (x.b[a] + x.b[b]) * per_c[a] * per_c[b];
            m[a][b] = m[b][a] = slope * six[3 + a];
        }
        turned(v, m, dS);
    }

    /// (z_a - z_b) / (c_a - c_b): for close stretches, with x = ln l_a - ln l_b, it is
    /// sqrt((z_a + 1) (z_b + 1) / (c_a c_b)) alpha/2 (sinh(alpha x/2) / (alpha x/2)) / (sinh(x) /
    /// x).
    template <class T, class R>
    static BEZSOMA_INLINE R quotient(const Principal<R> &x, const R (&z)[3], int a, int b,
                                     T alpha) {
        const R apart = x.log[a] - x.log[b], square = apart * apart;
        const auto close = square < T(0.0025);
        const R near = square < T(0.0025) ? square : R{};
        const R square_root = (z[a] + 1) * (z[b] + 1) * (x.c[a] * x.c[b]);
        const R over = reciprocal_root(square_root) * (z[a] + 1) * (z[b] + 1);
        const R limit = over * sinh_quotient<0>(near * (alpha * alpha / 4)) * (alpha / 2);
        return (close ? limit : z[a] - z[b]) / (close ? sinh_quotient<0>(near) : x.c[a] - x.c[b]);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int n, const R (&E)[6], Watch<R> &watch) {
        R sum = {};
        const Principal<R> x = principal(par, n, E, watch);
        for (int i = 0; i < n; ++i)
            for (int a = 0; a < 3; ++a)
                sum += power(par, i, x.log[a], watch) * (par[1 + 2 * i] / par[2 + 2 * i]);
        return sum;
    }
};

} // namespace bezsoma::BEZSOMA_ISA
