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

/// out[r] = (add ? out[r] : 0) + sum_i matrix[r, i] in[i]; `step` from row to row of the matrix.
template <class T> struct Product {
    int rows, inner;
    const T *matrix;
    int step;
    const T *in;
    T *out;
    bool add;
};

template <int components, int rows, class T, int lanes>
BEZSOMA_INLINE void product_of_rows(const Product<T> &x, int r) {
    using R = Lanes<T, lanes>;
    constexpr int row = components * lanes;
    T *out = x.out + r * row;
    const T *in = x.in, *matrix = x.matrix + r * x.step;
    R sum[rows][components];
#pragma GCC unroll 4
    for (int k = 0; k < rows; ++k)
#pragma GCC unroll 10
        for (int c = 0; c < components; ++c)
            sum[k][c] = x.add ? load<T, lanes>(out + k * row + c * lanes) : R{};
    for (int i = 0; i < x.inner; ++i, in += row, ++matrix) {
        R factor[rows];
#pragma GCC unroll 4
        for (int k = 0; k < rows; ++k)
            factor[k] = R{} + matrix[k * x.step];
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
            store<T, lanes>(out + k * row + c * lanes, sum[k][c]);
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

/// The four values that parts with the four characters have at a point and where it is moved; or
/// the sums of four values with these signs.
template <class R> BEZSOMA_INLINE void butterfly(R (&x)[4]) {
    const R ab = x[0] + x[1], a_b = x[0] - x[1], de = x[2] + x[3], d_e = x[2] - x[3];
    x[0] = ab + de;
    x[1] = ab - de;
    x[2] = a_b + d_e;
    x[3] = a_b - d_e;
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
            for (int c = 0; c < row; c += lanes) {
                Lanes<T, lanes> x[4];
#pragma GCC unroll 4
                for (int j = 0; j < 4; ++j)
                    x[j] = load<T, lanes>(from + in[j] * row + c);
                butterfly(x);
#pragma GCC unroll 4
                for (int j = 0; j < 4; ++j)
                    store<T, lanes>(to + out[j] * row + c, x[j]);
            }
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

/// Rows of four that share the registers, three components at a time.
constexpr int fours_at_once = BEZSOMA_BYTES == 64 ? 2 : 1;

/// `some` components from c on, from sums to `fours` times four points.
template <int components, int fours, int some, class T, int lanes>
BEZSOMA_INLINE void at_fours(const Rule<T> &rule, int first, const T *from, T *to) {
    using R = Lanes<T, lanes>;
    constexpr int row = components * lanes;
    R sum[fours][some][4] = {};
    const T *values = rule.values + first * rule.controls;
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k)
        for (int i = rule.begin[k]; i < rule.begin[k + 1]; ++i) {
            R x[some];
#pragma GCC unroll 3
            for (int c = 0; c < some; ++c)
                x[c] = load<T, lanes>(from + i * row + c * lanes);
#pragma GCC unroll 2
            for (int o = 0; o < fours; ++o) {
                const R factor = R{} + values[4 * o * rule.controls + i];
#pragma GCC unroll 3
                for (int c = 0; c < some; ++c)
                    sum[o][c][k] += factor * x[c];
            }
        }
#pragma GCC unroll 2
    for (int o = 0; o < fours; ++o)
#pragma GCC unroll 3
        for (int c = 0; c < some; ++c) {
            butterfly(sum[o][c]);
#pragma GCC unroll 4
            for (int j = 0; j < 4; ++j)
                store<T, lanes>(to + (4 * o + j) * row + c * lanes, sum[o][c][j]);
        }
}

/// The transposed of it: adds what these points give to the moments of sums.
template <int components, int fours, int some, class T, int lanes>
BEZSOMA_INLINE void tested_fours(const Rule<T> &rule, int first, const T *from, T *to) {
    using R = Lanes<T, lanes>;
    constexpr int row = components * lanes;
    R x[fours][some][4];
#pragma GCC unroll 2
    for (int o = 0; o < fours; ++o)
#pragma GCC unroll 3
        for (int c = 0; c < some; ++c) {
#pragma GCC unroll 4
            for (int j = 0; j < 4; ++j)
                x[o][c][j] = load<T, lanes>(from + (4 * o + j) * row + c * lanes);
            butterfly(x[o][c]);
        }
    const T *tests = rule.tests + first;
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k)
        for (int i = rule.begin[k]; i < rule.begin[k + 1]; ++i) {
            R factor[fours];
#pragma GCC unroll 2
            for (int o = 0; o < fours; ++o)
                factor[o] = R{} + tests[i * rule.points + 4 * o];
#pragma GCC unroll 3
            for (int c = 0; c < some; ++c) {
                T *at = to + i * row + c * lanes;
                R sum = first > 0 ? load<T, lanes>(at) : R{};
#pragma GCC unroll 2
                for (int o = 0; o < fours; ++o)
                    sum += factor[o] * x[o][c][k];
                store<T, lanes>(at, sum);
            }
        }
}

template <int components, int fours, bool test, class T, int lanes, int begin = 0>
BEZSOMA_INLINE void by_threes(const Rule<T> &rule, int first, const T *from, T *to) {
    if constexpr (begin < components) {
        constexpr int some = components - begin < 3 ? components - begin : 3;
        if constexpr (test)
            tested_fours<components, fours, some, T, lanes>(rule, first, from + begin * lanes,
                                                            to + begin * lanes);
        else
            at_fours<components, fours, some, T, lanes>(rule, first, from + begin * lanes,
                                                        to + begin * lanes);
        by_threes<components, fours, test, T, lanes, begin + some>(rule, first, from, to);
    }
}

/// Four after four of the points first .. first + many, from sums (or `test`: to their moments).
template <int components, bool test, class T, int lanes>
__attribute__((noinline)) void fours(const Rule<T> &rule, int first, int many, const T *from,
                                     T *to) {
    constexpr int row = components * lanes, step = 4 * fours_at_once;
    int q = 0;
    for (; q + step <= many; q += step)
        by_threes<components, fours_at_once, test, T, lanes>(
            rule, first + q, test ? from + q * row : from, test ? to : to + q * row);
    if constexpr (fours_at_once > 1)
        if (q < many)
            by_threes<components, 1, test, T, lanes>(rule, first + q, test ? from + q * row : from,
                                                     test ? to : to + q * row);
}

/// From sums to the points first .. first + many.
template <int components, class T, int lanes>
BEZSOMA_INLINE void at_points(const Rule<T> &rule, int first, int many, const T *from, T *to) {
    if (first < 4 * rule.fours)
        fours<components, false, T, lanes>(rule, first, many, from, to);
    else
        product<components, T, lanes>({many, rule.controls, rule.values + first * rule.controls,
                                       rule.controls, from, to, false});
}

/// Adds what these points give to the moments of sums.
template <int components, class T, int lanes>
BEZSOMA_INLINE void tested(const Rule<T> &rule, int first, int many, const T *from, T *to) {
    if (first < 4 * rule.fours)
        fours<components, true, T, lanes>(rule, first, many, from, to);
    else
        product<components, T, lanes>(
            {rule.controls, many, rule.tests + first, rule.points, from, to, first > 0});
}

} // namespace bezsoma::BEZSOMA_ISA
