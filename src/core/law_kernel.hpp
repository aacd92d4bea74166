// SPDX-License-Identifier: BSD-3-Clause
// A law at the points of a batch: what turns formulas for one point into kernels.
#pragma once

#include "laws/finite_strain.hpp"
#include "laws/ogden.hpp"
#include "laws/small_strain.hpp"
#include "pointwise_kernels.hpp"

namespace bezsoma::BEZSOMA_ISA {

template <class T, int lanes> BEZSOMA_INLINE Watch<Lanes<T, lanes>> taken_up(const T *from) {
    Watch<Lanes<T, lanes>> watch;
    watch.least_J = load<T, lanes>(from);
    watch.least_at = load<T, lanes>(from + lanes);
    watch.greatest_exponent = load<T, lanes>(from + 2 * lanes);
    watch.greatest_at = load<T, lanes>(from + 3 * lanes);
    return watch;
}

template <class T, int lanes>
BEZSOMA_INLINE void put_down(const Watch<Lanes<T, lanes>> &watch, T *to) {
    store<T, lanes>(to, watch.least_J);
    store<T, lanes>(to + lanes, watch.least_at);
    store<T, lanes>(to + 2 * lanes, watch.greatest_exponent);
    store<T, lanes>(to + 3 * lanes, watch.greatest_at);
}

template <class Law, bool mixed, class T, int lanes> void stress(const AtPoints<T> &at) {
    using R = Lanes<T, lanes>;
    constexpr int components = Law::components + mixed;
    Watch<R> watch = taken_up<T, lanes>(at.watch);
    for (int q = 0; q < at.count; ++q) {
        R state[components], answer[components];
        for (int c = 0; c < components; ++c)
            state[c] = load<T, lanes>(at.state + (q * components + c) * lanes);
        watch.point = R{} + static_cast<T>(at.first + q);
        Law::template stress<mixed>(at.parameters, at.terms, state, answer, watch);
        for (int c = 0; c < components; ++c)
            store<T, lanes>(at.answer + (q * components + c) * lanes, answer[c]);
    }
    put_down<T, lanes>(watch, at.watch);
}

template <class Law, bool mixed, class T, int lanes> void derivative(const AtPoints<T> &at) {
    using R = Lanes<T, lanes>;
    constexpr int components = Law::components + mixed;
    Watch<R> watch;
    for (int q = 0; q < at.count; ++q) {
        R state[components], change[components], answer[components];
        for (int c = 0; c < components; ++c) {
            state[c] = load<T, lanes>(at.state + (q * components + c) * lanes);
            change[c] = load<T, lanes>(at.change + (q * components + c) * lanes);
        }
        Law::template derivative<mixed>(at.parameters, at.terms, state, change, answer, watch);
        for (int c = 0; c < components; ++c)
            store<T, lanes>(at.answer + (q * components + c) * lanes, answer[c]);
    }
}

template <class Law, bool mixed, class T, int lanes> void energy(const AtPoints<T> &at) {
    using R = Lanes<T, lanes>;
    constexpr int components = Law::components + mixed;
    Watch<R> watch = taken_up<T, lanes>(at.watch);
    for (int q = 0; q < at.count; ++q) {
        R state[components];
        for (int c = 0; c < components; ++c)
            state[c] = load<T, lanes>(at.state + (q * components + c) * lanes);
        watch.point = R{} + static_cast<T>(at.first + q);
        store<T, lanes>(at.answer + q * lanes,
                        Law::template energy<mixed>(at.parameters, at.terms, state, watch));
    }
    put_down<T, lanes>(watch, at.watch);
}

/// In float32 only the derivative is asked for.
template <class Law, class T, int lanes> static constexpr LawKernel<T> law_kernel() {
    LawKernel<T> kernel{};
    kernel.components = Law::components;
    kernel.finite = Law::finite;
    kernel.has_energy = Law::has_energy;
    kernel.derivative = derivative<Law, false, T, lanes>;
    if constexpr (sizeof(T) == 8) {
        kernel.stress = stress<Law, false, T, lanes>;
        if constexpr (Law::has_energy)
            kernel.energy = energy<Law, false, T, lanes>;
        if constexpr (Law::splits) {
            kernel.mixed_stress = stress<Law, true, T, lanes>;
            kernel.mixed_derivative = derivative<Law, true, T, lanes>;
            if constexpr (Law::has_energy)
                kernel.mixed_energy = energy<Law, true, T, lanes>;
        }
    }
    return kernel;
}

} // namespace bezsoma::BEZSOMA_ISA
