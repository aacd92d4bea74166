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

#include "mixed_kernels.hpp"

#include "elastic_kernel.hpp"

#include "mixed_kernel.hpp"
#include "product.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// Where things lie in the scratch of a thread.
template <int components, class T, int lanes> struct Scratch {
    T *raw, *state, *change, *answer;                     // (controls, components, lanes)
    T *state_there, *change_there, *answer_there, *watch; // (points at once, components, lanes)

    BEZSOMA_INLINE Scratch(T *begin, int controls) {
        constexpr int row = components * lanes;
        raw = begin;
        state = raw + controls * row;
        change = state + controls * row;
        answer = change + controls * row;
        state_there = answer + controls * row;
        change_there = state_there + points_at_once * row;
        answer_there = change_there + points_at_once * row;
        watch = answer_there + points_at_once * row;
    }
};

/// The shapes of a batch: grad L_i.
template <class T, int lanes> BEZSOMA_INLINE Batch<T, lanes> shapes(const T *geometry) {
    Batch<T, lanes> tet = {};
    for (int k = 0; k < 9; ++k)
        tet.g[k / 3][k % 3] = load<T, lanes>(geometry + k * lanes);
    return tet;
}

/// The gradient controls (controls, row, lanes) of a batch: n times strains or H.
template <int n, int components, class T, int lanes>
void opened(const T *from, const std::int32_t *first, const T *geometry, T *to, int row) {
    using R = Lanes<T, lanes>;
    const Batch<T, lanes> tet = shapes<T, lanes>(geometry);
    R u[3 * controls(n)];
    gather<n, T, lanes>(from, first, u);
    each_control<n - 1>([&](int p, int p1, int p2, int p3) {
        R h[3][3];
        gradient<T, lanes>(tet, u, p, p1, p2, p3, h);
        T *at = to + p * row * lanes;
#pragma GCC unroll 9
        for (int c = 0; c < components; ++c) {
            const int k = c % 3, l = (c + 1) % 3;
            const R entry = components == 9 ? h[c / 3][k] : c < 3 ? h[k][k] : h[k][l] + h[l][k];
            store<T, lanes>(at + c * lanes, entry * static_cast<T>(n));
        }
    });
}

/// Adds the forces of moments (controls, row, lanes).
template <int n, int components, class T, int lanes>
void closed(const T *from, const std::int32_t *first, const T *geometry, T *to, int row) {
    using R = Lanes<T, lanes>;
    constexpr int of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    const R scale = load<T, lanes>(geometry + 9 * lanes) * static_cast<T>(n);
    Batch<T, lanes> tet = shapes<T, lanes>(geometry);
    for (int i = 0; i < 9; ++i)
        tet.g[i / 3][i % 3] *= scale;
    R f[3 * controls(n)];
    for (R &force : f)
        force = R{};
    each_control<n - 1>([&](int p, int p1, int p2, int p3) {
        const T *at = from + p * row * lanes;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            R s[3];
#pragma GCC unroll 3
            for (int l = 0; l < 3; ++l)
                s[l] = load<T, lanes>(at + (components == 9 ? 3 * k + l : of[k][l]) * lanes);
            const R f1 = s[0] * tet.g[0][0] + s[1] * tet.g[0][1] + s[2] * tet.g[0][2];
            const R f2 = s[0] * tet.g[1][0] + s[1] * tet.g[1][1] + s[2] * tet.g[1][2];
            const R f3 = s[0] * tet.g[2][0] + s[1] * tet.g[2][1] + s[2] * tet.g[2][2];
            f[3 * p + k] -= f1 + f2 + f3;
            f[3 * p1 + k] += f1;
            f[3 * p2 + k] += f2;
            f[3 * p3 + k] += f3;
        }
    });
    scatter<n, T, lanes>(to, first, f);
}

/// The pressure as the last component of each row, elevated to degree n - 1.
template <int n, int lanes>
void opened_pressure(int degree, const double *from, const std::int32_t *first, double *to,
                     int row) {
    Lanes<double, lanes> p[controls(n - 1)];
    gather_pressure<lanes>(degree, from, first, p);
    raise(degree, n - 1, p);
    for (int b = 0; b < controls(n - 1); ++b)
        store<double, lanes>(to + (b * row + row - 1) * lanes, p[b] * ladder_scales<n - 1>.top[b]);
}

