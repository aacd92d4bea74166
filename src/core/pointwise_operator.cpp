// SPDX-License-Identifier: BSD-3-Clause
#include "pointwise_operator.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tet_controls.hpp"

namespace bezsoma {

namespace {

// As for ElasticOperator: what a chunk works on fits the second-level cache.
constexpr std::int64_t most_controls = 12000, least_controls = 1500, shares = 64;
constexpr std::int64_t padding = 16;

std::size_t size(std::int64_t n) { return static_cast<std::size_t>(n); }

std::int64_t target(const ElasticTets &tets) {
    const std::int64_t expected = tets.tets * tets.degree * tets.degree * tets.degree / 6;
    return std::clamp(expected / shares, least_controls, most_controls);
}

} // namespace

PointwiseOperator::PointwiseOperator(const ElasticTets &tets, std::vector<Law> laws,
                                     const double *values, const double *weights,
                                     std::int32_t points, const Kernels &kernels, Team &team)
    : kernel_(kernels.pointwise->f64[tets.degree - 1]), law_kernels_(kernels.pointwise->laws),
      lanes_(kernels.lanes64), team_(team), laws_(std::move(laws)),
      values_(values, values + points * bezsoma::controls(tets.degree - 1)),
      weights_(weights, weights + points),
      chunks_(bezsoma::chunks(tets.degree, tets.first, tets.tets, target(tets))),
      foreign_(size(3 * chunks_.foreign)), sums_(chunks_.parts.size()),
      extremes_(chunks_.parts.size()), seen_(nothing_seen()), scratch_(team.size()) {
    const std::int32_t row = bezsoma::controls(tets.degree - 1);
    for (std::int32_t b = 0; b < row; ++b)
        for (std::int32_t q = 0; q < points; ++q)
            tests_.push_back(values[q * row + b] * weights[q]);
    rule_ = {points, row, values_.data(), tests_.data(), weights_.data()};
    group(tets);
    pack(tets);
    std::vector<std::int32_t>().swap(chunks_.local);
}

/// Numbers the batches: in each chunk region by region.
void PointwiseOperator::group(const ElasticTets &tets) {
    std::vector<std::int64_t> many(size(tets.regions));
    std::int64_t batch = 0;
    group_.push_back(0);
    for (const Chunk &chunk : chunks_.parts) {
        std::ranges::fill(many, 0);
        for (std::int64_t i = chunk.tet; i < chunk.tet + chunk.tets; ++i)
            ++many[size(tets.region(i))];
        for (std::int32_t region = 0; region < tets.regions; ++region)
            if (many[size(region)]) {
                const std::int64_t batches = (many[size(region)] + lanes_ - 1) / lanes_;
                groups_.push_back({batch, batches, region});
                batch += batches;
            }
        group_.push_back(groups_.size());
    }
    first_.resize(size(batch * entities_of_tet(tets.degree) * lanes_));
    geometry_.resize(size(batch * 10 * lanes_));
    tet_.assign(size(batch * lanes_), -1);
}

void PointwiseOperator::pack(const ElasticTets &tets) {
    const std::int64_t per_tet = entities_of_tet(tets.degree);
    team_.run(chunks_.parts.size(), [&](std::size_t c, std::size_t) {
        std::vector<std::int64_t> next(size(tets.regions));
        for (std::size_t g = group_[c]; g < group_[c + 1]; ++g)
            next[size(groups_[g].region)] = groups_[g].batch * lanes_;
        const Chunk &chunk = chunks_.parts[c];
        for (std::int64_t i = chunk.tet; i < chunk.tet + chunk.tets; ++i) {
            const std::int64_t place = next[size(tets.region(i))]++;
            const std::int64_t batch = place / lanes_, lane = place % lanes_;
            for (std::int64_t e = 0; e < per_tet; ++e)
                first_[size((batch * per_tet + e) * lanes_ + lane)] =
                    chunks_.local[size(i * per_tet + e)];
            const TetShape shape = tets.shape(i);
            double *geometry = geometry_.data() + batch * 10 * lanes_ + lane;
            for (std::int64_t k = 0; k < 9; ++k)
                geometry[k * lanes_] = shape.gradients[1 + k / 3][k % 3];
            geometry[9 * lanes_] = shape.volume;
            tet_[size(place)] = static_cast<std::int32_t>(tets.order[i]);
        }
    });
}

bool PointwiseOperator::has_energy() const {
    return std::ranges::all_of(
        laws_, [&](const Law &law) { return law_kernels_[law.number].has_energy; });
}

void PointwiseOperator::forces(const double *u, double *f) {
    run(u, nullptr, f, [](const auto &kernel, const auto &batches) {
        kernel.forces(batches);
        return 0.0;
    });
    take_seen();
}

void PointwiseOperator::tangent(const double *u, const double *du, double *df) {
    run(u, du, df, [](const auto &kernel, const auto &batches) {
        kernel.tangent(batches);
        return 0.0;
    });
}

double PointwiseOperator::energy(const double *u) {
    const double sum = run(u, nullptr, nullptr, [](const auto &kernel, const auto &batches) {
        return kernel.energy(batches);
    });
    take_seen();
    return sum;
}

double PointwiseOperator::run(const double *u, const double *du, double *f, Work work) {
    const std::size_t parts = chunks_.parts.size();
    team_.run(parts, [&](std::size_t chunk, std::size_t thread) {
        sums_[chunk] = on_chunk(chunk, u, du, f, work, scratch_[thread]);
    });
    if (f)
        team_.run(parts, [&](std::size_t chunk, std::size_t) { add_foreign(chunk, f); });
    return std::accumulate(sums_.begin(), sums_.end(), 0.0);
}

/// The controls of a chunk, own ones first; returns the end.
double *PointwiseOperator::take_over(const Chunk &chunk, const double *u, double *to) const {
    to = std::copy_n(u + 3 * std::int64_t{chunk.control}, 3 * chunk.owned, to);
    for (const Run &run : chunk.runs)
        to = std::copy_n(u + 3 * std::int64_t{run.control}, 3 * run.length, to);
    return to;
}

double PointwiseOperator::on_chunk(std::size_t c, const double *u, const double *du, double *f,
                                   Work work, std::vector<double> &scratch) {
    const Chunk &chunk = chunks_.parts[c];
    const std::int64_t length = 3 * std::int64_t{chunk.owned + chunk.foreign} + padding;
    const std::int64_t most = 3 * std::int64_t{chunks_.largest} + padding;
    const std::int64_t row = 10 * lanes_;
    scratch.resize(size(3 * most + 3 * row * (rule_.controls + points_at_once) + row));
    double *own_u = scratch.data(), *own_du = own_u + most, *own_f = own_du + most;
    take_over(chunk, u, own_u);
    if (du)
        take_over(chunk, du, own_du);
    std::fill_n(own_f, length, 0.0);
    Extremes &seen = extremes_[c] = nothing_seen();
    double sum = 0;
    const std::int64_t per_tet = entities_of_tet(chunks_.degree);
    for (std::size_t g = group_[c]; g < group_[c + 1]; ++g) {
        const Group &group = groups_[g];
        const Law &law = laws_[size(group.region)];
        Extremes here = nothing_seen();
        sum += work(kernel_, {group.batches, first_.data() + group.batch * per_tet * lanes_,
                              geometry_.data() + group.batch * 10 * lanes_, own_u, own_du, own_f,
                              law_kernels_ + law.number, law.parameters.data(), law.terms(),
                              &rule_, own_f + most, &here});
        const std::int64_t before = group.batch * lanes_;
        if (!(here.least_J.value >= seen.least_J.value)) {
            seen.least_J = here.least_J;
            seen.least_J.place += before;
        }
        if (!(here.greatest_exponent.value <= seen.greatest_exponent.value)) {
            seen.greatest_exponent = here.greatest_exponent;
            seen.greatest_exponent.place += before;
        }
    }
    if (f) {
        const std::int64_t owned = 3 * std::int64_t{chunk.owned};
        std::copy_n(own_f, owned, f + 3 * std::int64_t{chunk.control});
        std::copy_n(own_f + owned, 3 * chunk.foreign, foreign_.data() + 3 * chunk.foreign_begin);
    }
    return sum;
}

void PointwiseOperator::add_foreign(std::size_t c, double *f) const {
    for (const Addition &added : chunks_.parts[c].added) {
        const double *from = foreign_.data() + 3 * added.from;
        double *to = f + 3 * std::int64_t{added.run.control};
        for (std::int64_t i = 0; i < 3 * added.run.length; ++i)
            to[i] += from[i];
    }
}

/// The extremes of all chunks, in their order; places become numbers of tets.
void PointwiseOperator::take_seen() {
    seen_ = nothing_seen();
    for (const Extremes &here : extremes_) {
        if (!(here.least_J.value >= seen_.least_J.value))
            seen_.least_J = here.least_J;
        if (!(here.greatest_exponent.value <= seen_.greatest_exponent.value))
            seen_.greatest_exponent = here.greatest_exponent;
    }
    for (Extreme *x : {&seen_.least_J, &seen_.greatest_exponent})
        if (x->place >= 0)
            x->place = tet_[size(x->place)];
}

} // namespace bezsoma
