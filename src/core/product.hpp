// SPDX-License-Identifier: BSD-3-Clause
// Products of small constant matrices with rows of lanes, and the change to the basis of rule.hpp.
#pragma once

#include "elastic_kernel.hpp"
#include "pointwise_kernels.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// Rows of a product that share the registers.
constexpr int rows_at_once(int components) {
    return BEZSOMA_BYTES == 64 ? (components < 9 ? 4 : 2) : components < 9 ? 2 : 1;
}

/// out[r] = (add ? out[r] : 0) + sum_i matrix[r, i] in[i]: steps are from row to row, in numbers for
/// the matrix and in rows for `in` and `out`.
template <class T> struct Product {
    int rows, inner;
    const T *matrix;
    int row_step, inner_step;
    const T *in;
    int in_step;
    T *out;
    int out_step;
    bool add;
};

template <int components, int rows, class T, int lanes>
BEZSOMA_INLINE void product_of_rows(const Product<T> &x, int r) {
    using R = Lanes<T, lanes>;
    constexpr int row = components * lanes;
    T *out = x.out + r * x.out_step * row;
    const T *in = x.in, *matrix = x.matrix + r * x.row_step;
    R sum[rows][components];
#pragma GCC unroll 4
    for (int k = 0; k < rows; ++k)
#pragma GCC unroll 10
        for (int c = 0; c < components; ++c)
            sum[k][c] = x.add ? load<T, lanes>(out + k * x.out_step * row + c * lanes) : R{};
    for (int i = 0; i < x.inner; ++i, in += x.in_step * row, matrix += x.inner_step) {
        R factor[rows];
#pragma GCC unroll 4
        for (int k = 0; k < rows; ++k)
            factor[k] = R{} + matrix[k * x.row_step];
#pragma GCC unroll 10
        for (int c = 0; c < components; ++c) {
            const R value = load<T, lanes>(in + c * lanes);
#pragma GCC unroll 4
            for (int k = 0; k < rows; ++k)
                sum[k][c] += factor[k] * value;
        }
    }
#pragma GCC unroll 4
    for (int k = 0; k < rows; ++k)
#pragma GCC unroll 10
        for (int c = 0; c < components; ++c)
            store<T, lanes>(out + k * x.out_step * row + c * lanes, sum[k][c]);
}

template <int components, int rows, class T, int lanes>
BEZSOMA_INLINE void rest_of_product(const Product<T> &x, int r) {
    if (x.rows - r == rows)
        product_of_rows<components, rows, T, lanes>(x, r);
    else if constexpr (rows > 1)
        rest_of_product<components, rows - 1, T, lanes>(x, r);
}

template <int components, class T, int lanes>
__attribute__((noinline)) void product(const Product<T> &x) {
    constexpr int many = rows_at_once(components);
    int r = 0;
    for (; r + many <= x.rows; r += many)
        product_of_rows<components, many, T, lanes>(x, r);
    if constexpr (many > 1)
        rest_of_product<components, many - 1, T, lanes>(x, r);
}

/// Four rows become their sums with the four characters, in place if `to` is `from`.
template <int components, class T, int lanes>
BEZSOMA_INLINE void four_sums(const T *const (&from)[4], T *const (&to)[4]) {
    using R = Lanes<T, lanes>;
    for (int c = 0; c < components * lanes; c += lanes) {
        const R a = load<T, lanes>(from[0] + c), b = load<T, lanes>(from[1] + c);
        const R d = load<T, lanes>(from[2] + c), e = load<T, lanes>(from[3] + c);
        const R ab = a + b, a_b = a - b, de = d + e, d_e = d - e;
        store<T, lanes>(to[0] + c, ab + de);
        store<T, lanes>(to[1] + c, ab - de);
        store<T, lanes>(to[2] + c, a_b + d_e);
        store<T, lanes>(to[3] + c, a_b - d_e);
    }
}

