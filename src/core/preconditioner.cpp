// SPDX-License-Identifier: BSD-3-Clause
#include "preconditioner.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "entity_blocks.hpp"
#include "large.hpp"
#include "vertex_reach.hpp"

namespace bezsoma {

namespace {

constexpr std::size_t piece = 4096; // vertices that a thread takes at a time

} // namespace

Preconditioner::Preconditioner(const ElasticTets &tets, const std::int32_t *corners,
                               std::int64_t vertices, const std::uint8_t *fixed,
                               const Chunks &chunks, const Kernels &kernels, Team &team)
    : lanes_(kernels.lanes64), kernel_(kernels.blocks[tets.degree - 1]), team_(team), rows_{},
      moments_from_{}, vertex_value_(size_of(6 * vertices)), vertex_z_(size_of(6 * vertices)),
      dots_(chunks.parts.size()), vertex_dots_((size_of(vertices) + piece - 1) / piece),
      scratch_(team.size()) {
    const Entities found = entities(tets.degree, tets.first, corners, tets.tets, team);
    for (const Chunk &chunk : chunks.parts) {
        control_of_.push_back(chunk.control);
        range_.push_back(std::ranges::lower_bound(found.all, chunk.control, {}, &Entity::control) -
                         found.all.begin());
    }
    control_of_.push_back(chunks.controls);
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
            for (auto e = size_of(range_[part]); e < size_of(range_[part + 1]); ++e)
                if (size_of(entities.all[e].dim) == dim) {
                    number_[dim].push_back(static_cast<std::int32_t>(e));
                    ++count;
                }
            const std::int64_t batches = (count + lanes_ - 1) / lanes_;
            number_[dim].resize(size_of((batch + batches) * lanes_), -1);
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
        const std::size_t lanes = size_of(lanes_), all = number_[dim].size(), batches = all / lanes;
        rows_[dim] = static_cast<std::int64_t>(rows);
        control_[dim].resize(all);
        vertices_[dim].resize(all * (dim + 1));
        make_large(value_[dim], dim > 0 ? all * triangle : 0, team_);
        make_large(z_[dim], dim > 0 ? all * rows : 0, team_);
        moments_from_[dim] = moments;
        moments += all * size_of(moments_of(static_cast<int>(dim)));
        team_.run(batches, [&](std::size_t batch, std::size_t) {
            std::vector<double> scratch;
            std::vector<float> packed(triangle);
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const std::int32_t e = number_[dim][batch * lanes + lane];
                if (e < 0)
                    continue;
                const Entity &entity = entities.all[size_of(e)];
                control_[dim][batch * lanes + lane] =
                    entity.control - static_cast<std::int32_t>(*std::prev(
                                         std::ranges::upper_bound(control_of_, entity.control)));
                for (std::size_t v = 0; v <= dim; ++v)
                    vertices_[dim][(batch * (dim + 1) + v) * lanes + lane] = entity.vertices[v];
                blocks.inverse(size_of(e), fixed, scratch, packed.data());
                float *to = dim > 0 ? value_[dim].data() + batch * triangle * lanes + lane
                                    : vertex_value_.data() + 6 * size_of(entity.vertices[0]);
                for (std::size_t i = 0; i < triangle; ++i)
                    to[dim > 0 ? i * lanes : i] = packed[i];
            }
        });
    }
    if (moments > std::numeric_limits<std::uint32_t>::max())
        throw std::length_error("more than 2^32 moments of entities do not fit 32-bit places");
    make_large(moments_, moments, team_);
}

