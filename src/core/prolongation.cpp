// SPDX-License-Identifier: BSD-3-Clause
#include "prolongation.hpp"

#include <cmath>
#include <cstring>

namespace bezsoma {

namespace {

// Eight floats, which hold a row of six; the compiler splits what the processor does not have.
using Eight = float __attribute__((vector_size(32)));

void load(const float *from, Eight &to) { std::memcpy(&to, from, sizeof to); }

void store_motions(const Eight &from, float *to) {
    std::memcpy(to, &from, motions * sizeof(float));
}

/// Modified Gram-Schmidt on the columns of x (rows, 6); r (6, 6) gives x = q r.
void orthonormal(std::vector<double> &x, double *r) {
    const std::size_t rows = x.size() / motions;
    const auto dot = [&](std::size_t k, std::size_t l) {
        double sum = 0;
        for (std::size_t i = 0; i < rows; ++i)
            sum += x[i * motions + k] * x[i * motions + l];
        return sum;
    };
    for (std::size_t k = 0; k < motions; ++k) {
        const double before = std::sqrt(dot(k, k));
        for (std::size_t l = 0; l < k; ++l) {
            const double along = r[l * motions + k] = dot(k, l);
            for (std::size_t i = 0; i < rows; ++i)
                x[i * motions + k] -= along * x[i * motions + l];
        }
        const double length = std::sqrt(dot(k, k));
        const bool kept = length > 1e-6 * before && length > 0;
        r[k * motions + k] = kept ? length : 0;
        for (std::size_t i = 0; i < rows; ++i)
            x[i * motions + k] *= kept ? 1 / length : 0;
    }
}

/// The rows of each aggregate, ascending.
Sparsity members(const Aggregates &groups) {
    Sparsity found{std::vector<std::int64_t>(size_of(groups.count) + 1), {}};
    for (const std::int32_t g : groups.of)
        if (g >= 0)
            ++found.start[size_of(g) + 1];
    std::partial_sum(found.start.begin(), found.start.end(), found.start.begin());
    found.column.resize(size_of(found.start.back()));
    std::vector<std::int64_t> at(found.start.begin(), found.start.end() - 1);
    for (std::size_t i = 0; i < groups.of.size(); ++i)
        if (groups.of[i] >= 0)
            found.column[size_of(at[size_of(groups.of[i])]++)] = static_cast<std::int32_t>(i);
    return found;
}

/// Where each group stands among the columns of a row at hand, one list a thread.
using Places = std::vector<std::vector<std::int32_t>>;

/// sums (groups, n, 8) = the row of A T.
template <int n>
void add_couplings(const BlockRows &a, std::size_t i, const std::vector<float> &basis,
                   const Aggregates &groups, const std::vector<std::int32_t> &place, Eight *sums) {
    Eight row;
    for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at) {
        const auto j = size_of(a.column[at]);
        if (groups.of[j] < 0)
            continue;
        const float *block = a.value.data() + at * n * n;
        Eight *to = sums + place[size_of(groups.of[j])] * n;
        for (int l = 0; l < n; ++l) {
            load(basis.data() + (j * n + size_of(l)) * motions, row);
            for (int k = 0; k < n; ++k)
                to[k] += block[l * n + k] * row;
        }
    }
}

template <int n>
void smooth_row(const BlockRows &a, std::size_t i, const float *inverse, float omega,
                const std::vector<float> &basis, const Aggregates &groups,
                std::vector<std::int32_t> &place, BlockRows &p) {
    const auto begin = size_of(p.start[i]), end = size_of(p.start[i + 1]);
    for (auto at = begin; at < end; ++at)
        place[size_of(p.column[at])] = static_cast<std::int32_t>(at - begin);
    std::vector<Eight> sums((end - begin) * n, Eight{});
    add_couplings<n>(a, i, basis, groups, place, sums.data());
    for (auto at = begin; at < end; ++at)
        for (int k = 0; k < n; ++k) {
            Eight row{};
            if (p.column[at] == groups.of[i])
                load(basis.data() + (i * n + size_of(k)) * motions, row);
            for (int l = 0; l < n; ++l)
                row -= omega * inverse[l * n + k] * sums[(at - begin) * n + size_of(l)];
            store_motions(row, p.value.data() + (at * n + size_of(k)) * motions);
        }
}

} // namespace

std::vector<double> rigid_motions(const double *points, const std::uint8_t *fixed,
                                  std::size_t vertices) {
    double centre[3] = {}, largest = 0;
    for (std::size_t i = 0; i < 3 * vertices; ++i)
        centre[i % 3] += points[i] / static_cast<double>(vertices);
    for (std::size_t i = 0; i < 3 * vertices; ++i)
        largest = std::max(largest, std::abs(points[i] - centre[i % 3]));
    std::vector<double> found(vertices * 3 * motions);
    for (std::size_t v = 0; v < vertices; ++v) {
        double x[3];
        for (std::size_t k = 0; k < 3; ++k)
            x[k] = (points[3 * v + k] - centre[k]) / largest;
        const double rows[3][motions] = {
            {1, 0, 0, 0, x[2], -x[1]}, {0, 1, 0, -x[2], 0, x[0]}, {0, 0, 1, x[1], -x[0], 0}};
        for (std::size_t k = 0; k < 3; ++k)
            if (!fixed[3 * v + k])
                std::copy_n(rows[k], motions, found.data() + (3 * v + k) * motions);
    }
    return found;
}

Tentative tentative(const std::vector<double> &of_rows, int high, const Aggregates &groups,
                    Team &team) {
    const std::size_t block = size_of(high) * motions;
    const Sparsity member = members(groups);
    Tentative made{std::vector<float>(of_rows.size() + BlockRows::slack),
                   std::vector<double>(size_of(groups.count) * motions * motions)};
    std::vector<std::vector<double>> scratch(team.size());
    each_row(team, groups.count, [&](std::size_t g, std::size_t thread) {
        std::vector<double> &x = scratch[thread];
        x.clear();
        for (auto m = size_of(member.start[g]); m < size_of(member.start[g + 1]); ++m) {
            const double *row = of_rows.data() + size_of(member.column[m]) * block;
            x.insert(x.end(), row, row + block);
        }
        orthonormal(x, made.coarse.data() + g * motions * motions);
        const double *row = x.data();
        for (auto m = size_of(member.start[g]); m < size_of(member.start[g + 1]); ++m)
            for (std::size_t k = 0; k < block; ++k)
                made.basis[size_of(member.column[m]) * block + k] = static_cast<float>(*row++);
    });
    return made;
}

BlockRows smoothed(const BlockRows &a, const std::vector<float> &inverse, double omega,
                   const std::vector<float> &basis, const Aggregates &groups, Team &team) {
    BlockRows p = with_pattern(
        sparsity(team, a.rows(), groups.count,
                 [&](std::size_t i, const auto &take) {
                     for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at)
                         if (const auto g = groups.of[size_of(a.column[at])]; g >= 0)
                             take(g);
                 }),
        a.high, motions, team);
    Places places(team.size());
    const auto step = static_cast<float>(omega);
    each_row(team, a.rows(), [&](std::size_t i, std::size_t thread) {
        places[thread].resize(size_of(groups.count));
        const float *d = inverse.data() + i * size_of(a.high * a.high);
        if (a.high == 3)
            smooth_row<3>(a, i, d, step, basis, groups, places[thread], p);
        else
            smooth_row<6>(a, i, d, step, basis, groups, places[thread], p);
    });
    return p;
}

} // namespace bezsoma
