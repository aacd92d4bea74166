// SPDX-License-Identifier: BSD-3-Clause
#include "elasticity.hpp"

#include <utility>

#include "simplex.hpp"

namespace bezsoma {

namespace {

/// Where (a, b), a <= b, stands in the upper triangle stored row by row.
std::size_t upper(std::size_t a, std::size_t b, std::size_t controls) {
    return a * controls - a * (a + 1) / 2 + b;
}

/// Where alpha - e_i stands among the multi-indices of one degree less.
std::size_t lowered(MultiIndex alpha, std::size_t i) {
    --alpha[i];
    return position(alpha);
}

void add_terms(std::vector<Term> &terms, const MultiIndex &a, const MultiIndex &b, double scale,
               const std::vector<double> &lower_mass, std::size_t lower_count) {
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            if (a[i] > 0 && b[j] > 0) {
                const double w = lower_mass[lowered(a, i) * lower_count + lowered(b, j)];
                terms.push_back({scale * w, static_cast<std::uint32_t>(4 * i + j)});
            }
}

} // namespace

Stiffness stiffness(int degree) {
    const auto all = multi_indices(degree);
    const auto lower_mass = mass(degree - 1);
    Stiffness k{all.size(), {0}, {}};
    for (std::size_t a = 0; a < all.size(); ++a)
        for (std::size_t b = a; b < all.size(); ++b) {
            add_terms(k.terms, all[a], all[b], degree * degree, lower_mass, count(degree - 1));
            k.start.push_back(static_cast<std::uint32_t>(k.terms.size()));
        }
    return k;
}

// Stands for B^T C B of the paper, eq. 31, which for an isotropic law is this.
Couplings couplings(const double *gradients, double volume, double lambda, double mu) {
    Couplings g{};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
            const double *p = gradients + 3 * i;
            const double *q = gradients + 3 * j;
            Block &out = g[4 * i + j];
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t l = 0; l < 3; ++l)
                    out[3 * k + l] = volume * (lambda * (p[k] * q[l]) + mu * (p[l] * q[k]));
            const double dot = volume * (mu * (p[0] * q[0] + p[1] * q[1] + p[2] * q[2]));
            for (std::size_t k = 0; k < 3; ++k)
                out[4 * k] += dot;
        }
    return g;
}

Block block(const Stiffness &k, const Couplings &g, std::size_t a, std::size_t b) {
    const bool below = a > b;
    const std::size_t at = below ? upper(b, a, k.controls) : upper(a, b, k.controls);
    Block sum{};
    for (std::uint32_t t = k.start[at]; t < k.start[at + 1]; ++t) {
        const Block &part = g[k.terms[t].pair];
        for (std::size_t e = 0; e < 9; ++e)
            sum[e] += k.terms[t].weight * part[e];
    }
    for (const auto &[up, low] : {std::pair<std::size_t, std::size_t>{1, 3}, {2, 6}, {5, 7}}) {
        if (below)
            std::swap(sum[up], sum[low]);
        if (a == b)
            sum[low] = sum[up]; // summed in another order they would differ in the last bit
    }
    return sum;
}

// The paper, eq. 34, each integral in closed form.
void element_matrices(const Stiffness &k, std::size_t tets, const double *gradients,
                      const double *volumes, const double *lambda, const double *mu, double *out) {
    const std::size_t m = k.controls;
    for (std::size_t t = 0; t < tets; ++t) {
        const Couplings g = couplings(gradients + 12 * t, volumes[t], lambda[t], mu[t]);
        double *matrix = out + t * 9 * m * m;
        for (std::size_t a = 0; a < m; ++a)
            for (std::size_t b = 0; b < m; ++b) {
                const Block entry = block(k, g, a, b);
                for (std::size_t e = 0; e < 9; ++e)
                    matrix[(3 * a + e / 3) * 3 * m + 3 * b + e % 3] = entry[e];
            }
    }
}

} // namespace bezsoma