template <int components, class T, int lanes>
BEZSOMA_INLINE void two_sums(const T *a, const T *b, T *sum, T *difference) {
    using R = Lanes<T, lanes>;
    for (int c = 0; c < components * lanes; c += lanes) {
        const R x = load<T, lanes>(a + c), y = load<T, lanes>(b + c);
        store<T, lanes>(sum + c, x + y);
        store<T, lanes>(difference + c, x - y);
    }
}

/// Controls to their sums, or (back) moments of sums to those of controls.
template <int components, bool back, class T, int lanes>
__attribute__((noinline)) void folded(const Rule<T> &rule, const T *from, T *to) {
    constexpr int row = components * lanes;
    for (int o = 0; o < rule.orbits; ++o) {
        const ControlOrbit &orbit = rule.orbit[o];
        const std::int32_t *in = back ? orbit.sum : orbit.control;
        const std::int32_t *out = back ? orbit.control : orbit.sum;
        if (orbit.controls == 4) {
            const T *const rows[4] = {from + in[0] * row, from + in[1] * row, from + in[2] * row,
                                      from + in[3] * row};
            T *const sums[4] = {to + out[0] * row, to + out[1] * row, to + out[2] * row,
                                to + out[3] * row};
            four_sums<components, T, lanes>(rows, sums);
        } else if (orbit.controls == 2) { // the one character beside + + + + that has a sum
            const int k = orbit.sum[1] >= 0 ? 1 : orbit.sum[2] >= 0 ? 2 : 3;
            const int j = orbit.control[1] != orbit.control[0] ? 1 : 2;
            two_sums<components, T, lanes>(from + in[0] * row, from + in[back ? k : j] * row,
                                           to + out[0] * row, to + out[back ? j : k] * row);
        } else {
            for (int c = 0; c < row; c += lanes)
                store<T, lanes>(to + out[0] * row + c, load<T, lanes>(from + in[0] * row + c));
        }
    }
}

/// From sums to the points first .. first + many.
template <int components, class T, int lanes>
BEZSOMA_INLINE void at_points(const Rule<T> &rule, int first, int many, const T *from, T *to) {
    constexpr int row = components * lanes;
    const int m = rule.controls;
    if (first >= 4 * rule.fours) {
        product<components, T, lanes>(
            {many, m, rule.values + first * m, m, 1, from, 1, to, 1, false});
        return;
    }
    for (int k = 0; k < 4; ++k) {
        const int begin = rule.begin[k], inner = rule.begin[k + 1] - begin;
        product<components, T, lanes>({many / 4, inner, rule.values + first * m + begin, 4 * m, 1,
                                       from + begin * row, 1, to + k * row, 4, false});
    }
    for (int q = 0; q < many; q += 4) {
        T *const rows[4] = {to + q * row, to + (q + 1) * row, to + (q + 2) * row,
                            to + (q + 3) * row};
        four_sums<components, T, lanes>({rows[0], rows[1], rows[2], rows[3]}, rows);
    }
}

/// Adds what these points give to the moments of sums; `from` is overwritten.
template <int components, class T, int lanes>
BEZSOMA_INLINE void tested(const Rule<T> &rule, int first, int many, T *from, T *to) {
    constexpr int row = components * lanes;
    if (first >= 4 * rule.fours) {
        product<components, T, lanes>({rule.controls, many, rule.tests + first, rule.points, 1,
                                       from, 1, to, 1, first > 0});
        return;
    }
    for (int q = 0; q < many; q += 4) {
        T *const rows[4] = {from + q * row, from + (q + 1) * row, from + (q + 2) * row,
                            from + (q + 3) * row};
        four_sums<components, T, lanes>({rows[0], rows[1], rows[2], rows[3]}, rows);
    }
    for (int k = 0; k < 4; ++k) {
        const int begin = rule.begin[k], inner = rule.begin[k + 1] - begin;
        product<components, T, lanes>({inner, many / 4, rule.tests + begin * rule.points + first,
                                       rule.points, 4, from + k * row, 4, to + begin * row, 1,
                                       first > 0});
    }
}

} // namespace bezsoma::BEZSOMA_ISA
