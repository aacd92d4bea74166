// SPDX-License-Identifier: BSD-3-Clause
// K u on a batch of tets, without a matrix and without quadrature.
//
// On an affine tet the gradient of a field of degree n is n times differences of its controls, in
// degree m = n - 1. Stress follows control by control, the mass matrix of degree m turns stress
// into moments, and the transposed differences take those to forces:
//
//   H_b = n sum_i u_(b+e_i) g_i^T          T = lambda tr(H) I + mu (H + H^T)
//   f_a = n V sum_i (M T)_(a-e_i) g_i      M^m = sum_j a_j E_j E_j^T   (the ladder)
//
// with a_j = C(m,j)^2 / (C(2m,m) C(2m+3,3)) and E_j the elevation from degree j to m. In the basis
// scaled by multinomials elevation is a sum without factors, so the ladder needs additions and one
// diagonal scaling a level; all a_j > 0, so nothing cancels and float32 is safe.
#pragma once

#include "tet_controls.hpp"

#ifndef BEZSOMA_ISA
#error "BEZSOMA_ISA names the namespace of one instruction set"
#endif

/// Loops over the controls of degrees up to this one are written out for the compiler.
#define BEZSOMA_UNROLL 2

namespace bezsoma::BEZSOMA_ISA {

#define BEZSOMA_INLINE inline __attribute__((always_inline))

/// `lanes` numbers in a register (Lanes) and anywhere in memory (Loose).
template <class T, int lanes> struct Simd {
    typedef T Lanes __attribute__((vector_size(lanes * sizeof(T))));
    typedef T Loose __attribute__((vector_size(lanes * sizeof(T)), aligned(sizeof(T)), may_alias));
};

template <class T, int lanes> using Lanes = typename Simd<T, lanes>::Lanes;

template <class T, int lanes> BEZSOMA_INLINE Lanes<T, lanes> load(const T *from) {
    return *reinterpret_cast<const typename Simd<T, lanes>::Loose *>(from);
}

template <class T, int lanes> BEZSOMA_INLINE void store(T *to, Lanes<T, lanes> v) {
    *reinterpret_cast<typename Simd<T, lanes>::Loose *>(to) = v;
}

// ---------------------------------------------------------------- loops over controls of a tet

/// Calls f(p, p1, p2, p3) for every control b of degree m: p is the position of b and of b + e_0,
/// p1, p2, p3 those of b + e_1, b + e_2, b + e_3 in degree m + 1. Unrolled where that is small.
template <int m, int s3 = 0, int s2 = 0, int s1 = 0, class F>
BEZSOMA_INLINE void each_unrolled(F &&f) {
    constexpr int p = position(s3, s2, s1);
    f(p, position(s3 + 1, s2, s1), position(s3 + 1, s2 + 1, s1), position(s3 + 1, s2 + 1, s1 + 1));
    if constexpr (s1 < s2)
        each_unrolled<m, s3, s2, s1 + 1>(f);
    else if constexpr (s2 < s3)
        each_unrolled<m, s3, s2 + 1, 0>(f);
    else if constexpr (s3 < m)
        each_unrolled<m, s3 + 1, 0, 0>(f);
}

template <int m, class F> BEZSOMA_INLINE void each_control(F &&f) {
    if constexpr (m <= BEZSOMA_UNROLL) {
        each_unrolled<m>(f);
    } else {
        int p = 0;
        for (int s3 = 0; s3 <= m; ++s3) {
            const int layer = (s3 + 1) * (s3 + 2) / 2;
            for (int s2 = 0; s2 <= s3; ++s2)
                for (int s1 = 0; s1 <= s2; ++s1, ++p)
                    f(p, p + layer, p + layer + s2 + 1, p + layer + s2 + 2);
        }
    }
}

// ---------------------------------------------------------------- the ladder

static constexpr double factorial(int n) {
    double f = 1;
    for (int i = 2; i <= n; ++i)
        f *= i;
    return f;
}

template <int m> struct LadderScales {
    double top[controls(m)] = {};
    double level[combinations(m + 4, 4)] =
        {}; // a_j multinomial(j, b)^2, levels 0..m one after another

    constexpr LadderScales() {
        int next = 0;
        for (int j = 0; j <= m; ++j) {
            const double a = 1.0 * combinations(m, j) * combinations(m, j) /
                             combinations(2 * m, m) / combinations(2 * m + 3, 3);
            for (int s3 = 0; s3 <= j; ++s3)
                for (int s2 = 0; s2 <= s3; ++s2)
                    for (int s1 = 0; s1 <= s2; ++s1) {
                        const double multinomial = factorial(j) / factorial(j - s3) /
                                                   factorial(s3 - s2) / factorial(s2 - s1) /
                                                   factorial(s1);
                        level[next++] = a * multinomial * multinomial;
                        if (j == m)
                            top[position(s3, s2, s1)] = 1 / multinomial;
                    }
        }
    }
};

template <int m> inline constexpr LadderScales<m> ladder_scales{};

/// The levels below j of the ladder: y of degree j comes in, and goes out as
/// level_j y + S (ladder of S^T y), where S is the elevation of the scaled basis.
template <int m, int j, class T, int lanes> BEZSOMA_INLINE void ladder(Lanes<T, lanes> *y) {
    constexpr int first = combinations(j + 3, 4);
    if constexpr (j > 0) {
        Lanes<T, lanes> lower[controls(j - 1)];
        each_control<j - 1>(
            [&](int p, int p1, int p2, int p3) { lower[p] = (y[p] + y[p1]) + (y[p2] + y[p3]); });
        ladder<m, j - 1, T, lanes>(lower);
        for (int p = 0; p < controls(j); ++p)
            y[p] *= static_cast<T>(ladder_scales<m>.level[first + p]);
        each_control<j - 1>([&](int p, int p1, int p2, int p3) {
            y[p] += lower[p];
            y[p1] += lower[p];
            y[p2] += lower[p];
            y[p3] += lower[p];
        });
    } else {
        y[0] *= static_cast<T>(ladder_scales<m>.level[0]);
    }
}

// ---------------------------------------------------------------- moving between lanes and tets

/// One step of a transposition: exchanges the upper half-blocks of a with the lower ones of b.
template <int lanes, int s> static constexpr int low(int p) { return p & s ? lanes + p - s : p; }
template <int lanes, int s> static constexpr int high(int p) { return p & s ? lanes + p : p + s; }

template <class T, int lanes, int s>
BEZSOMA_INLINE void exchange(Lanes<T, lanes> &a, Lanes<T, lanes> &b) {
    const Lanes<T, lanes> x = a, y = b;
#define LOW(p) low<lanes, s>(p)
#define HIGH(p) high<lanes, s>(p)
    if constexpr (lanes == 2) {
        a = __builtin_shufflevector(x, y, LOW(0), LOW(1));
        b = __builtin_shufflevector(x, y, HIGH(0), HIGH(1));
    } else if constexpr (lanes == 4) {
        a = __builtin_shufflevector(x, y, LOW(0), LOW(1), LOW(2), LOW(3));
        b = __builtin_shufflevector(x, y, HIGH(0), HIGH(1), HIGH(2), HIGH(3));
    } else if constexpr (lanes == 8) {
        a = __builtin_shufflevector(x, y, LOW(0), LOW(1), LOW(2), LOW(3), LOW(4), LOW(5), LOW(6),
                                    LOW(7));
        b = __builtin_shufflevector(x, y, HIGH(0), HIGH(1), HIGH(2), HIGH(3), HIGH(4), HIGH(5),
                                    HIGH(6), HIGH(7));
    } else {
        static_assert(lanes == 16);
        a = __builtin_shufflevector(x, y, LOW(0), LOW(1), LOW(2), LOW(3), LOW(4), LOW(5), LOW(6),
                                    LOW(7), LOW(8), LOW(9), LOW(10), LOW(11), LOW(12), LOW(13),
                                    LOW(14), LOW(15));
        b = __builtin_shufflevector(x, y, HIGH(0), HIGH(1), HIGH(2), HIGH(3), HIGH(4), HIGH(5),
                                    HIGH(6), HIGH(7), HIGH(8), HIGH(9), HIGH(10), HIGH(11),
                                    HIGH(12), HIGH(13), HIGH(14), HIGH(15));
    }
#undef LOW
#undef HIGH
}

/// Transposes `lanes` registers in place: row r, lane l <-> row l, lane r.
template <class T, int lanes, int s = lanes / 2>
BEZSOMA_INLINE void transpose(Lanes<T, lanes> *rows) {
    if constexpr (s > 0) {
#pragma GCC unroll 16
        for (int i = 0; i < lanes; ++i)
            if ((i & s) == 0)
                exchange<T, lanes, s>(rows[i], rows[i + s]);
        transpose<T, lanes, s / 2>(rows);
    }
}

/// Adds the first `count` lanes of v to memory, in pieces that neither overrun nor overlap.
template <class T, int lanes, int count, int done = 0>
BEZSOMA_INLINE void add_lanes(T *to, const Lanes<T, lanes> &v) {
    constexpr int left = count - done;
    if constexpr (left >= lanes) {
        store<T, lanes>(to, load<T, lanes>(to) + v);
    } else if constexpr (lanes >= 16 && left >= 8) {
        const Lanes<T, 8> piece = __builtin_shufflevector(v, v, done, done + 1, done + 2, done + 3,
                                                          done + 4, done + 5, done + 6, done + 7);
        store<T, 8>(to + done, load<T, 8>(to + done) + piece);
        add_lanes<T, lanes, count, done + 8>(to, v);
    } else if constexpr (lanes >= 8 && left >= 4) {
        const Lanes<T, 4> piece = __builtin_shufflevector(v, v, done, done + 1, done + 2, done + 3);
        store<T, 4>(to + done, load<T, 4>(to + done) + piece);
        add_lanes<T, lanes, count, done + 4>(to, v);
    } else if constexpr (lanes >= 4 && left >= 2) {
        const Lanes<T, 2> piece = __builtin_shufflevector(v, v, done, done + 1);
        store<T, 2>(to + done, load<T, 2>(to + done) + piece);
        add_lanes<T, lanes, count, done + 2>(to, v);
    } else if constexpr (left > 0) {
        to[done] += v[done];
        add_lanes<T, lanes, count, done + 1>(to, v);
    }
}

template <int n> inline constexpr EntityOrder<n> entity_order{};

/// A number known when this is compiled.
template <int value> struct Const {
    constexpr operator int() const { return value; }
};

/// The same piece of each entity of one dimension. At low degree unrolled for good: the place of
/// every row is then known when this is compiled, and all stays in registers.
template <int n, int rows, int entity, int end, int begin, int row, int run, class F>
BEZSOMA_INLINE void each_entity(F &&f) {
    if constexpr (n > 2) {
        for (int e = entity; e < end; ++e)
            f.template operator()<rows>(e, begin, row + (e - entity) * run);
    } else if constexpr (entity < end) {
        f.template operator()<rows>(Const<entity>{}, begin, Const<row>{});
        each_entity<n, rows, entity + 1, end, begin, row + run, run>(f);
    }
}

/// Calls f<rows>(entity, first row in its run, its row among all) for every piece of at most
/// `lanes` numbers of one entity's run: the pieces in which controls travel.
template <int n, int lanes, int dim = 0, int begin = 0, class F>
BEZSOMA_INLINE void each_piece_of_tet(F &&f) {
    constexpr int run = 3 * inside(n, dim);
    if constexpr (begin < run) {
        constexpr int rows = run - begin < lanes ? run - begin : lanes;
        constexpr int entity = dim == 0 ? 0 : dim == 1 ? 4 : dim == 2 ? 10 : 14;
        constexpr int many = dim == 0 ? 4 : dim == 1 ? 6 : dim == 2 ? 4 : 1;
        constexpr int row = 3 * first_of_entity(n, entity) + begin;
        each_entity<n, rows, entity, entity + many, begin, row, run>(f);
        each_piece_of_tet<n, lanes, dim, begin + rows>(f);
    } else if constexpr (dim < 3) {
        each_piece_of_tet<n, lanes, dim + 1, 0>(f);
    }
}

/// Reads the controls of `lanes` tets: u[3 p + k][lane] = component k of the control at position p
/// of the lane's tet. May read up to lanes - 1 numbers past a control: pad the vector.
template <int n, class T, int lanes>
BEZSOMA_INLINE void gather(const T *from, const std::int32_t *first, Lanes<T, lanes> *u) {
    each_piece_of_tet<n, lanes>([&]<int rows>(auto entity, int begin, auto row) {
        Lanes<T, lanes> block[lanes];
#pragma GCC unroll 16
        for (int l = 0; l < lanes; ++l)
            block[l] = load<T, lanes>(from + 3 * std::int64_t{first[entity * lanes + l]} + begin);
        transpose<T, lanes>(block);
#pragma GCC unroll 16
        for (int r = 0; r < rows; ++r)
            u[entity_order<n>.row[row + r]] = block[r];
    });
}

/// Adds the forces of `lanes` tets to memory, lane after lane: tets of a batch share controls.
template <int n, class T, int lanes>
BEZSOMA_INLINE void scatter(T *to, const std::int32_t *first, const Lanes<T, lanes> *f) {
    each_piece_of_tet<n, lanes>([&]<int rows>(auto entity, int begin, auto row) {
        Lanes<T, lanes> block[lanes] = {};
#pragma GCC unroll 16
        for (int r = 0; r < rows; ++r)
            block[r] = f[entity_order<n>.row[row + r]];
        transpose<T, lanes>(block);
#pragma GCC unroll 16
        for (int l = 0; l < lanes; ++l)
            add_lanes<T, lanes, rows>(to + 3 * std::int64_t{first[entity * lanes + l]} + begin,
                                      block[l]);
    });
}

// ---------------------------------------------------------------- the operator

/// The geometry and material of a batch: sqrt(V) grad L_i for i = 1..3 (9 numbers), lambda, mu.
template <class T, int lanes> struct Batch {
    Lanes<T, lanes> g[3][3];
    Lanes<T, lanes> lambda, mu; // times one: sqrt(V) stands in g
};

/// sqrt(V) / n times the gradient of the displacement at control p of degree n - 1.
template <class T, int lanes>
BEZSOMA_INLINE void gradient(const Batch<T, lanes> &tet, const Lanes<T, lanes> *u, int p, int p1,
                             int p2, int p3, Lanes<T, lanes> (&h)[3][3]) {
    using R = Lanes<T, lanes>;
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
        const R d1 = u[3 * p1 + k] - u[3 * p + k];
        const R d2 = u[3 * p2 + k] - u[3 * p + k];
        const R d3 = u[3 * p3 + k] - u[3 * p + k];
#pragma GCC unroll 3
        for (int l = 0; l < 3; ++l)
            h[k][l] = d1 * tet.g[0][l] + d2 * tet.g[1][l] + d3 * tet.g[2][l];
    }
}