/// Where the moments of each vertex stand, in a fixed order.
void Preconditioner::list_moments(std::int64_t vertices) {
    moment_start_.assign(size_of(vertices) + 1, 0);
    const auto each = [&](const auto &visit) {
        for (std::size_t dim = 0; dim < 4; ++dim)
            in_turn(team_, number_[dim].size(), [&](std::size_t i) {
                for (std::size_t v = 0; v <= dim && number_[dim][i] >= 0; ++v) {
                    const std::size_t lanes = size_of(lanes_), batch = i / lanes, lane = i % lanes;
                    const std::size_t corner = batch * (dim + 1) + v;
                    const std::size_t all = size_of(moments_of(static_cast<int>(dim)));
                    visit(size_of(vertices_[dim][corner * lanes + lane]),
                          moments_from_[dim] + (batch * all + 3 * v) * lanes + lane);
                }
            });
    };
    each([&](std::size_t vertex, std::size_t) { ++moment_start_[vertex + 1]; });
    std::partial_sum(moment_start_.begin(), moment_start_.end(), moment_start_.begin());
    make_large(moment_, size_of(moment_start_.back()), team_);
    std::vector<std::int64_t> at(moment_start_.begin(), moment_start_.end() - 1);
    each([&](std::size_t vertex, std::size_t where) {
        moment_[size_of(at[vertex]++)] = static_cast<std::uint32_t>(where);
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
            dim > 0 ? value_[dim].data() + lane * (rows * (rows + 1) / 2) : nullptr,
            dim > 0 ? z_[dim].data() + lane * rows : nullptr,
            moments_.data() + moments_from_[dim] + lane * moments_of(static_cast<int>(dim))};
}

/// Of the entities of a chunk, whose own controls' residual is `own`.
double Preconditioner::forward_of(std::size_t part, const double *own, double scale) {
    double sum = 0;
    for (std::size_t dim = 0; dim < 4; ++dim)
        if (groups_[dim][part].batches > 0)
            sum += kernel_[dim].forward(batches(part, dim), own, scale);
    return sum;
}

void Preconditioner::back_of(std::size_t part, double norm, double beta, double *own) {
    for (std::size_t dim = 0; dim < 4; ++dim)
        if (const Group &group = groups_[dim][part]; group.batches > 0)
            kernel_[dim].back(batches(part, dim), group.entities, vertex_z_.data(), norm, beta,
                              own);
}

double Preconditioner::forward(const double *r, double norm, std::vector<float> &coarse) {
    team_.run(dots_.size(), [&](std::size_t part, std::size_t) {
        dots_[part] = forward_of(part, r + begin(part), 1 / norm);
    });
    return of_vertices(coarse) * norm * norm;
}

template <class T> void Preconditioner::read(const T *r, std::vector<float> &coarse) {
    team_.run(dots_.size(), [&](std::size_t part, std::size_t thread) {
        std::vector<double> &own = scratch_[thread];
        own.resize(length(part) + padding);
        std::copy_n(r + begin(part), length(part), own.begin());
        dots_[part] = forward_of(part, own.data(), 1.0);
    });
    of_vertices(coarse);
}

/// The forces of the degree-1 problem; returns r . z of all blocks, r scaled as it was read.
double Preconditioner::of_vertices(std::vector<float> &coarse) {
    const std::size_t vertices = moment_start_.size() - 1;
    coarse.resize(3 * vertices);
    team_.run(vertex_dots_.size(), [&](std::size_t p, std::size_t) {
        vertex_dots_[p] = 0;
        for (std::size_t v = p * piece; v < std::min((p + 1) * piece, vertices); ++v)
            vertex_dots_[p] += at_vertex(v, coarse.data() + 3 * v);
    });
    const double blocks = std::accumulate(dots_.begin(), dots_.end(), 0.0);
    return std::accumulate(vertex_dots_.begin(), vertex_dots_.end(), blocks);
}

/// Sums the moments at a vertex: those of degree 1 into `coarse`; keeps z of its own function and
/// returns their product.
double Preconditioner::at_vertex(std::size_t vertex, float *coarse) {
    float sum[3] = {}, own[3] = {};
    for (auto m = size_of(moment_start_[vertex]); m < size_of(moment_start_[vertex + 1]); ++m) {
        const std::size_t at = moment_[m], lanes = size_of(lanes_);
        for (std::size_t k = 0; k < 3; ++k)
            sum[k] += moments_[at + k * lanes];
        if (at < moments_from_[2])
            for (std::size_t k = at < moments_from_[1] ? 0 : 6, c = 0; c < 3; ++k, ++c)
                own[c] += moments_[at + k * lanes];
    }
    std::copy_n(sum, 3, coarse);
    const float *b = vertex_value_.data() + 6 * vertex;
    const float z[3] = {b[0] * own[0] + b[1] * own[1] + b[3] * own[2],
                        b[1] * own[0] + b[2] * own[1] + b[4] * own[2],
                        b[3] * own[0] + b[4] * own[1] + b[5] * own[2]};
    std::copy_n(z, 3, vertex_z_.data() + 6 * vertex + 3);
    return double{own[0]} * z[0] + double{own[1]} * z[1] + double{own[2]} * z[2];
}

/// Keeps the degree-1 answer beside those of the vertices' own functions.
void Preconditioner::keep(const std::vector<float> &coarse) {
    team_.run(vertex_dots_.size(), [&](std::size_t q, std::size_t) {
        for (std::size_t v = q * piece; v < std::min((q + 1) * piece, coarse.size() / 3); ++v)
            std::copy_n(coarse.data() + 3 * v, 3, vertex_z_.data() + 6 * v);
    });
}

void Preconditioner::back(const std::vector<float> &coarse, double norm, double beta, double *p) {
    keep(coarse);
    team_.run(dots_.size(),
              [&](std::size_t part, std::size_t) { back_of(part, norm, beta, p + begin(part)); });
}

template <class T> void Preconditioner::write(const std::vector<float> &coarse, T *z) {
    keep(coarse);
    team_.run(dots_.size(), [&](std::size_t part, std::size_t thread) {
        std::vector<double> &own = scratch_[thread];
        own.assign(length(part) + padding, 0.0);
        back_of(part, 1.0, 0.0, own.data());
        std::transform(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(length(part)),
                       z + begin(part), [](double x) { return static_cast<T>(x); });
    });
}

std::size_t Preconditioner::bytes() const {
    std::size_t sum = 4 * (moment_.size() + moments_.size()) + 8 * moment_start_.size() +
                      4 * (vertex_value_.size() + vertex_z_.size());
    for (std::size_t dim = 0; dim < 4; ++dim)
        sum += 4 *
               (control_[dim].size() + vertices_[dim].size() + value_[dim].size() + z_[dim].size());
    return sum;
}

template void Preconditioner::read(const double *, std::vector<float> &);
template void Preconditioner::read(const float *, std::vector<float> &);
template void Preconditioner::write(const std::vector<float> &, double *);
template void Preconditioner::write(const std::vector<float> &, float *);

} // namespace bezsoma
