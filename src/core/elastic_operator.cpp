// SPDX-License-Identifier: BSD-3-Clause
#include "elastic_operator.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bezsoma {

namespace {

// u and f of a chunk fit the second-level cache, and small meshes still give every thread its
// share.
constexpr std::int64_t most_controls = 12000, least_controls = 1500, shares = 64;
constexpr std::size_t padding = 16; // numbers that a gather may read past the end

std::size_t size(std::int64_t n) { return static_cast<std::size_t>(n); }

} // namespace

std::int64_t controls_of_chunk(const ElasticTets &tets) {
    const std::int64_t expected = tets.tets * tets.degree * tets.degree * tets.degree / 6;
    return std::clamp(expected / shares, least_controls, most_controls);
}

TetShape ElasticTets::shape(std::int64_t i) const {
    const std::int64_t *at = corners + 4 * order[i];
    double edge[3][3];
    for (int e = 0; e < 3; ++e)
        for (int k = 0; k < 3; ++k)
            edge[e][k] = points[3 * at[e + 1] + k] - points[3 * at[0] + k];
    TetShape tet{};
    double (&g)[4][3] = tet.gradients;
    for (int e = 0; e < 3; ++e) { // grad L_1 = (p2 - p0) x (p3 - p0) / det and cyclic
        const double *b = edge[(e + 1) % 3], *c = edge[(e + 2) % 3];
        for (int k = 0; k < 3; ++k)
            g[e + 1][k] = b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3];
    }
    const double det = edge[0][0] * g[1][0] + edge[0][1] * g[1][1] + edge[0][2] * g[1][2];
    for (int k = 0; k < 3; ++k) {
        for (int e = 1; e < 4; ++e)
            g[e][k] /= det;
        g[0][k] = -(g[1][k] + g[2][k] + g[3][k]);
    }
    tet.volume = std::abs(det) / 6;
    return tet;
}

template <class T>
ElasticOperator<T>::ElasticOperator(const ElasticTets &tets, const Kernels &kernels, Team &team)
    : team_(team), chunks_(bezsoma::chunks(tets.degree, tets.first, tets.tets, controls_of_chunk(tets))),
      lame_(tets.lame, tets.lame + 2 * tets.regions), scratch_(team.size()) {
    if constexpr (sizeof(T) == 8) {
        kernel_ = kernels.f64[tets.degree - 1];
        lanes_ = kernels.lanes64;
    } else {
        kernel_ = kernels.f32[tets.degree - 1];
        lanes_ = kernels.lanes32;
    }
    pack(tets);
}

template <class T> void ElasticOperator<T>::pack(const ElasticTets &tets) {
    const std::int64_t per_tet = entities_of_tet(tets.degree);
    batch_.push_back(0);
    for (const Chunk &chunk : chunks_.parts)
        batch_.push_back(batch_.back() + (chunk.tets + lanes_ - 1) / lanes_);
    first_.resize(size(batch_.back() * per_tet * lanes_));
    region_.resize(size(batch_.back() * lanes_));
    geometry_.resize(size(batch_.back() * 9 * lanes_));
    team_.run(chunks_.parts.size(), [&](std::size_t c, std::size_t) {
        const Chunk &chunk = chunks_.parts[c];
        for (std::int64_t i = 0; i < chunk.tets; ++i) {
            const std::int64_t tet = chunk.tet + i;
            const std::int64_t batch = batch_[c] + i / lanes_, lane = i % lanes_;
            // Lanes without a tet keep geometry zero: they read control 0 and add nothing.
            for (std::int64_t e = 0; e < per_tet; ++e)
                first_[size((batch * per_tet + e) * lanes_ + lane)] =
                    chunks_.local[size(tet * per_tet + e)];
            const TetShape shape = tets.shape(tet);
            const double root = std::sqrt(shape.volume);
            for (std::int64_t k = 0; k < 9; ++k)
                geometry_[size((batch * 9 + k) * lanes_ + lane)] =
                    static_cast<T>(root * shape.gradients[1 + k / 3][k % 3]);
            region_[size(batch * lanes_ + lane)] = tets.region(tet);
        }
    });
    std::vector<std::int32_t>().swap(chunks_.local);
}