/// n times the moments sqrt(V) M T of the stress, in the scaled basis: XX YY ZZ XY YZ ZX.
template <int n, class T, int lanes>
BEZSOMA_INLINE void stress_moments(const Batch<T, lanes> &tet, const Lanes<T, lanes> *u,
                                   Lanes<T, lanes> (&stress)[6][controls(n - 1)]) {
    using R = Lanes<T, lanes>;
    constexpr int m = n - 1;
    const R lambda = tet.lambda * static_cast<T>(n * n);
    const R mu = tet.mu * static_cast<T>(n * n);
    each_control<m>([&](int p, int p1, int p2, int p3) {
        R h[3][3];
        gradient<T, lanes>(tet, u, p, p1, p2, p3, h);
        const T top = static_cast<T>(ladder_scales<m>.top[p]);
        const R volumetric = lambda * (h[0][0] + h[1][1] + h[2][2]) * top;
        const R shear = mu * top;
        stress[0][p] = volumetric + shear * (h[0][0] + h[0][0]);
        stress[1][p] = volumetric + shear * (h[1][1] + h[1][1]);
        stress[2][p] = volumetric + shear * (h[2][2] + h[2][2]);
        stress[3][p] = shear * (h[0][1] + h[1][0]);
        stress[4][p] = shear * (h[1][2] + h[2][1]);
        stress[5][p] = shear * (h[2][0] + h[0][2]);
    });
    for (int c = 0; c < 6; ++c)
        ladder<m, m, T, lanes>(stress[c]);
}