/// Adds V times the moments in the last component of each row, lowered to the pressure's degree.
template <int n, int lanes>
void closed_pressure(int degree, const double *from, const std::int32_t *first,
                     const double *geometry, double *to, int row) {
    const Lanes<double, lanes> volume = load<double, lanes>(geometry + 9 * lanes);
    Lanes<double, lanes> g[controls(n - 1)];
    for (int b = 0; b < controls(n - 1); ++b)
        g[b] = load<double, lanes>(from + (b * row + row - 1) * lanes) * volume *
               ladder_scales<n - 1>.top[b];
    lower(n - 1, degree, g);
    scatter_pressure<lanes>(degree, to, first, g);
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

template <Asked asked, bool mixed, class T>
BEZSOMA_INLINE typename LawKernel<T>::At law_of(const LawKernel<T> &law) {
    if (asked == Asked::forces)
        return mixed ? law.mixed_stress : law.stress;
    if (asked == Asked::tangent)
        return mixed ? law.mixed_derivative : law.derivative;
    return mixed ? law.mixed_energy : law.energy;
}

/// The gradients, and in the mixed form the pressure, of batch i in the basis of the rule.
template <int components, bool mixed, class T, int lanes>
BEZSOMA_INLINE void brought(const PointwiseBatches<T> &b, std::int64_t i, const T *u, const T *p,
                            T *raw, T *to) {
    constexpr int row = components + mixed;
    const NetKernel<T> &net = *b.net;
    net.open[components == 9](u, b.first + i * net.entities * lanes, b.geometry + 10 * i * lanes,
                              raw, row);
    if constexpr (mixed)
        net.open_pressure(b.pressure_degree, p,
                          b.first_pressure + i * b.entities_of_pressure * lanes, raw, row);
    folded<row, false, T, lanes>(b.rule, raw, to);
}

/// Adds the forces, and in the mixed form the changes of volume, of batch i.
template <int components, bool mixed, class T, int lanes>
BEZSOMA_INLINE void taken(const PointwiseBatches<T> &b, std::int64_t i, const T *moments, T *raw) {
    constexpr int row = components + mixed;
    const NetKernel<T> &net = *b.net;
    const T *geometry = b.geometry + 10 * i * lanes;
    folded<row, true, T, lanes>(b.rule, moments, raw);
    net.close[components == 9](raw, b.first + i * net.entities * lanes, geometry, b.f, row);
    if constexpr (mixed)
        net.close_pressure(b.pressure_degree, raw,
                           b.first_pressure + i * b.entities_of_pressure * lanes, geometry, b.g,
                           row);
}

template <int components, bool mixed, Asked asked, class T, int lanes>
double of_batches(PointwiseBatches<T> &b) {
    using R = Lanes<T, lanes>;
    constexpr int row = components + mixed;
    const Rule<T> &rule = b.rule;
    const Scratch<row, T, lanes> at(b.scratch, rule.controls);
    const auto law = law_of<asked, mixed>(*b.law);
    R energy = {};
    for (std::int64_t i = 0; i < b.count; ++i) {
        brought<components, mixed, T, lanes>(b, i, b.u, b.p, at.raw, at.state);
        if constexpr (asked == Asked::tangent)
            brought<components, mixed, T, lanes>(b, i, b.du, b.dp, at.raw, at.change);
        for (int l = 0; l < lanes; ++l) {
            at.watch[l] = static_cast<T>(1e30);
            at.watch[2 * lanes + l] = static_cast<T>(-1e30);
            at.watch[lanes + l] = at.watch[3 * lanes + l] = 0;
        }
        for (int q = 0, many; q < rule.points; q += many) {
            const int end = q < 4 * rule.fours ? 4 * rule.fours : rule.points;
            many = end - q < points_at_once ? end - q : points_at_once;
            at_points<row, T, lanes>(rule, q, many, at.state, at.state_there);
            if constexpr (asked == Asked::tangent)
                at_points<row, T, lanes>(rule, q, many, at.change, at.change_there);
            law({many, q, b.parameters, b.terms, at.state_there, at.change_there, at.answer_there,
                 at.watch});
            if constexpr (asked == Asked::energy) {
                const R volume = load<T, lanes>(b.geometry + (10 * i + 9) * lanes);
                for (int r = 0; r < many; ++r)
                    energy += load<T, lanes>(at.answer_there + r * lanes) *
                              (volume * rule.weights[q + r]);
            } else {
                tested<row, T, lanes>(rule, q, many, at.answer_there, at.answer);
            }
        }
        if constexpr (asked != Asked::energy)
            taken<components, mixed, T, lanes>(b, i, at.answer, at.raw);
        if constexpr (asked != Asked::tangent)
            look<T, lanes>(at.watch, i, b.extremes);
    }
    double sum = 0;
    for (int l = 0; l < lanes; ++l)
        sum += energy[l];
    return sum;
}

template <Asked asked, class T, int lanes> double pointwise(PointwiseBatches<T> &b) {
    const bool small = b.law->components == 6;
    if constexpr (sizeof(T) == 8)
        if (b.first_pressure)
            return small ? of_batches<6, true, asked, T, lanes>(b)
                         : of_batches<9, true, asked, T, lanes>(b);
    return small ? of_batches<6, false, asked, T, lanes>(b)
                 : of_batches<9, false, asked, T, lanes>(b);
}

template <int n, class T, int lanes> static constexpr NetKernel<T> net_kernel() {
    NetKernel<T> kernel{};
    if constexpr (n <= BEZSOMA_HIGHEST_DEGREE) {
        kernel = {{opened<n, 6, T, lanes>, opened<n, 9, T, lanes>},
                  {closed<n, 6, T, lanes>, closed<n, 9, T, lanes>},
                  nullptr,
                  nullptr,
                  entities(n)};
        if constexpr (n >= 2 && n <= highest_mixed_degree && sizeof(T) == 8) {
            kernel.open_pressure = opened_pressure<n, lanes>;
            kernel.close_pressure = closed_pressure<n, lanes>;
        }
    }
    return kernel;
}

} // namespace bezsoma::BEZSOMA_ISA
