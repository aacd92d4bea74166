// SPDX-License-Identifier: BSD-3-Clause
// Forces of any law on a batch of tets, by quadrature.
//
// The gradient of degree m = n - 1 is formed control by control as for the linear law
// (elastic_kernel.hpp). Products with a constant matrix take it to the points and the stress there
// back to moments; between them stands the law, which knows neither degree nor net:
//
//   H_q = sum_b B_b(x_q) H_b        S_b = sum_q w_q B_b(x_q) P(H_q)
//   H_b = n sum_i u_(b+e_i) g_i^T   f_a = n V sum_i S_(a-e_i) g_i
//
// A tangent forms H anew at each point: kept for every point it would cost more to read.
#pragma once

#include "elastic_kernel.hpp"
#include "pointwise_kernels.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// Rows of a product that share the registers.
constexpr int rows_at_once(int components) {
    return BEZSOMA_BYTES == 64 ? (components < 9 ? 4 : 3) : components < 9 ? 2 : 1;
}

/// out[r] = (add ? out[r] : 0) + sum_i matrix[r, i] in[i] for `rows` rows of so many components.
template <int components, int rows, class T, int lanes>
BEZSOMA_INLINE void product_of_rows(int inner, const T *matrix, int stride, const T *in, T *out,
                                    bool add) {
    using R = Lanes<T, lanes>;
    R sum[rows][components];
#pragma GCC unroll 4
    for (int r = 0; r < rows; ++r)
#pragma GCC unroll 10
        for (int c = 0; c < components; ++c)
            sum[r][c] = add ? load<T, lanes>(out + (r * components + c) * lanes) : R{};
    for (int i = 0; i < inner; ++i, in += components * lanes) {
        R x[components];
#pragma GCC unroll 10
        for (int c = 0; c < components; ++c)
            x[c] = load<T, lanes>(in + c * lanes);
#pragma GCC unroll 4
        for (int r = 0; r < rows; ++r) {
            const R a = R{} + matrix[r * stride + i];
#pragma GCC unroll 10
            for (int c = 0; c < components; ++c)
                sum[r][c] += a * x[c];
        }
    }
#pragma GCC unroll 4
    for (int r = 0; r < rows; ++r)
#pragma GCC unroll 10
        for (int c = 0; c < components; ++c)
            store<T, lanes>(out + (r * components + c) * lanes, sum[r][c]);
}

template <int components, int rows, class T, int lanes>
BEZSOMA_INLINE void rest_of_product(int left, int inner, const T *matrix, int stride, const T *in,
                                    T *out, bool add) {
    if (left == rows)
        product_of_rows<components, rows, T, lanes>(inner, matrix, stride, in, out, add);
    else if constexpr (rows > 1)
        rest_of_product<components, rows - 1, T, lanes>(left, inner, matrix, stride, in, out, add);
}

/// out (rows, components, lanes) from in (inner, components, lanes).
template <int components, class T, int lanes>
__attribute__((noinline)) void product(int rows, int inner, const T *matrix, int stride,
                                       const T *in, T *out, bool add) {
    constexpr int many = rows_at_once(components);
    int r = 0;
    for (; r + many <= rows; r += many)
        product_of_rows<components, many, T, lanes>(inner, matrix + r * stride, stride, in,
                                                    out + r * components * lanes, add);
    if constexpr (many > 1)
        rest_of_product<components, many - 1, T, lanes>(rows - r, inner, matrix + r * stride,
                                                        stride, in, out + r * components * lanes,
                                                        add);
}

/// Where things lie in the scratch of a thread, in numbers.
template <int components, class T, int lanes> struct Scratch {
    T *state, *change, *answer;                         // (controls, components, lanes)
    T *state_there, *change_there, *answer_there, *watch; // (points at once, components, lanes)

    BEZSOMA_INLINE Scratch(T *begin, int controls) {
        constexpr int row = components * lanes;
        state = begin;
        change = state + controls * row;
        answer = change + controls * row;
        state_there = answer + controls * row;
        change_there = state_there + points_at_once * row;
        answer_there = change_there + points_at_once * row;
        watch = answer_there + points_at_once * row;
    }
};

/// The gradient controls (controls, components, lanes) of a batch: n times strains or H.
template <int n, int components, class T, int lanes>
BEZSOMA_INLINE void opened(const T *from, const std::int32_t *first, const Batch<T, lanes> &tet,
                           T *to) {
    using R = Lanes<T, lanes>;
    R u[3 * controls(n)];
    gather<n, T, lanes>(from, first, u);
    each_control<n - 1>([&](int p, int p1, int p2, int p3) {
        R h[3][3];
        gradient<T, lanes>(tet, u, p, p1, p2, p3, h);
        T *at = to + p * components * lanes;
#pragma GCC unroll 9
        for (int c = 0; c < components; ++c) {
            const int k = c % 3, l = (c + 1) % 3;
            const R entry = components == 9 ? h[c / 3][c % 3] : c < 3 ? h[c][c] : h[k][l] + h[l][k];
            store<T, lanes>(at + c * lanes, entry * static_cast<T>(n));
        }
    });
}

