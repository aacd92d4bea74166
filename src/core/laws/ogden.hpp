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

/// Squares of numbers below this are as good as zero.
template <class T> inline constexpr T least_square = sizeof(T) == 8 ? T(1e-300) : T(1e-37);

/// A symmetric matrix a = v^T A v in a frame v on its way to that where it is diagonal.
template <class R> struct Turning {
    R a[3][3], v[3][3];

    /// The turn about axis r that takes the entry of the other two to zero.
    template <int r> BEZSOMA_INLINE void turn() {
        using T = Scalar<R>;
        constexpr T tiny = sizeof(T) == 8 ? T(1e-150) : T(1e-18);
        constexpr int p = (r + 1) % 3, q = (r + 2) % 3;
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

    /// Whether some lane is not diagonal to rounding.
    BEZSOMA_INLINE bool unfinished() const {
        using T = Scalar<R>;
        constexpr T done = sizeof(T) == 8 ? T(1e-34) : T(1e-13);
        const R off = a[0][1] * a[0][1] + a[1][2] * a[1][2] + a[2][0] * a[2][0];
        const R on = a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2];
        return any(off > on * done + least_square<T>);
    }
};

/// A frame whose first axis is that of the eigenvalue which stands farthest from the others.
///
/// With mean q and B = (A - q I) / p, tr B^2 = 6, the eigenvalues of B are the roots of x^3 - 3 x =
/// det B; of the outermost x lies between sqrt 3 and 2, where Newton's step is good to nine digits.
/// Its axis is any column of the cofactors of B - x I, the longest here. What this leaves off the
/// diagonal is of the size of rounding or of these nine digits, whatever the eigenvalues.
template <class R> BEZSOMA_INLINE Turning<R> outermost(const R (&of)[6]) {
    using T = Scalar<R>;
    const R q = (of[0] + of[1] + of[2]) * T(1.0 / 3);
    R b[6];
    for (int c = 0; c < 6; ++c)
        b[c] = c < 3 ? of[c] - q : of[c];
    const R normal = b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
    const R shear = b[3] * b[3] + b[4] * b[4] + b[5] * b[5];
    const R per_p = reciprocal_root(normal * T(1.0 / 6) + shear * T(1.0 / 3) + least_square<T>);
    for (R &entry : b)
        entry *= per_p;
    const R det = b[0] * (b[1] * b[2] - b[4] * b[4]) + b[3] * (b[4] * b[5] - b[3] * b[2]) +
                  b[5] * (b[3] * b[4] - b[1] * b[5]);
    const R half = abs(det) * T(0.5);
    // A cubic with the right values and slopes at both ends, then Newton's step.
    R x = T(1.7320508075688772) + half * (T(1.0 / 3) + half * (half * T(0.0196571) - T(0.0850412)));
    x -= (x * (x * x - 3) - 2 * half) / (3 * (x * x) - 3);
    x = det < 0 ? -x : x;
    for (int c = 0; c < 3; ++c)
        b[c] -= x;
    const R diagonal[3] = {b[1] * b[2] - b[4] * b[4], b[2] * b[0] - b[5] * b[5],
                           b[0] * b[1] - b[3] * b[3]};
    const R xy = b[4] * b[5] - b[3] * b[2], yz = b[5] * b[3] - b[4] * b[0],
            zx = b[3] * b[4] - b[5] * b[1];
    const auto second = diagonal[1] > diagonal[0];
    const R larger = second ? diagonal[1] : diagonal[0];
    const auto third = diagonal[2] > larger;
    R w[3] = {third    ? zx
              : second ? xy
                       : diagonal[0],
              third    ? yz
              : second ? diagonal[1]
                       : xy,
              third    ? diagonal[2]
              : second ? yz
                       : zx};
    const R per_length = reciprocal_root(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    for (R &entry : w)
        entry *= per_length;
    // Two axes across it: T. Duff et al., J. Comput. Graph. Tech. 6 (2017).
    const R sign = w[2] < 0 ? R{} - 1 : R{} + 1, turned = -1 / (sign + w[2]);
    const R across = w[0] * w[1] * turned;
    Turning<R> x_of;
    const R frame[3][3] = {{w[0], 1 + sign * (w[0] * w[0]) * turned, across},
                           {w[1], sign * across, sign + w[1] * w[1] * turned},
                           {w[2], -sign * w[0], -w[1]}};
    constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    for (int i = 0; i < 3; ++i) {
        R image[3];
        for (int k = 0; k < 3; ++k) {
            x_of.v[k][i] = frame[k][i];
            image[k] = of[at[k][0]] * frame[0][i] + of[at[k][1]] * frame[1][i] +
                       of[at[k][2]] * frame[2][i];
        }
        for (int l = 0; l <= i; ++l)
            x_of.a[i][l] = x_of.a[l][i] =
                image[0] * frame[0][l] + image[1] * frame[1][l] + image[2] * frame[2][l];
    }
    return x_of;
}

/// From there Jacobi's rotations, all lanes together until the last is diagonal: one about that
/// axis, and in float64 mostly three more.
template <class R> BEZSOMA_INLINE Eigen<R> eigen(const R (&of)[6]) {
    Turning<R> x = outermost(of);
    x.template turn<0>();
    for (int sweep = 0; sweep < 8 && x.unfinished(); ++sweep) {
        x.template turn<1>();
        x.template turn<2>();
        x.template turn<0>();
    }
    Eigen<R> found;
    for (int k = 0; k < 3; ++k) {
        found.value[k] = x.a[k][k];
        for (int l = 0; l < 3; ++l)
            found.vector[k][l] = x.v[k][l];
    }
    return found;
}

/// sinh(y) / y from yy = y^2: 1/(2i+1)! + yy/(2i+3)! ..., to the term `last`.
template <int last, int i = 0, class R> BEZSOMA_INLINE R sinh_quotient(const R &yy) {
    constexpr auto here = static_cast<Scalar<R>>(inverse_factorial(2 * i + 1));
    if constexpr (i == last)
        return R{} + here;
    else
        return sinh_quotient<last, i + 1>(yy) * yy + here;
}

/// Parameters kappa and n pairs mu_i, alpha_i.
struct Ogden {
    static constexpr bool splits = true, of_invariants = false;

    template <class R> struct Principal {
        Eigen<R> frame;
        R c[3], per_l[3], per_c[3], log[3]; // l_a^2, 1 / l_a, 1 / l_a^2, ln lbar_a
    };

    template <class R> static BEZSOMA_INLINE Principal<R> principal(const R (&E)[6]) {
        using T = Scalar<R>;
        Principal<R> x{eigen(E), {}, {}, {}, {}};
        R mean = {};
        for (int a = 0; a < 3; ++a) {
            const R twice = x.frame.value[a] + x.frame.value[a];
            x.c[a] = twice + 1;
            x.per_l[a] = reciprocal_root(x.c[a]);
            x.per_c[a] = x.per_l[a] * x.per_l[a];
            x.log[a] = log1p(twice) * T(0.5);
            mean += x.log[a] * T(1.0 / 3);
        }
        for (int a = 0; a < 3; ++a)
            x.log[a] -= mean;
        return x;
    }

    /// z_ia and the roots of z_ia + 1, and adds mu_i (z_ia - their mean) to b_a.
    template <class T, class R>
    static BEZSOMA_INLINE void term(const T *par, int i, const Principal<R> &x, R (&z)[3],
                                    R (&root)[3], R (&b)[3], Watch<R> &watch) {
        for (int a = 0; a < 3; ++a) {
            const R exponent = x.log[a] * par[2 + 2 * i];
            watch.exponent(exponent);
            const R half = expm1(exponent * T(0.5));
            z[a] = half * (half + 2);
            root[a] = half + 1;
        }
        const R third = (z[0] + z[1] + z[2]) * T(1.0 / 3);
        for (int a = 0; a < 3; ++a)
            b[a] += (z[a] - third) * par[1 + 2 * i];
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

    /// sum_a q_a b_a q_a^T.
    template <class R>
    static BEZSOMA_INLINE void turned(const R (&v)[3][3], const R (&b)[3], R (&s)[6]) {
        for (int c = 0; c < 6; ++c) {
            const int k = c % 3, l = c < 3 ? k : (k + 1) % 3;
            s[c] = v[k][0] * b[0] * v[l][0] + v[k][1] * b[1] * v[l][1] + v[k][2] * b[2] * v[l][2];
        }
    }

    template <class T, class R>
    static BEZSOMA_INLINE void second_piola(const T *par, int n, const R (&E)[6], R (&s)[6],
                                            Watch<R> &watch) {
        const Principal<R> x = principal(E);
        R z[3], root[3], b[3] = {};
        for (int i = 0; i < n; ++i)
            term(par, i, x, z, root, b, watch);
        for (int a = 0; a < 3; ++a)
            b[a] *= x.per_c[a];
        turned(x.frame.vector, b, s);
    }

    /// With its change.
    template <class T, class R>
    static BEZSOMA_INLINE void second_piola(const T *par, int n, const Dual<R> (&E)[6],
                                            Dual<R> (&s)[6], Watch<R> &watch) {
        R strain[6], found[6], change[6];
        for (int c = 0; c < 6; ++c)
            strain[c] = E[c].v;
        const Principal<R> x = principal(strain);
        const R(&v)[3][3] = x.frame.vector;
        R back[3][3], six[6], dm[3][3], dlog[3], mean = {};
        for (int k = 0; k < 3; ++k)
            for (int a = 0; a < 3; ++a)
                back[a][k] = v[k][a];
        const R full[3][3] = {
            {E[0].d, E[3].d, E[5].d}, {E[3].d, E[1].d, E[4].d}, {E[5].d, E[4].d, E[2].d}};
        turned(back, full, six); // dE in the principal frame
        for (int a = 0; a < 3; ++a) {
            dlog[a] = six[a] * x.per_c[a];
            mean += dlog[a] * T(1.0 / 3);
            dm[a][a] = R{};
        }
        R b[3] = {}, difference[3] = {}; // (b_a - b_b) / (c_a - c_b) for ab = 01, 12, 20
        for (int i = 0; i < n; ++i) {
            const T mu = par[1 + 2 * i], alpha = par[2 + 2 * i];
            R z[3], root[3], dz[3];
            term(par, i, x, z, root, b, watch);
            for (int a = 0; a < 3; ++a)
                dz[a] = (z[a] + 1) * (dlog[a] - mean) * alpha;
            const R third = (dz[0] + dz[1] + dz[2]) * T(1.0 / 3);
            for (int a = 0; a < 3; ++a) {
                dm[a][a] += (dz[a] - third) * mu;
                difference[a] += quotient(x, z, root, a, (a + 1) % 3, alpha) * mu;
            }
        }
        for (int a = 0; a < 3; ++a) {
            const int o = (a + 1) % 3;
            dm[a][a] = (dm[a][a] - 2 * b[a] * dlog[a]) * x.per_c[a];
            const R slope =
                difference[a] * (x.per_c[a] + x.per_c[o]) - (b[a] + b[o]) * x.per_c[a] * x.per_c[o];
            dm[a][o] = dm[o][a] = slope * six[3 + a];
        }
        for (int a = 0; a < 3; ++a)
            b[a] *= x.per_c[a];
        turned(v, b, found);
        turned(v, dm, change);
        for (int c = 0; c < 6; ++c)
            s[c] = {found[c], change[c]};
    }

    /// (z_a - z_b) / (c_a - c_b): for close stretches, with x = ln l_a - ln l_b, it is
    /// sqrt((z_a + 1) (z_b + 1) / (c_a c_b)) alpha/2 (sinh(alpha x/2) / (alpha x/2)) / (sinh(x) /
    /// x). Series reach as far as |x| < 0.05 and alpha < 50 need.
    template <class T, class R>
    static BEZSOMA_INLINE R quotient(const Principal<R> &x, const R (&z)[3], const R (&root)[3],
                                     int a, int b, T alpha) {
        constexpr int few = sizeof(T) == 8 ? 4 : 2, many = sizeof(T) == 8 ? 9 : 5;
        const R apart = x.log[a] - x.log[b], square = apart * apart;
        const auto close = square < T(0.0025);
        const R near = close ? square : R{};
        const R over = (root[a] * root[b]) * (x.per_l[a] * x.per_l[b]);
        const R limit = over * sinh_quotient<many>(near * (alpha * alpha / 4)) * (alpha / 2);
        return (close ? limit : z[a] - z[b]) / (close ? sinh_quotient<few>(near) : x.c[a] - x.c[b]);
    }

    template <class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int n, const R (&E)[6], Watch<R> &watch) {
        R sum = {}, z[3], root[3], b[3] = {};
        const Principal<R> x = principal(E);
        for (int i = 0; i < n; ++i) {
            term(par, i, x, z, root, b, watch);
            sum += (z[0] + z[1] + z[2]) * (par[1 + 2 * i] / par[2 + 2 * i]);
        }
        return sum;
    }
};

} // namespace bezsoma::BEZSOMA_ISA
