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
// diagonal scaling a level; all a_j > 0, so nothing cancels and float32 is safe. The denominator is
// a factor of the material, which leaves the lowest level and the corners of the highest unscaled.
#pragma once

#include "kernels.hpp"
#include "lanes.hpp"
#include "tet_controls.hpp"

// A build that only looks for errors (.ci/run) may leave out what compiles slowly.
#ifndef BEZSOMA_HIGHEST_DEGREE
#define BEZSOMA_HIGHEST_DEGREE 10
#endif

/// Loops over the controls of degrees up to this one are written out for the compiler. Without the
/// 32 registers of AVX-512 degree 4, whose m is 3, would take 13 to 23 % more.
#define BEZSOMA_UNROLL (BEZSOMA_BYTES < 64 ? 2 : 3)
#define BEZSOMA_LADDER 4

namespace bezsoma::BEZSOMA_ISA {

// ---------------------------------------------------------------- loops over controls of a tet

/// Positions of b + e_1 and b + e_2 in degree m + 1, for each b of degree m.
template <int m> struct Above {
    int first[controls(m)] = {}, second[controls(m)] = {};
    constexpr Above() {
        for (int s3 = 0, p = 0; s3 <= m; ++s3)
            for (int s2 = 0; s2 <= s3; ++s2)
                for (int s1 = 0; s1 <= s2; ++s1, ++p) {
                    first[p] = position(s3 + 1, s2, s1);
                    second[p] = position(s3 + 1, s2 + 1, s1);
                }
    }
};

template <int m> inline constexpr Above<m> above{};

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

template <int m, int unrolled = BEZSOMA_UNROLL, class F> BEZSOMA_INLINE void each_control(F &&f) {
    if constexpr (m <= unrolled) {
        each_unrolled<m>(f);
    } else {
        for (int p = 0; p < controls(m); ++p)
            f(p, above<m>.first[p], above<m>.second[p], above<m>.second[p] + 1);
    }
}

// ---------------------------------------------------------------- the ladder

static constexpr double factorial(int n) {
    double f = 1;
    for (int i = 2; i <= n; ++i)
        f *= i;
    return f;
}

/// What the ladder's squares of binomials have to be multiplied by to be the a_j.
template <int m>
inline constexpr double ladder_unit = 1.0 / combinations(2 * m, m) / combinations(2 * m + 3, 3);

template <int m> struct LadderScales {
    double top[controls(m)] = {};
    double level[combinations(m + 4, 4)] =
        {}; // (C(m,j) multinomial(j, b))^2, levels 0..m one after another

    constexpr LadderScales() {
        int next = 0;
        for (int j = 0; j <= m; ++j) {
            const double a = 1.0 * combinations(m, j) * combinations(m, j);
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

/// y of degree j becomes scale y + S lower, where S is the elevation of the scaled basis: every
/// control takes what it shares with up to four below, in a tree, so that sums do not wait.
template <class T, int lanes, int j, int s3 = 0, int s2 = 0, int s1 = 0>
BEZSOMA_INLINE void elevated(Lanes<T, lanes> *y, const Lanes<T, lanes> *lower,
                             const double *scale) {
    constexpr int p = position(s3, s2, s1);
    constexpr bool has[4] = {s3 < j, s2 < s3, s1 < s2, s1 > 0};
    constexpr int below[4] = {position(s3, s2, s1), position(s3 - 1, s2, s1),
                              position(s3 - 1, s2 - 1, s1), position(s3 - 1, s2 - 1, s1 - 1)};
    Lanes<T, lanes> sum = y[p] * static_cast<T>(scale[p]), other;
    if constexpr (has[0])
        sum += lower[below[0]];
    if constexpr (has[1])
        sum += lower[below[1]];
    if constexpr (has[2] && has[3])
        other = lower[below[2]] + lower[below[3]];
    else if constexpr (has[2])
        other = lower[below[2]];
    else if constexpr (has[3])
        other = lower[below[3]];
    if constexpr (has[2] || has[3])
        sum += other;
    y[p] = sum;
    if constexpr (s1 < s2)
        elevated<T, lanes, j, s3, s2, s1 + 1>(y, lower, scale);
    else if constexpr (s2 < s3)
        elevated<T, lanes, j, s3, s2 + 1, 0>(y, lower, scale);
    else if constexpr (s3 < j)
        elevated<T, lanes, j, s3 + 1, 0, 0>(y, lower, scale);
}

/// The levels below j of the ladder: y of degree j comes in, and goes out as
/// level_j y + S (ladder of S^T y), where S is the elevation of the scaled basis: from m on it is
/// the mass matrix over `ladder_unit`. Other levels make other matrices of the same kind.
template <int m, int j, class T, int lanes, const auto &scales = ladder_scales<m>>
BEZSOMA_INLINE void ladder(Lanes<T, lanes> *y) {
    constexpr int first = combinations(j + 3, 4);
    if constexpr (j > 0) {
        Lanes<T, lanes> lower[controls(j - 1)];
        each_control<j - 1, BEZSOMA_LADDER>([&](int p, int p1, int p2, int p3) BEZSOMA_INLINED {
            lower[p] = (y[p] + y[p1]) + (y[p2] + y[p3]);
        });
        ladder<m, j - 1, T, lanes, scales>(lower);
        if constexpr (j - 1 <= BEZSOMA_LADDER) {
            elevated<T, lanes, j>(y, lower, scales.level + first);
        } else {
            for (int p = 0; p < controls(j); ++p)
                y[p] *= static_cast<T>(scales.level[first + p]);
            each_control<j - 1, BEZSOMA_LADDER>([&](int p, int p1, int p2, int p3) BEZSOMA_INLINED {
                y[p] += lower[p];
                y[p1] += lower[p];
                y[p2] += lower[p];
                y[p3] += lower[p];
            });
        }
    } else if constexpr (scales.level[0] != 1) {
        y[0] *= static_cast<T>(scales.level[0]);
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

/// Transposes squares of `count` numbers in `count` registers: in each square row r, lane l <-> row
/// l, lane r.
template <class T, int lanes, int count = lanes, int s = count / 2>
BEZSOMA_INLINE void transpose(Lanes<T, lanes> *rows) {
    if constexpr (s > 0) {
#pragma GCC unroll 16
        for (int i = 0; i < count; ++i)
            if ((i & s) == 0)
                exchange<T, lanes, s>(rows[i], rows[i + s]);
        transpose<T, lanes, count, s / 2>(rows);
    }
}

/// Numbers travel between tets and lanes in squares of so many at most: wider ones would cross
/// lines of the cache nearly always, and take more shuffles.
template <int lanes> inline constexpr int square = lanes < 4 ? lanes : 4;

/// Numbers of lane l and of every fourth lane after it, side by side: loads, not shuffles. from(l)
/// is where the numbers of a lane begin.
template <class T, int lanes, class From>
BEZSOMA_INLINE Lanes<T, lanes> joined(const From &from, int l, int begin) {
    if constexpr (lanes <= square<lanes>) {
        return load<T, lanes>(from(l) + begin);
    } else {
        const auto x = joined<T, lanes / 2>(from, l, begin);
        const auto y = joined<T, lanes / 2>(from, l + lanes / 2, begin);
        if constexpr (lanes == 8)
            return __builtin_shufflevector(x, y, 0, 1, 2, 3, 4, 5, 6, 7);
        else
            return __builtin_shufflevector(x, y, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14,
                                           15);
    }
}

template <int n> inline constexpr EntityOrder<n> entity_order{};

/// A number known when this is compiled.
template <int value> struct Const {
    constexpr operator int() const { return value; }
};

/// The entities of one dimension. At low degree unrolled for good: the place of every row is then
/// known when this is compiled.
template <int n, int rows, int entity, int end, int row, class F>
BEZSOMA_INLINE void each_entity(F &&f) {
    if constexpr (n > 3) {
        for (int e = entity; e < end; ++e)
            f.template operator()<rows>(e, row + (e - entity) * rows);
    } else if constexpr (entity < end) {
        f.template operator()<rows>(Const<entity>{}, Const<row>{});
        each_entity<n, rows, entity + 1, end, row + rows>(f);
    }
}

/// Calls f<rows>(entity, its first row among all) for every run of controls of a tet.
template <int n, int dim = 0, class F> BEZSOMA_INLINE void each_run_of_tet(F &&f) {
    constexpr int rows = 3 * inside(n, dim);
    constexpr int entity = dim == 0 ? 0 : dim == 1 ? 4 : dim == 2 ? 10 : 14;
    constexpr int many = dim == 0 ? 4 : dim == 1 ? 6 : dim == 2 ? 4 : 1;
    if constexpr (rows > 0)
        each_entity<n, rows, entity, entity + many, 3 * first_of_entity(n, entity)>(f);
    if constexpr (dim < 3)
        each_run_of_tet<n, dim + 1>(f);
}

/// Where a run of controls begins: see Batches.
template <class T> BEZSOMA_INLINE T *place(T *own, T *foreign_end, std::int64_t first) {
    T *found = (first < 0 ? foreign_end : own) + first;
    asm("" : "+r"(found)); // in one register: as a base and an index there are too few of them
    return found;
}

/// Reads `rows` numbers at `begin` of eight lanes' runs, from(l), in float64, into the rows that
/// `order` names. Lanes 0 and 2 share a register, 1 and 3, 4 and 6, 5 and 7, so that every step
/// only moves pairs of numbers or single ones in between, which is an instruction without a table:
///
///   a = x0 y0 z0 w0 x2 y2 z2 w2,  c the same of 4 and 6  ->  even = x0 y0 x2 y2 x4 y4 x6 y6
///   even, and odd of lanes 1 3 5 7                       ->  x0 x1 x2 x3 x4 x5 x6 x7
template <int rows, class From>
BEZSOMA_INLINE void gather_eight(const From &from, int begin, const int *order,
                                 Lanes<double, 8> *u) {
    const auto halves = [&](int low, int high) BEZSOMA_INLINED {
        return load_halves(from(low) + begin, from(high) + begin);
    };
    const auto a = halves(0, 2), b = halves(1, 3), c = halves(4, 6), d = halves(5, 7);
    const auto even = __builtin_shufflevector(a, c, 0, 1, 4, 5, 8, 9, 12, 13);
    const auto odd = __builtin_shufflevector(b, d, 0, 1, 4, 5, 8, 9, 12, 13);
    u[order[0]] = __builtin_shufflevector(even, odd, 0, 8, 2, 10, 4, 12, 6, 14);
    if constexpr (rows > 1)
        u[order[1]] = __builtin_shufflevector(even, odd, 1, 9, 3, 11, 5, 13, 7, 15);
    if constexpr (rows > 2) {
        const auto even_zw = __builtin_shufflevector(a, c, 2, 3, 6, 7, 10, 11, 14, 15);
        const auto odd_zw = __builtin_shufflevector(b, d, 2, 3, 6, 7, 10, 11, 14, 15);
        u[order[2]] = __builtin_shufflevector(even_zw, odd_zw, 0, 8, 2, 10, 4, 12, 6, 14);
        if constexpr (rows > 3)
            u[order[3]] = __builtin_shufflevector(even_zw, odd_zw, 1, 9, 3, 11, 5, 13, 7, 15);
    }
}

/// The same for any number of lanes and kind of number.
template <int rows, class T, int lanes, class From>
BEZSOMA_INLINE void gather_square(const From &from, int begin, const int *order,
                                  Lanes<T, lanes> *u) {
    if constexpr (lanes == 8 && sizeof(T) == 8) {
        gather_eight<rows>(from, begin, order, u);
    } else {
        Lanes<T, lanes> block[square<lanes>];
#pragma GCC unroll 4
        for (int l = 0; l < square<lanes>; ++l)
            block[l] = joined<T, lanes>(from, l, begin);
        transpose<T, lanes, square<lanes>>(block);
#pragma GCC unroll 4
        for (int r = 0; r < rows; ++r)
            u[order[r]] = block[r];
    }
}

/// Reads the controls of `lanes` tets: u[3 p + k][lane] = component k of the control at position p
/// of the lane's tet. The run of an entity begins at `begin_of(entity * lanes + lane)`. May read
/// some numbers past a control: pad the vector.
template <int n, class T, int lanes, class Begin>
BEZSOMA_INLINE void gather(const Begin &begin_of, Lanes<T, lanes> *u) {
    each_run_of_tet<n>([&]<int rows>(auto entity, auto row) BEZSOMA_INLINED {
        const int *order = entity_order<n>.row + row;
        const auto found = [&](int l) BEZSOMA_INLINED { return begin_of(entity * lanes + l); };
        if constexpr (rows <= square<lanes>) { // each place where it is read: registers are few
            gather_square<rows, T, lanes>(found, 0, order, u);
        } else {
            const T *places[lanes];
#pragma GCC unroll 16
            for (int l = 0; l < lanes; ++l)
                places[l] = found(l);
            const auto from = [&](int l) BEZSOMA_INLINED { return places[l]; };
            constexpr int left = rows % square<lanes>;
            int begin = 0;
            for (; begin < rows - left; begin += square<lanes>)
                gather_square<square<lanes>, T, lanes>(from, begin, order + begin, u);
            if constexpr (left > 0)
                gather_square<left, T, lanes>(from, begin, order + begin, u);
        }
    });
}

/// The same of the displacements that a chunk has.
template <int n, class T, int lanes>
BEZSOMA_INLINE void gather(const Batches<T> &b, const std::int32_t *first, Lanes<T, lanes> *u) {
    const auto begin_of = [&](int run) BEZSOMA_INLINED { return place(b.u, b.u_end, first[run]); };
    gather<n, T, lanes>(begin_of, u);
}

/// The same where own and foreign controls stand in one vector.
template <int n, class T, int lanes>
BEZSOMA_INLINE void gather(const T *from, const std::int32_t *first, Lanes<T, lanes> *u) {
    gather<n, T, lanes>([&](int run) BEZSOMA_INLINED { return from + first[run]; }, u);
}

/// Adds the first `rows` numbers of a register to memory.
template <int rows, class T, int lanes> BEZSOMA_INLINE void add_row(T *to, Lanes<T, lanes> v) {
    if constexpr (rows == lanes) {
        store<T, lanes>(to, load<T, lanes>(to) + v);
    } else {
        if constexpr (rows > 1)
            store<T, 2>(to, load<T, 2>(to) + __builtin_shufflevector(v, v, 0, 1));
        if constexpr (rows % 2 == 1)
            to[rows - 1] += v[rows - 1];
    }
}

/// Adds `rows` numbers of every lane, at most a square's, and zeros to `spare` numbers after them,
/// at `begin` of its run, lane after lane: tets of a batch share controls. Forces lie in memory,
/// and a square's lanes are loaded from there: to part registers would take stores, which it waits
/// for.
template <int rows, int spare, class T, int lanes>
BEZSOMA_INLINE void scatter_square(T *const *to, int begin, const int *order,
                                   const Lanes<T, lanes> *f) {
    constexpr int side = square<lanes>;
    const auto part_of = [&](int row, int lane) BEZSOMA_INLINED {
        return reinterpret_cast<const T *>(f + order[row]) + lane;
    };
#pragma GCC unroll 16
    for (int lane = 0; lane < lanes; lane += side) {
        Lanes<T, side> block[side] = {};
#pragma GCC unroll 4
        for (int r = 0; r < rows; ++r)
            block[r] = load<T, side>(part_of(r, lane));
        transpose<T, side>(block);
#pragma GCC unroll 4
        for (int l = 0; l < side; ++l)
            add_row<rows + spare, T, side>(to[lane + l] + begin, block[l]);
    }
}

/// Adds the forces of `lanes` tets to memory, where runs begin as in `gather`, with so many spare
/// numbers after a control that is alone in its run.
template <int n, class T, int lanes, int spare = 0, class Begin>
BEZSOMA_INLINE void scatter(const Begin &begin_of, const Lanes<T, lanes> *f) {
    each_run_of_tet<n>([&]<int rows>(auto entity, auto row) BEZSOMA_INLINED {
        T *to[lanes];
#pragma GCC unroll 16
        for (int l = 0; l < lanes; ++l)
            to[l] = begin_of(entity * lanes + l);
        const int *order = entity_order<n>.row + row;
        constexpr int side = square<lanes>, left = rows % side;
        int begin = 0;
        for (; begin < rows - left; begin += side)
            scatter_square<side, 0, T, lanes>(to, begin, order + begin, f);
        if constexpr (left > 0)
            scatter_square<left, spare, T, lanes>(to, begin, order + begin, f);
    });
}

/// The same to the forces that a chunk has.
template <int n, class T, int lanes>
BEZSOMA_INLINE void scatter(const Batches<T> &b, const std::int32_t *first,
                            const Lanes<T, lanes> *f) {
    const auto begin_of = [&](int run) BEZSOMA_INLINED { return place(b.f, b.f_end, first[run]); };
    scatter<n, T, lanes>(begin_of, f);
}

/// The same where own and foreign controls stand in one vector.
template <int n, class T, int lanes, int spare = 0>
BEZSOMA_INLINE void scatter(T *to, const std::int32_t *first, const Lanes<T, lanes> *f) {
    scatter<n, T, lanes, spare>([&](int run) BEZSOMA_INLINED { return to + first[run]; }, f);
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

/// What the batches to come will need first, called for line by line between sums: memory is slow,
/// and a burst of calls would block the processor. They bring it to the second cache (that is what
/// 2 says): in the first it would take the place of what the batch works on.
template <int n, class T, int lanes> struct Ahead {
    const T *u, *f;
    static constexpr int line = 64 / sizeof(T);
    static constexpr int lines = 1 + n * n * n * lanes / (2 * line * controls(n - 1));

    BEZSOMA_INLINE void call(int p) const {
#pragma GCC unroll 4
        for (int k = 0; k < lines; ++k) {
            __builtin_prefetch(u + (p * lines + k) * line, 0, 2);
            __builtin_prefetch(f + (p * lines + k) * line, 0, 2);
        }
    }
};

/// n times the moments sqrt(V) M T of the stress, in the scaled basis: XX YY ZZ XY YZ ZX.
template <int n, class T, int lanes>
BEZSOMA_INLINE void stress_moments(const Batch<T, lanes> &tet, const Lanes<T, lanes> *u,
                                   Lanes<T, lanes> (&stress)[6][controls(n - 1)],
                                   const Ahead<n, T, lanes> &ahead) {
    using R = Lanes<T, lanes>;
    constexpr int m = n - 1;
    constexpr T scale = static_cast<T>(n * n * ladder_unit<m>);
    const R lambda = tet.lambda * scale, mu = tet.mu * scale;
    each_control<m>([&](int p, int p1, int p2, int p3) BEZSOMA_INLINED {
        R h[3][3];
        ahead.call(p);
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
    // b + e_3 is met here first, all other controls begin their row: those are the ones to clear.
    for (int s3 = 0, p = 0; s3 <= n; ++s3)
        for (int s2 = 0; s2 <= s3; p += ++s2)
            for (int k = 0; k < 3; ++k)
                f[3 * p + k] = R{};
    R g0[3];
    for (int l = 0; l < 3; ++l)
        g0[l] = -(tet.g[0][l] + tet.g[1][l] + tet.g[2][l]);
    constexpr int voigt[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    each_control<m>([&](int p, int p1, int p2, int p3) BEZSOMA_INLINED {
        const T top = static_cast<T>(ladder_scales<m>.top[p]);
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            const R x = stress[voigt[k][0]][p] * top;
            const R y = stress[voigt[k][1]][p] * top;
            const R z = stress[voigt[k][2]][p] * top;
            if constexpr (n <= 2) {
                f[3 * p + k] = f[3 * p + k] + x * g0[0] + y * g0[1] + z * g0[2];
                f[3 * p1 + k] = f[3 * p1 + k] + x * tet.g[0][0] + y * tet.g[0][1] + z * tet.g[0][2];
                f[3 * p2 + k] = f[3 * p2 + k] + x * tet.g[1][0] + y * tet.g[1][1] + z * tet.g[1][2];
                f[3 * p3 + k] = x * tet.g[2][0] + y * tet.g[2][1] + z * tet.g[2][2];
            } else { // fewer products, but sums that wait for them
                const R f1 = x * tet.g[0][0] + y * tet.g[0][1] + z * tet.g[0][2];
                const R f2 = x * tet.g[1][0] + y * tet.g[1][1] + z * tet.g[1][2];
                const R f3 = x * tet.g[2][0] + y * tet.g[2][1] + z * tet.g[2][2];
                f[3 * p + k] -= f1 + f2 + f3;
                f[3 * p1 + k] += f1;
                f[3 * p2 + k] += f2;
                f[3 * p3 + k] = f3;
            }
        }
    });
}

/// f[a] = K u[a] on every lane's tet: both by position, three components each. They may be the
/// same.
template <int n, class T, int lanes>
BEZSOMA_INLINE void elastic_forces(const Batch<T, lanes> &tet, const Lanes<T, lanes> *u,
                                   Lanes<T, lanes> *f, const Ahead<n, T, lanes> &ahead) {
    Lanes<T, lanes> stress[6][controls(n - 1)];
    stress_moments<n, T, lanes>(tet, u, stress, ahead);
    forces_of_moments<n, T, lanes>(tet, stress, f);
}

/// int tau : eps on every lane's tet. From gradients, not from u . f, so that a body that is
/// carried far loses nothing.
template <int n, class T, int lanes>
BEZSOMA_INLINE Lanes<T, lanes> elastic_work(const Batch<T, lanes> &tet, const Lanes<T, lanes> *u,
                                            const T *u_next) {
    using R = Lanes<T, lanes>;
    R stress[6][controls(n - 1)], work = {};
    stress_moments<n, T, lanes>(tet, u, stress, {u_next, u_next});
    each_control<n - 1>([&](int p, int p1, int p2, int p3) BEZSOMA_INLINED {
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
