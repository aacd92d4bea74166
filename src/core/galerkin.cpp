// SPDX-License-Identifier: BSD-3-Clause
#include "galerkin.hpp"

namespace bezsoma {

namespace {

// Rows of eight numbers of A P that stand at a time: 4 MB.
constexpr std::int64_t slab = 1 << 17;

std::int32_t of(std::size_t i) { return static_cast<std::int32_t>(i); }

/// The pattern of A P.
Sparsity pattern_of_product(const BlockRows &a, const BlockRows &p, std::int64_t columns,
                            Team &team) {
    return sparsity(team, a.rows(), columns, [&](std::size_t i, const auto &take) {
        for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at) {
            const auto j = size_of(a.column[at]);
            for (auto to = size_of(p.start[j]); to < size_of(p.start[j + 1]); ++to)
                take(p.column[to]);
        }
    });
}

Sparsity pattern_of_coarse(const Sparsity &ap, const Columns &columns, Team &team) {
    const auto count = static_cast<std::int64_t>(columns.start.size()) - 1;
    return sparsity(team, count, count, [&](std::size_t g, const auto &take) {
        for (auto e = size_of(columns.start[g]); e < size_of(columns.start[g + 1]); ++e) {
            const auto i = size_of(columns.row[e]);
            for (auto at = size_of(ap.start[i]); at < size_of(ap.start[i + 1]); ++at)
                take(ap.column[at]);
        }
    });
}

/// Forms A P for a slab of rows, then adds its part to every coarse row: sums run over rows in
/// ascending order whatever the number of threads.
class Slabs {
public:
    Slabs(const BlockRows &a, const BlockRows &p, const Columns &columns, const Sparsity &ap,
          BlockRows &coarse, const RowKernel &kernel, Team &team)
        : a_(a), p_(p), columns_(columns), ap_(ap), coarse_(coarse), kernel_(kernel), team_(team),
          places_(team.size()), sums_(team.size()),
          next_(columns.start.begin(), columns.start.end() - 1) {}

    void run() {
        for (first_ = 0; first_ < a_.rows(); first_ = last_) {
            last_ = end_of_slab();
            const std::int64_t begin = ap_.start[size_of(first_)];
            rows_.assign(size_of((ap_.start[size_of(last_)] - begin) * a_.high * 8), 0.0F);
            each_row(team_, last_ - first_, [&](std::size_t i, std::size_t thread) {
                product(size_of(first_) + i, places_[thread]);
            });
            each_row(team_, coarse_.rows(), [&](std::size_t g, std::size_t thread) {
                add_to(g, places_[thread], sums_[thread]);
            });
        }
    }

private:
    std::int64_t end_of_slab() const {
        const auto begin = ap_.start.begin() + first_;
        const auto end = std::upper_bound(begin + 1, ap_.start.end(), *begin + slab / a_.high);
        return first_ + std::max<std::int64_t>(end - begin - 1, 1);
    }

    float *row(std::size_t i) {
        return rows_.data() + size_of((ap_.start[i] - ap_.start[size_of(first_)]) * a_.high * 8);
    }

    void product(std::size_t i, std::vector<std::int32_t> &place) {
        place.resize(size_of(coarse_.rows()));
        for (auto at = ap_.start[i]; at < ap_.start[i + 1]; ++at)
            place[size_of(ap_.column[size_of(at)])] = static_cast<std::int32_t>(at - ap_.start[i]);
        kernel_.product(a_.seen(), p_.seen(), i, place.data(), row(i));
    }