/// f[a] by position, three components each, from what `stress_moments` gives.
template <int n, class T, int lanes>
BEZSOMA_INLINE void forces_of_moments(const Batch<T, lanes> &tet,
                                      const Lanes<T, lanes> (&stress)[6][controls(n - 1)],
                                      Lanes<T, lanes> *f) {
    using R = Lanes<T, lanes>;
    constexpr int m = n - 1;
#pragma GCC unroll 32
    for (int row = 0; row < 3 * controls(n); ++row)
        f[row] = R{};
    constexpr int voigt[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    each_control<m>([&](int p, int p1, int p2, int p3) {
        const T top = static_cast<T>(ladder_scales<m>.top[p]);
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            const R x = stress[voigt[k][0]][p] * top;
            const R y = stress[voigt[k][1]][p] * top;
            const R z = stress[voigt[k][2]][p] * top;
            const R f1 = x * tet.g[0][0] + y * tet.g[0][1] + z * tet.g[0][2];
            const R f2 = x * tet.g[1][0] + y * tet.g[1][1] + z * tet.g[1][2];
            const R f3 = x * tet.g[2][0] + y * tet.g[2][1] + z * tet.g[2][2];
            f[3 * p + k] -= f1 + f2 + f3;
            f[3 * p1 + k] += f1;
            f[3 * p2 + k] += f2;
            f[3 * p3 + k] += f3;
        }
    });
}

