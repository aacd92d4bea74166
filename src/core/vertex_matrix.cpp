// SPDX-License-Identifier: BSD-3-Clause
#include "vertex_matrix.hpp"

namespace bezsoma {

namespace {

/// The corners of tets at each vertex: 4 tet + corner, ascending.
struct Around {
    std::vector<std::int64_t> start;
    std::vector<std::uint32_t> corner;
};

Around tets_around(const std::int32_t *corners, std::int64_t tets, std::int64_t vertices,
                   Team &team) {
    Around found{std::vector<std::int64_t>(size_of(vertices) + 1),
                 std::vector<std::uint32_t>(size_of(4 * tets))};
    in_turn(team, size_of(4 * tets),
            [&](std::size_t i) { ++found.start[size_of(corners[i]) + 1]; });
    std::partial_sum(found.start.begin(), found.start.end(), found.start.begin());
    std::vector<std::int64_t> at(found.start.begin(), found.start.end() - 1);
    in_turn(team, size_of(4 * tets), [&](std::size_t i) {
        found.corner[size_of(at[size_of(corners[i])]++)] = static_cast<std::uint32_t>(i);
    });
    return found;
}

/// Adds V (lambda g h^T + mu h g^T + mu g.h I) to a block (3, 3), column by column.
void add_coupling(const double *g, const double *h, double lambda, double mu, double *block) {
    const double dot = mu * (g[0] * h[0] + g[1] * h[1] + g[2] * h[2]);
    for (int l = 0; l < 3; ++l) {
        for (int k = 0; k < 3; ++k)
            block[3 * l + k] += lambda * g[k] * h[l] + mu * h[k] * g[l];
        block[4 * l] += dot;
    }
}

/// Rows of the matrix one by one.
struct Rows {
    const ElasticTets &tets;
    const std::int32_t *corners;
    const Around &around;
    const std::uint8_t *fixed;

    /// Sums in float64: what cancels between tets should leave float32 rounding only.
    void sum(std::size_t v, const std::vector<std::int32_t> &place, double *row) const {
        for (auto i = size_of(around.start[v]); i < size_of(around.start[v + 1]); ++i) {
            const std::uint32_t tet = around.corner[i] / 4;
            const TetShape shape = tets.shape(tet);
            const double lambda = shape.volume * tets.lambda(tet);
            const double mu = shape.volume * tets.mu(tet);
            for (std::size_t j = 0; j < 4; ++j)
                add_coupling(shape.gradients[around.corner[i] % 4], shape.gradients[j], lambda, mu,
                             row + 9 * place[size_of(corners[4 * std::size_t{tet} + j])]);
        }
    }

    void write(std::size_t v, const double *row, BlockRows &a) const {
        for (auto at = size_of(a.start[v]); at < size_of(a.start[v + 1]); ++at)
            for (std::size_t l = 0; l < 3; ++l)
                for (std::size_t k = 0; k < 3; ++k, ++row) {
                    const std::size_t mine = 3 * v + k, other = 3 * size_of(a.column[at]) + l;
                    const bool out = mine != other && (fixed[mine] || fixed[other]);
                    a.value[9 * at + 3 * l + k] = out ? 0.0F : static_cast<float>(*row);
                }
    }
};

} // namespace

BlockRows vertex_matrix(const ElasticTets &tets, const std::int32_t *corners, std::int64_t vertices,
                        const std::uint8_t *fixed, Team &team) {
    const Around around = tets_around(corners, tets.tets, vertices, team);
    BlockRows a = with_pattern(
        sparsity(team, vertices, vertices,
                 [&](std::size_t v, const auto &take) {
                     for (auto i = size_of(around.start[v]); i < size_of(around.start[v + 1]); ++i)
                         for (std::size_t j = 0; j < 4; ++j)
                             take(corners[size_of(around.corner[i] / 4) * 4 + j]);
                 }),
        3, 3, team);
    const Rows rows{tets, corners, around, fixed};
    std::vector<std::vector<std::int32_t>> places(team.size());
    std::vector<std::vector<double>> sums(team.size());
    each_row(team, vertices, [&](std::size_t v, std::size_t thread) {
        std::vector<std::int32_t> &place = places[thread];
        place.resize(size_of(vertices));
        for (auto at = a.start[v]; at < a.start[v + 1]; ++at)
            place[size_of(a.column[size_of(at)])] = static_cast<std::int32_t>(at - a.start[v]);
        sums[thread].assign(9 * size_of(a.start[v + 1] - a.start[v]), 0.0);
        rows.sum(v, place, sums[thread].data());
        rows.write(v, sums[thread].data(), a);
    });
    return a;
}

} // namespace bezsoma
