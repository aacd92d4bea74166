// SPDX-License-Identifier: BSD-3-Clause
#include "preconditioner.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "entity_blocks.hpp"

namespace bezsoma {

namespace {

std::size_t size(std::int64_t n) { return static_cast<std::size_t>(n); }

} // namespace

Preconditioner::Preconditioner(const ElasticTets &tets, const std::int32_t *corners,
                               std::int64_t vertices, const std::uint8_t *fixed,
                               const Chunks &chunks, const Kernels &kernels, Team &team)
    : lanes_(kernels.lanes64), kernel_(kernels.blocks[tets.degree - 1]), team_(team), rows_{},
      moments_from_{}, dots_(chunks.parts.size()) {
    const Entities found = entities(tets.degree, tets.first, corners, tets.tets, team);
    for (const Chunk &chunk : chunks.parts)
        range_.push_back(std::ranges::lower_bound(found.all, chunk.control, {}, &Entity::control) -
                         found.all.begin());
    range_.push_back(static_cast<std::int64_t>(found.all.size()));
    arrange(found);
    fill(tets, found, fixed);
    list_moments(vertices);
}

/// Gives every entity its lane among those of its chunk and dimension.
void Preconditioner::arrange(const Entities &entities) {
    for (std::size_t dim = 0; dim < 4; ++dim) {
        std::int64_t batch = 0;
        for (std::size_t part = 0; part + 1 < range_.size(); ++part) {
            team_.ask();
            std::int64_t count = 0;
            for (auto e = size(range_[part]); e < size(range_[part + 1]); ++e)
                if (size(entities.all[e].dim) == dim) {
                    number_[dim].push_back(static_cast<std::int32_t>(e));
                    ++count;
                }
            const std::int64_t batches = (count + lanes_ - 1) / lanes_;
            number_[dim].resize(size((batch + batches) * lanes_), -1);
            groups_[dim].push_back({count, batches, batch});
            batch += batches;
        }
    }
}

void Preconditioner::fill(const ElasticTets &tets, const Entities &entities,
                          const std::uint8_t *fixed) {
    const EntityBlocks blocks(tets, entities);
    std::size_t moments = 0;
    for (std::size_t dim = 0; dim < 4; ++dim) {
        const std::size_t rows = blocks.rows(static_cast<int>(dim)),
                          triangle = rows * (rows + 1) / 2;
        const std::size_t lanes = size(lanes_), all = number_[dim].size(), batches = all / lanes;
        rows_[dim] = static_cast<std::int64_t>(rows);
        control_[dim].resize(all);
        vertices_[dim].resize(all * (dim + 1));
        value_[dim].resize(all * triangle);
        z_[dim].resize(all * rows);
        moments_from_[dim] = moments;
        moments += all * 3 * (dim + 1);
        team_.run(batches, [&](std::size_t batch, std::size_t) {
            std::vector<double> scratch;
            std::vector<float> packed(triangle);
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const std::int32_t e = number_[dim][batch * lanes + lane];
                if (e < 0)
                    continue;
                const Entity &entity = entities.all[size(e)];
                control_[dim][batch * lanes + lane] = entity.control;
                for (std::size_t v = 0; v <= dim; ++v)
                    vertices_[dim][(batch * (dim + 1) + v) * lanes + lane] = entity.vertices[v];
                blocks.inverse(size(e), fixed, scratch, packed.data());
                for (std::size_t i = 0; i < triangle; ++i)
                    value_[dim][(batch * triangle + i) * lanes + lane] = packed[i];
            }
        });
    }
    if (moments > std::numeric_limits<std::uint32_t>::max())
        throw std::length_error("more than 2^32 moments of entities do not fit 32-bit places");
    moments_.resize(moments);
}

/// Where the moments of each vertex stand, in a fixed order.
void Preconditioner::list_moments(std::int64_t vertices) {
    moment_start_.assign(size(vertices) + 1, 0);
    const auto each = [&](const auto &visit) {
        for (std::size_t dim = 0; dim < 4; ++dim)
            in_turn(team_, number_[dim].size(), [&](std::size_t i) {
                for (std::size_t v = 0; v <= dim && number_[dim][i] >= 0; ++v) {
                    const std::size_t lanes = size(lanes_), batch = i / lanes, lane = i % lanes;
                    const std::size_t corner = batch * (dim + 1) + v;
                    visit(size(vertices_[dim][corner * lanes + lane]),
                          moments_from_[dim] + corner * 3 * lanes + lane);
                }
            });
    };
    each([&](std::size_t vertex, std::size_t) { ++moment_start_[vertex + 1]; });
    std::partial_sum(moment_start_.begin(), moment_start_.end(), moment_start_.begin());
    moment_.resize(size(moment_start_.back()));
    std::vector<std::int64_t> at(moment_start_.begin(), moment_start_.end() - 1);
    each([&](std::size_t vertex, std::size_t where) {
        moment_[size(at[vertex]++)] = static_cast<std::uint32_t>(where);
    });
    for (auto &numbers : number_)
        std::vector<std::int32_t>().swap(numbers);
}

BlockBatches Preconditioner::batches(std::size_t part, std::size_t dim) {
    const Group &group = groups_[dim][part];
    const std::int64_t corners = static_cast<std::int64_t>(dim) + 1, rows = rows_[dim];
    const std::int64_t lane = group.batch * lanes_;
    return {group.batches,
            control_[dim].data() + lane,
            vertices_[dim].data() + lane * corners,
            value_[dim].data() + lane * (rows * (rows + 1) / 2),
            z_[dim].data() + lane * rows,
            moments_.data() + moments_from_[dim] + lane * 3 * corners};
}

double Preconditioner::forward(const double *r, double norm, std::vector<float> &coarse) {
    team_.run(dots_.size(), [&](std::size_t part, std::size_t) {
        dots_[part] = 0;
        for (std::size_t dim = 0; dim < 4; ++dim)
            if (groups_[dim][part].batches > 0)
                dots_[part] += kernel_[dim].forward(batches(part, dim), r, 1 / norm);
    });
    constexpr std::size_t piece = 4096;
    const std::size_t vertices = moment_start_.size() - 1;
    coarse.resize(3 * vertices);
    team_.run((vertices + piece - 1) / piece, [&](std::size_t p, std::size_t) {
        for (std::size_t v = p * piece; v < std::min((p + 1) * piece, vertices); ++v) {
            float sum[3] = {};
            for (auto m = size(moment_start_[v]); m < size(moment_start_[v + 1]); ++m)
                for (int k = 0; k < 3; ++k)
                    sum[k] += moments_[moment_[m] + size(k * lanes_)];
            std::copy_n(sum, 3, coarse.data() + 3 * v);
        }
    });
    return std::accumulate(dots_.begin(), dots_.end(), 0.0) * norm * norm;
}

void Preconditioner::back(const std::vector<float> &coarse, double norm, double beta, double *p) {
    team_.run(dots_.size(), [&](std::size_t part, std::size_t) {
        for (std::size_t dim = 0; dim < 4; ++dim)
            if (const Group &group = groups_[dim][part]; group.batches > 0)
                kernel_[dim].back(batches(part, dim), group.entities, coarse.data(), norm, beta, p);
    });
}

std::size_t Preconditioner::bytes() const {
    std::size_t sum = 4 * (moment_.size() + moments_.size()) + 8 * moment_start_.size();
    for (std::size_t dim = 0; dim < 4; ++dim)
        sum += 4 *
               (control_[dim].size() + vertices_[dim].size() + value_[dim].size() + z_[dim].size());
    return sum;
}

} // namespace bezsoma