/// f[a] = K u[a] on every lane's tet: both by position, three components each.
template <int n, class T, int lanes>
BEZSOMA_INLINE void elastic_forces(const Batch<T, lanes> &tet, const Lanes<T, lanes> *u,
                                   Lanes<T, lanes> *f) {
    Lanes<T, lanes> stress[6][controls(n - 1)];
    stress_moments<n, T, lanes>(tet, u, stress);
    forces_of_moments<n, T, lanes>(tet, stress, f);
}

/// int tau : eps on every lane's tet. From gradients, not from u . f, so that a body that is
/// carried far loses nothing.
template <int n, class T, int lanes>
BEZSOMA_INLINE Lanes<T, lanes> elastic_work(const Batch<T, lanes> &tet, const Lanes<T, lanes> *u) {
    using R = Lanes<T, lanes>;
    R stress[6][controls(n - 1)], work = {};
    stress_moments<n, T, lanes>(tet, u, stress);
    each_control<n - 1>([&](int p, int p1, int p2, int p3) {
        R h[3][3];
        gradient<T, lanes>(tet, u, p, p1, p2, p3, h);
        work += static_cast<T>(ladder_scales<n - 1>.top[p]) *
                (h[0][0] * stress[0][p] + h[1][1] * stress[1][p] + h[2][2] * stress[2][p] +
                 (h[0][1] + h[1][0]) * stress[3][p] + (h[1][2] + h[2][1]) * stress[4][p] +
                 (h[2][0] + h[0][2]) * stress[5][p]);
    });
    return work;
}

} // namespace bezsoma::BEZSOMA_ISA