    /// The upper half of coarse row g.
    void add_to(std::size_t g, std::vector<std::int32_t> &place, std::vector<float> &sums) {
        auto e = size_of(next_[g]);
        const auto end = size_of(columns_.start[g + 1]);
        if (e == end || columns_.row[e] >= last_)
            return;
        place.resize(size_of(coarse_.rows()));
        const std::int64_t own = coarse_.start[g];
        for (auto at = own; at < coarse_.start[g + 1]; ++at)
            place[size_of(coarse_.column[size_of(at)])] = static_cast<std::int32_t>(at - own);
        sums.assign(size_of(coarse_.start[g + 1] - own) * motions * 8, 0.0F);
        for (; e < end && columns_.row[e] < last_; ++e) {
            const auto i = size_of(columns_.row[e]);
            const std::size_t numbers = size_of(p_.high) * motions;
            kernel_.add_products(p_.value.data() + columns_.at[e] * numbers, row(i),
                                 ap_.column.data() + ap_.start[i],
                                 size_of(ap_.start[i + 1] - ap_.start[i]), of(g), place.data(),
                                 sums.data());
        }
        next_[g] = static_cast<std::int64_t>(e);
        float *to = coarse_.value.data() + size_of(own) * motions * motions;
        for (std::size_t column = 0; column < sums.size(); column += 8)
            for (std::size_t k = 0; k < motions; ++k)
                *to++ += sums[column + k];
    }

    const BlockRows &a_, &p_;
    const Columns &columns_;
    const Sparsity &ap_;
    BlockRows &coarse_;
    const RowKernel &kernel_;
    Team &team_;
    std::vector<std::vector<std::int32_t>> places_; // a thread each
    std::vector<std::vector<float>> sums_;
    std::vector<std::int64_t> next_; // of each coarse row: the first entry not yet added
    std::vector<float> rows_;        // of A P, six numbers in eight
    std::int64_t first_ = 0, last_ = 0;
};

/// The lower half from the upper.
void mirror(BlockRows &a, Team &team) {
    each_row(team, a.rows(), [&](std::size_t i, std::size_t) {
        for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at) {
            if (a.column[at] > of(i))
                break;
            const auto j = size_of(a.column[at]);
            const auto other = std::lower_bound(a.column.begin() + a.start[j],
                                                a.column.begin() + a.start[j + 1], of(i)) -
                               a.column.begin();
            const float *from = a.value.data() + size_of(other) * motions * motions;
            float *to = a.value.data() + at * motions * motions;
            for (int k = 0; k < motions; ++k)
                for (int l = 0; l < (j == i ? k : motions); ++l)
                    to[k * motions + l] = from[l * motions + k];
        }
    });
}

} // namespace

Columns columns_of(const BlockRows &a, std::int64_t columns, Team &team) {
    Columns found{std::vector<std::int64_t>(size_of(columns) + 1),
                  std::vector<std::int32_t>(a.column.size()),
                  std::vector<std::uint32_t>(a.column.size())};
    in_turn(team, a.column.size(),
            [&](std::size_t at) { ++found.start[size_of(a.column[at]) + 1]; });
    std::partial_sum(found.start.begin(), found.start.end(), found.start.begin());
    std::vector<std::int64_t> next(found.start.begin(), found.start.end() - 1);
    in_turn(team, size_of(a.rows()), [&](std::size_t i) {
        for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at) {
            const auto to = size_of(next[size_of(a.column[at])]++);
            found.row[to] = of(i);
            found.at[to] = static_cast<std::uint32_t>(at);
        }
    });
    return found;
}

std::optional<BlockRows> galerkin(const BlockRows &a, const BlockRows &p, const Columns &columns,
                                  std::size_t most, const RowKernels &kernels, Team &team) {
    const auto count = static_cast<std::int64_t>(columns.start.size()) - 1;
    const Sparsity ap = pattern_of_product(a, p, count, team);
    Sparsity found = pattern_of_coarse(ap, columns, team);
    if (found.column.size() > most)
        return std::nullopt;
    BlockRows coarse = with_pattern(std::move(found), motions, motions, team);
    Slabs(a, p, columns, ap, coarse, kernels.of(a.high), team).run();
    mirror(coarse, team);
    return coarse;
}

} // namespace bezsoma