/// Adds the forces of moments (controls, components, lanes).
template <int n, int components, class T, int lanes>
BEZSOMA_INLINE void closed(const T *from, const std::int32_t *first, const Batch<T, lanes> &tet,
                           const Lanes<T, lanes> &volume, T *to) {
    using R = Lanes<T, lanes>;
    constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    R f[3 * controls(n)];
    for (int row = 0; row < 3 * controls(n); ++row)
        f[row] = R{};
    const R scale = volume * static_cast<T>(n);
    R g[3][3];
    for (int i = 0; i < 9; ++i)
        g[i / 3][i % 3] = tet.g[i / 3][i % 3] * scale;
    each_control<n - 1>([&](int p, int p1, int p2, int p3) {
        const T *at = from + p * components * lanes;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            R s[3];
#pragma GCC unroll 3
            for (int l = 0; l < 3; ++l)
                s[l] = load<T, lanes>(at + (components == 9 ? 3 * k + l : of[k][l]) * lanes);
            const R f1 = s[0] * g[0][0] + s[1] * g[0][1] + s[2] * g[0][2];
            const R f2 = s[0] * g[1][0] + s[1] * g[1][1] + s[2] * g[1][2];
            const R f3 = s[0] * g[2][0] + s[1] * g[2][1] + s[2] * g[2][2];
            f[3 * p + k] -= f1 + f2 + f3;
            f[3 * p1 + k] += f1;
            f[3 * p2 + k] += f2;
            f[3 * p3 + k] += f3;
        }
    });
    scatter<n, T, lanes>(to, first, f);
}

/// Takes what a law has seen in batch i.
template <class T, int lanes>
BEZSOMA_INLINE void look(const T *watch, std::int64_t i, Extremes &all) {
    for (int l = 0; l < lanes; ++l) {
        if (!(watch[l] >= all.least_J.value))
            all.least_J = {watch[l], i * lanes + l, static_cast<std::int32_t>(watch[lanes + l])};
        if (!(watch[2 * lanes + l] <= all.greatest_exponent.value))
            all.greatest_exponent = {watch[2 * lanes + l], i * lanes + l,
                                     static_cast<std::int32_t>(watch[3 * lanes + l])};
    }
}

enum class Asked { forces, tangent, energy };

template <int n, int components, Asked asked, class T, int lanes>
double of_batches(const PointwiseBatches<T> &b) {
    using R = Lanes<T, lanes>;
    const Rule<T> &rule = *b.rule;
    const Scratch<components, T, lanes> at(b.scratch, controls(n - 1));
    const auto law = asked == Asked::forces    ? b.law->stress
                     : asked == Asked::tangent ? b.law->derivative
                                               : b.law->energy;
    R energy = {};
    for (std::int64_t i = 0; i < b.count; ++i) {
        const std::int32_t *first = b.first + i * entities(n) * lanes;
        Batch<T, lanes> tet = {};
        for (int k = 0; k < 9; ++k)
            tet.g[k / 3][k % 3] = load<T, lanes>(b.geometry + (10 * i + k) * lanes);
        const R volume = load<T, lanes>(b.geometry + (10 * i + 9) * lanes);
        opened<n, components, T, lanes>(b.u, first, tet, at.state);
        if (asked == Asked::tangent)
            opened<n, components, T, lanes>(b.du, first, tet, at.change);
        for (int l = 0; l < lanes; ++l) {
            at.watch[l] = static_cast<T>(1e30);
            at.watch[2 * lanes + l] = static_cast<T>(-1e30);
            at.watch[lanes + l] = at.watch[3 * lanes + l] = 0;
        }
        for (int q = 0; q < rule.points; q += points_at_once) {
            const int many = rule.points - q < points_at_once ? rule.points - q : points_at_once;
            const T *values = rule.values + q * rule.controls;
            product<components, T, lanes>(many, rule.controls, values, rule.controls, at.state,
                                          at.state_there, false);
            if (asked == Asked::tangent)
                product<components, T, lanes>(many, rule.controls, values, rule.controls,
                                              at.change, at.change_there, false);
            law({many, q, b.parameters, b.terms, at.state_there, at.change_there, at.answer_there,
                 at.watch});
            if (asked == Asked::energy)
                for (int r = 0; r < many; ++r)
                    energy += load<T, lanes>(at.answer_there + r * lanes) *
                              (volume * rule.weights[q + r]);
            else
                product<components, T, lanes>(rule.controls, many, rule.tests + q, rule.points,
                                              at.answer_there, at.answer, q > 0);
        }
        if (asked != Asked::energy)
            closed<n, components, T, lanes>(at.answer, first, tet, volume, b.f);
        if (asked != Asked::tangent)
            look<T, lanes>(at.watch, i, *b.extremes);
    }
    double sum = 0;
    for (int l = 0; l < lanes; ++l)
        sum += energy[l];
    return sum;
}

template <int n, Asked asked, class T, int lanes>
double pointwise(const PointwiseBatches<T> &b) {
    return b.law->components == 6 ? of_batches<n, 6, asked, T, lanes>(b)
                                  : of_batches<n, 9, asked, T, lanes>(b);
}

} // namespace bezsoma::BEZSOMA_ISA
