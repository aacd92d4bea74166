// SPDX-License-Identifier: BSD-3-Clause
#include "elastic_operator.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "foreign.hpp"
#include "formed_shapes.hpp"
#include "large.hpp"

namespace bezsoma {

namespace {

// u and f of a chunk fit the second-level cache or nearly (an area may be twice as large), and from
// 72,000 controls on there are 48 of them or more, equal shares for 2, 3, 4, 6, 8, 12, 16 or 24
// threads. Smaller meshes have fewer: smaller chunks would touch more controls of others, which are
// copied one by one.
constexpr std::int64_t most_controls = 24000, least_controls = 1500, shares = 48;

/// The tet of a chunk, by the walk, at a place batch * lanes + lane: in a stretch of `apart`
/// batches each lane walks on from tet to tet.
std::int64_t tet_at(std::int64_t place, std::int64_t lanes, std::int64_t batches) {
    const std::int64_t batch = place / lanes, begin = batch / apart * apart;
    const std::int64_t stretch = std::min(apart, batches - begin);
    return begin * lanes + place % lanes * stretch + batch - begin;
}

/// Where a chunk's own controls begin in one of so many sides.
std::int64_t own_begin(const Chunk &chunk, std::int64_t sides) { return 3 * sides * chunk.control; }

/// Where a chunk's own points begin among (foreign, own) of all chunks.
std::int64_t first_point(const Chunk &chunk) {
    return 3 * (chunk.control + chunk.foreign_begin + std::ssize(chunk.foreign));
}

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
    const double inverse = 1 / det;
    for (int k = 0; k < 3; ++k) {
        for (int e = 1; e < 4; ++e)
            g[e][k] *= inverse;
        g[0][k] = -(g[1][k] + g[2][k] + g[3][k]);
    }
    tet.volume = std::abs(det) / 6;
    return tet;
}

template <class T>
ElasticOperator<T>::ElasticOperator(const ElasticTets &tets, const Kernels &kernels, Team &team)
    : team_(team),
      chunks_(bezsoma::chunks(tets.degree, tets.first, tets.tets, controls_of_chunk(tets), team)),
      lame_(tets.lame, tets.lame + 2 * tets.regions), scratch_(team.size()) {
    lame_.resize(lame_.size() + 2);
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
    make_large(first_, size_of(batch_.back() * per_tet * lanes_), team_);
    make_large(region_, size_of(batch_.back() * lanes_), team_);
    met_.resize(size_of(batch_.back()));
    if (forms_shapes<T>(tets.degree)) {
        make_large(points_, size_of(3 * (chunks_.controls + chunks_.foreign)) + padding, team_);
    } else {
        make_large(geometry_, size_of(batch_.back() * 9 * lanes_), team_);
    }
    team_.run(chunks_.parts.size(), [&](std::size_t c, std::size_t) {
        const Chunk &chunk = chunks_.parts[c];
        std::int32_t met = 0;
        const std::int64_t batches = batch_[c + 1] - batch_[c];
        const auto foreign = static_cast<std::int32_t>(chunk.foreign.size());
        for (std::int64_t place = 0; place < batches * lanes_; ++place) {
            const std::int64_t i = tet_at(place, lanes_, batches);
            const std::int64_t tet = chunk.tet + std::min(i, chunk.tets - 1);
            const std::int64_t batch = batch_[c] + place / lanes_, lane = place % lanes_;
            for (std::int64_t e = 0; e < per_tet; ++e) {
                const std::int32_t local = chunks_.local[size_of(tet * per_tet + e)];
                const bool own = local < chunk.owned;
                first_[size_of((batch * per_tet + e) * lanes_ + lane)] =
                    kernel_.row * (own ? local : local - chunk.owned - foreign);
                if (own)
                    met = std::max(met, local + controls_inside(tets.degree, static_cast<int>(e)));
            }
            met_[size_of(batch)] = met;
            // A lane too many: the last tet again, without stiffness, adds nothing.
            region_[size_of(batch * lanes_ + lane)] =
                i < chunk.tets ? tets.region(tet) : tets.regions;
            if (forms_shapes<T>(tets.degree))
                keep_points(tets, chunk, tet);
            else
                keep_shape(tets.shape(tet), geometry_.data() + batch * 9 * lanes_ + lane);
        }
    });
    std::vector<std::int32_t>().swap(chunks_.local);
}

template <class T> void ElasticOperator<T>::keep_shape(const TetShape &shape, T *geometry) const {
    const double root = std::sqrt(shape.volume);
    for (std::int64_t k = 0; k < 9; ++k)
        geometry[k * lanes_] = static_cast<T>(root * shape.gradients[1 + k / 3][k % 3]);
}

/// At degree 1, where controls are points.
template <class T>
void ElasticOperator<T>::keep_points(const ElasticTets &tets, const Chunk &chunk,
                                     std::int64_t tet) {
    for (std::int64_t v = 0; v < 4; ++v) {
        const std::int64_t local = chunks_.local[size_of(4 * tet + v)];
        const double *from = tets.points + 3 * tets.corners[4 * tets.order[tet] + v];
        T *to = points_.data() + first_point(chunk) +
                3 * (local < chunk.owned ? local : local - chunk.owned - std::ssize(chunk.foreign));
        for (int k = 0; k < 3; ++k)
            to[k] = static_cast<T>(from[k]);
    }
}

/// One thread comes to the chunks in their order, which is that of the sums: it adds what a chunk
/// has found for others at once, while it is at hand. Several wait until all chunks are done.
template <class T> void ElasticOperator<T>::apply(const T *u, T *f, int sides) {
    const bool alone = team_.size() == 1;
    const std::int64_t row = 3 * std::int64_t{sides};
    foreign_.resize(size_of(row * (alone ? chunks_.largest : chunks_.foreign)) +
                    cache_line / sizeof(T));
    T *const foreign = on_line(foreign_.data());
    const std::size_t parts = chunks_.parts.size();
    team_.run(parts, [&](std::size_t c, std::size_t thread) {
        const std::int64_t begin = alone ? 0 : row * chunks_.parts[c].foreign_begin;
        forces_of_chunk(c, u, f, foreign + begin, sides, alone, scratch_[thread]);
    });
    if (!alone)
        team_.run(parts, [&](std::size_t c, std::size_t) {
            add_rows(chunks_.parts[c].added, foreign, f, row);
        });
}

template <class T> Batches<T> ElasticOperator<T>::batches(std::size_t c) const {
    const std::int64_t b = batch_[c], per_tet = entities_of_tet(chunks_.degree);
    const T *shapes = forms_shapes<T>(chunks_.degree)
                          ? points_.data() + first_point(chunks_.parts[c])
                          : geometry_.data() + b * 9 * lanes_;
    return {.count = batch_[c + 1] - b,
            .first = first_.data() + b * per_tet * lanes_,
            .geometry = shapes,
            .region = region_.data() + b * lanes_,
            .met = met_.data() + b,
            .lame = lame_.data(),
            .u = nullptr,
            .u_end = nullptr,
            .f = nullptr,
            .f_end = nullptr,
            .area = nullptr};
}

namespace {

/// The forces of n controls of an area, in one side of `sides`.
template <class T> void forces_of_area(const T *area, std::int64_t n, T *f, std::int64_t sides) {
    with_row(3, sides, [&](auto row, auto step) {
        for (std::int64_t i = 0; i < n; ++i)
            for (std::int64_t k = 0; k < row; ++k)
                f[(row * i + k) * step] = area[row_of_area * i + forces_in_row + k];
    });
}

template <class T> void make_least(std::vector<T> &v, std::size_t n) {
    if (v.size() < n)
        v.resize(n);
}

} // namespace

/// A gather reads past the end of the own part of u.
template <class T> bool ElasticOperator<T>::may_read_past(const Chunk &chunk) const {
    return 3 * (chunks_.controls - chunk.control - chunk.owned) >= std::int64_t{padding};
}

/// Forces of a chunk's tets: on own controls in f, on foreign ones added to f by a thread that is
/// alone, or else in f_foreign. Sides too few to be worked on beside each other go one by one.
template <class T>
void ElasticOperator<T>::forces_of_chunk(std::size_t c, const T *u, T *f, T *f_foreign, int sides,
                                         bool alone, std::vector<T> &scratch) {
    const int beside = sides == 1 ? 0 : sides_beside(lanes_, sides);
    if (beside > 0)
        forces_beside(c, u, f, f_foreign, sides, alone, scratch);
    for (int side = beside; side < sides; ++side)
        if (works_in_area())
            forces_in_area(c, u + side, f + side, f_foreign + side, sides, alone, scratch);
        else
            forces_of_side(c, u + side, f + side, f_foreign + side, sides, alone, scratch);
}

/// Of the sides that are worked on beside each other.
template <class T>
void ElasticOperator<T>::forces_beside(std::size_t c, const T *u, T *f, T *f_foreign, int sides,
                                       bool alone, std::vector<T> &scratch) {
    const Chunk &chunk = chunks_.parts[c];
    const std::int64_t own = chunk.owned, foreign = std::ssize(chunk.foreign), row = 3 * sides;
    make_least(scratch, size_of(row * chunks_.largest) + padding + cache_line / sizeof(T));
    Batches<T> b = batches(c);
    T *next = on_line(scratch.data());
    b.u = u + row * chunk.control;
    if (!may_read_past(chunk)) {
        next = std::copy_n(b.u, row * own, next);
        b.u = next - row * own;
    }
    b.u_end = copy_rows(chunk.foreign, u, row, next);
    b.f = f + row * chunk.control;
    b.f_end = f_foreign + row * foreign;
    std::fill_n(f_foreign, row * foreign, T{});
    kernel_.apply_many(b, sides);
    if (alone)
        add_rows(chunk.foreign, f_foreign, row, f, row);
}

/// Of one side, where u, f and f_foreign begin. If there are others beside it its numbers are
/// brought together, and its forces come into vectors of the chunk first.
template <class T>
void ElasticOperator<T>::forces_of_side(std::size_t c, const T *u, T *f, T *f_foreign, int sides,
                                        bool alone, std::vector<T> &scratch) {
    const Chunk &chunk = chunks_.parts[c];
    const std::int64_t own = 3 * std::int64_t{chunk.owned}, foreign = 3 * std::ssize(chunk.foreign);
    const std::int64_t row = sides > 1 ? 3 + 3 : 3; // of u, and of f where it comes here first
    make_least(scratch, size_of(row * chunks_.largest) + padding + cache_line / sizeof(T));
    Batches<T> b = batches(c);
    T *next = on_line(scratch.data());
    b.u = u + own_begin(chunk, sides);
    if (sides > 1 || !may_read_past(chunk)) {
        const T *const from = b.u;
        b.u = next;
        for (std::int64_t i = 0; i < own; ++i)
            *next++ = from[i * sides];
    }
    b.u_end = copy_rows(chunk.foreign, u, 3, next, sides);
    T *const forces = next + foreign + padding; // a gather reads past u
    b.f = sides > 1 ? forces : f + own_begin(chunk, sides);
    T *const found = sides > 1 ? forces + own : f_foreign;
    b.f_end = found + foreign;
    std::fill_n(found, foreign, T{});
    kernel_.apply(b);
    if (sides > 1)
        for (std::int64_t i = 0; i < own; ++i)
            f[own_begin(chunk, sides) + i * sides] = b.f[i];
    if (alone)
        add_rows(chunk.foreign, found, 3, f, 3, sides);
    else if (sides > 1)
        for (std::int64_t i = 0; i < foreign; ++i)
            f_foreign[i * sides] = found[i];
}

/// The batches of a chunk with an area, into which its foreign controls have come, of one side.
template <class T>
Batches<T> ElasticOperator<T>::with_area(std::size_t c, const T *u, int sides,
                                         std::vector<T> &scratch) const {
    const Chunk &chunk = chunks_.parts[c];
    const std::int64_t row = row_of_area + (sides > 1 ? 3 : 0); // own numbers, brought together
    make_least(scratch, size_of(row * chunks_.largest) + cache_line / sizeof(T));
    Batches<T> b = batches(c);
    b.u = u + own_begin(chunk, sides);
    b.area = on_line(scratch.data());
    if (sides > 1) {
        T *const own = b.area + row_of_area * std::int64_t{chunks_.largest};
        for (std::int64_t i = 0; i < 3 * std::int64_t{chunk.owned}; ++i)
            own[i] = b.u[i * sides];
        b.u = own;
    }
    with_row(3, sides, [&](auto wide, auto step) {
        for (const std::int32_t control : chunk.foreign) {
            for (std::int64_t k = 0; k < wide; ++k) {
                b.area[k] = u[(wide * control + k) * step];
                b.area[forces_in_row + k] = T{};
            }
            b.area += row_of_area;
        }
    });
    return b;
}

/// The same as `forces_of_side` by a kernel that works in an area.
template <class T>
void ElasticOperator<T>::forces_in_area(std::size_t c, const T *u, T *f, T *f_foreign, int sides,
                                        bool alone, std::vector<T> &scratch) {
    const Chunk &chunk = chunks_.parts[c];
    const std::int64_t foreign = std::ssize(chunk.foreign);
    Batches<T> b = with_area(c, u, sides, scratch);
    const T *const found = b.area - row_of_area * foreign;
    b.f = f + own_begin(chunk, sides);
    kernel_.apply(b);
    forces_of_area(b.area, chunk.owned, b.f, sides);
    if (alone)
        add_rows(chunk.foreign, found + forces_in_row, row_of_area, f, 3, sides);
    else
        forces_of_area(found, foreign, f_foreign, sides);
}

template <class T> double ElasticOperator<T>::work(const T *u) {
    std::vector<double> sums(chunks_.parts.size());
    team_.run(sums.size(), [&](std::size_t c, std::size_t thread) {
        const Chunk &chunk = chunks_.parts[c];
        auto &scratch = scratch_[thread];
        if (works_in_area()) {
            sums[c] = kernel_.work(with_area(c, u, 1, scratch));
            return;
        }
        make_least(scratch, size_of(3 * std::int64_t{chunks_.largest}) + padding);
        Batches<T> b = batches(c);
        b.u = scratch.data();
        T *const past = std::copy_n(u + 3 * std::int64_t{chunk.control},
                                    3 * std::int64_t{chunk.owned}, scratch.data());
        b.u_end = copy_rows(chunk.foreign, u, 3, past);
        sums[c] = kernel_.work(b);
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

template class ElasticOperator<double>;
template class ElasticOperator<float>;

} // namespace bezsoma
