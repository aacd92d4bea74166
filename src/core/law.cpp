// SPDX-License-Identifier: BSD-3-Clause
#include "law.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

namespace bezsoma {

const LawName law_names[number_of_laws] = {
    {"linear", 2, false},
    {"stiffening_frobenius", 3, false},
    {"stiffening_mean", 3, false},
    {"stiffening_frobenius_engineering", 3, false},
    {"stiffening_mean_engineering", 3, false},
    {"stiffening_energy", 3, false},
    {"stiffening_deviatoric", 3, false},
    {"st_venant_kirchhoff", 2, false},
    {"neo_hooke", 2, false},
    {"neo_hooke_isochoric", 2, false},
    {"mooney_rivlin", 3, false},
    {"ogden", 3, true},
    {"veronda_westmann", 3, false},
    {"guccione", 8, false},
};

int law_numbered(const char *name) {
    for (int i = 0; i < number_of_laws; ++i)
        if (!std::strcmp(law_names[i].name, name))
            return i;
    return -1;
}

Extremes nothing_seen() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {{infinity, -1, 0}, {-infinity, -1, 0}};
}

namespace {

constexpr int voigt[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

/// Writes state i into one lane.
void pack(const States &s, std::size_t i, int components, int lanes, int lane, double *to) {
    const double *H = s.H + 9 * i;
    for (int c = 0; c < 6 && components == 6; ++c) {
        const auto [k, l] = voigt[c];
        to[c * lanes + lane] = k == l ? H[4 * k] : H[3 * k + l] + H[3 * l + k];
    }
    for (int c = 0; c < 9 && components == 9; ++c)
        to[c * lanes + lane] = H[c];
    if (s.p)
        to[components * lanes + lane] = s.p[i];
}

void unpack(const double *from, int components, int lanes, int lane, double *P) {
    for (int c = 0; c < 9 && components == 9; ++c)
        P[c] = from[c * lanes + lane];
    for (int c = 0; c < 6 && components == 6; ++c) {
        const auto [k, l] = voigt[c];
        P[3 * k + l] = P[3 * l + k] = from[c * lanes + lane];
    }
}

LawKernel<double>::At kernel_of(const LawKernel<double> &law, Answer which, bool mixed) {
    switch (which) {
    case Answer::stress:
        return mixed ? law.mixed_stress : law.stress;
    case Answer::derivative:
        return mixed ? law.mixed_derivative : law.derivative;
    default:
        return mixed ? law.mixed_energy : law.energy;
    }
}

/// Takes what the lanes have seen of rows i, i + 1, ...
void look(const double *watch, std::size_t i, int lanes, std::size_t many, Extremes &all) {
    for (std::size_t l = 0; l < many; ++l) {
        const auto row = static_cast<std::int64_t>(i + l);
        if (const double J = watch[l]; !(J >= all.least_J.value))
            all.least_J = {J, row, 0};
        if (const double x = watch[2 * static_cast<std::size_t>(lanes) + l];
            !(x <= all.greatest_exponent.value))
            all.greatest_exponent = {x, row, 0};
    }
}

} // namespace

Extremes answers(const Law &law, const Kernels &kernels, Answer which, const States &state,
                 const States &change, double *P, double *c) {
    constexpr int most = 16;
    alignas(64) double at[10 * most], by[10 * most], found[10 * most], watch[4 * most];
    const LawKernel<double> &kernel = kernels.pointwise->laws[law.number];
    const bool mixed = state.p != nullptr;
    const int lanes = kernels.lanes64, components = kernel.components;
    const auto ask = kernel_of(kernel, which, mixed);
    Extremes all = nothing_seen();
    for (std::size_t i = 0; i < state.count; i += static_cast<std::size_t>(lanes)) {
        const std::size_t many = std::min(static_cast<std::size_t>(lanes), state.count - i);
        std::fill_n(at, 10 * most, 0.0);
        std::fill_n(by, 10 * most, 0.0);
        for (std::size_t l = 0; l < many; ++l) {
            pack(state, i + l, components, lanes, static_cast<int>(l), at);
            if (which == Answer::derivative)
                pack(change, i + l, components, lanes, static_cast<int>(l), by);
        }
        std::fill_n(watch, 2 * lanes, 1e30);
        std::fill_n(watch + 2 * lanes, 2 * lanes, -1e30);
        ask({1, 0, law.parameters.data(), law.terms(), at, by, found, watch});
        for (std::size_t l = 0; l < many; ++l) {
            if (which == Answer::energy) {
                P[i + l] = found[l];
                continue;
            }
            unpack(found, components, lanes, static_cast<int>(l), P + 9 * (i + l));
            if (mixed)
                c[i + l] = found[static_cast<std::size_t>(components * lanes) + l];
        }
        look(watch, i, lanes, many, all);
    }
    return all;
}

} // namespace bezsoma