template <class T> void ElasticOperator<T>::apply(const T *u, T *f, int sides) {
    foreign_.resize(size(3 * chunks_.foreign * sides));
    const std::size_t parts = chunks_.parts.size();
    team_.run(parts, [&](std::size_t chunk, std::size_t thread) {
        forces_of_chunk(chunk, u, f, sides, scratch_[thread]);
    });
    team_.run(parts, [&](std::size_t chunk, std::size_t) { add_foreign(chunk, f, sides); });
}

/// Several sides are padded to whole registers while a chunk works on them.
template <class T> int ElasticOperator<T>::width(int sides) const {
    return sides == 1 ? 1 : (sides + lanes_ - 1) / lanes_ * lanes_;
}

template <class T> Batches<T> ElasticOperator<T>::batches(std::size_t c, const T *u, T *f) const {
    const std::int64_t b = batch_[c], per_tet = entities_of_tet(chunks_.degree);
    return {batch_[c + 1] - b,
            first_.data() + b * per_tet * lanes_,
            geometry_.data() + b * 9 * lanes_,
            region_.data() + b * lanes_,
            lame_.data(),
            u,
            f};
}

namespace {

/// Rows of `from` values each become rows of `to` values; returns the end of what was written.
template <class T> T *copied(const T *x, std::int64_t from, T *y, std::int64_t to, std::int64_t n) {
    if (from == to)
        return std::copy_n(x, n * to, y);
    for (std::int64_t i = 0; i < n; ++i)
        std::copy_n(x + i * from, std::min(from, to), y + i * to);
    return y + n * to;
}

} // namespace

/// The controls of a chunk, own ones first, sides padded; returns the end.
template <class T>
T *ElasticOperator<T>::take_over(const Chunk &chunk, const T *u, int sides, T *to) const {
    const std::int64_t wide = width(sides), row = 3 * std::int64_t{sides};
    to = copied(u + row * chunk.control, sides, to, wide, 3 * std::int64_t{chunk.owned});
    for (const Run &run : chunk.runs)
        to = copied(u + row * run.control, sides, to, wide, 3 * std::int64_t{run.length});
    return to;
}

template <class T>
void ElasticOperator<T>::forces_of_chunk(std::size_t c, const T *u, T *f, int sides,
                                         std::vector<T> &scratch) {
    const Chunk &chunk = chunks_.parts[c];
    const std::int64_t wide = width(sides);
    const std::size_t length = size(3 * (chunk.owned + chunk.foreign) * wide) + padding;
    if (scratch.size() < 2 * length)
        scratch.resize(2 * (size(3 * chunks_.largest * wide) + padding));
    T *own_u = scratch.data(), *own_f = own_u + length;
    if (wide != sides)
        std::fill_n(own_u, length, T{});
    take_over(chunk, u, sides, own_u);
    std::fill_n(own_f, length, T{});
    if (sides == 1)
        kernel_.apply(batches(c, own_u, own_f));
    else
        kernel_.apply_many(batches(c, own_u, own_f), static_cast<int>(wide));
    const std::int64_t row = 3 * std::int64_t{sides};
    copied(own_f, wide, f + row * chunk.control, sides, 3 * std::int64_t{chunk.owned});
    copied(own_f + 3 * wide * chunk.owned, wide, foreign_.data() + row * chunk.foreign_begin, sides,
           3 * std::int64_t{chunk.foreign});
}

template <class T> double ElasticOperator<T>::work(const T *u) {
    std::vector<double> sums(chunks_.parts.size());
    team_.run(sums.size(), [&](std::size_t c, std::size_t thread) {
        auto &scratch = scratch_[thread];
        if (const auto least = size(3 * std::int64_t{chunks_.largest}) + padding;
            scratch.size() < least)
            scratch.resize(2 * least);
        take_over(chunks_.parts[c], u, 1, scratch.data());
        sums[c] = kernel_.work(batches(c, scratch.data(), nullptr));
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

template <class T> void ElasticOperator<T>::add_foreign(std::size_t c, T *f, int sides) const {
    const std::int64_t row = 3 * std::int64_t{sides};
    for (const Addition &added : chunks_.parts[c].added) {
        const T *from = foreign_.data() + row * added.from;
        T *to = f + row * added.run.control;
        for (std::int64_t i = 0; i < row * added.run.length; ++i)
            to[i] += from[i];
    }
}

template class ElasticOperator<double>;
template class ElasticOperator<float>;

} // namespace bezsoma
