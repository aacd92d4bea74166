// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "large.hpp"
#include "row_kernels.hpp"
#include "team.hpp"

namespace bezsoma {

/// Small blocks in compressed rows, in float32.
///
/// The blocks of a square matrix stand column by column, those of a prolongation (high, 6) row by
/// row: a product then runs along contiguous numbers. `slack` numbers follow the last block, since
/// blocks are read in whole SIMD registers.
struct BlockRows {
    static constexpr std::size_t slack = 8;
    int high = 0, wide = 0;
    std::vector<std::int64_t> start; // (rows + 1,)
    std::vector<std::int32_t> column;
    std::vector<float> value; // (blocks, high * wide) and the slack

    RowsSeen seen() const { return {start.data(), column.data(), value.data()}; }
    std::int64_t rows() const { return static_cast<std::int64_t>(start.size()) - 1; }
    std::size_t bytes() const { return start.size() * 8 + column.size() * 4 + value.size() * 4; }
};

/// Runs work(begin, end, thread) for all rows, a fixed number of them at a time.
template <class Work> void each_piece(Team &team, std::int64_t rows, const Work &work) {
    constexpr std::size_t piece = 512;
    team.run((size_of(rows) + piece - 1) / piece, [&](std::size_t p, std::size_t thread) {
        work(p * piece, std::min((p + 1) * piece, size_of(rows)), thread);
    });
}

/// Runs work(row, thread) for all rows.
template <class Work> void each_row(Team &team, std::int64_t rows, const Work &work) {
    each_piece(team, rows, [&](std::size_t begin, std::size_t end, std::size_t thread) {
        for (std::size_t i = begin; i < end; ++i)
            work(i, thread);
    });
}

/// Which columns each row of a sparse matrix has, ascending.
struct Sparsity {
    std::vector<std::int64_t> start; // (rows + 1,)
    std::vector<std::int32_t> column;
};

/// The pattern of a matrix whose row i has every column that visit(i, take) hands to take, which
/// may come several times.
template <class Visit>
Sparsity sparsity(Team &team, std::int64_t rows, std::int64_t columns, const Visit &visit) {
    constexpr std::size_t piece = 512;
    const std::size_t pieces = (size_of(rows) + piece - 1) / piece;
    std::vector<std::vector<std::int32_t>> found(pieces), seen_by(team.size()), taken(team.size());
    Sparsity made{std::vector<std::int64_t>(size_of(rows) + 1), {}};
    team.run(pieces, [&](std::size_t p, std::size_t thread) {
        std::vector<std::int32_t> &seen = seen_by[thread], &mine = taken[thread];
        mine.clear();
        if (seen.empty())
            seen.assign(size_of(columns), -1);
        for (std::size_t i = p * piece; i < std::min((p + 1) * piece, size_of(rows)); ++i) {
            const auto row = static_cast<std::int32_t>(i);
            const std::size_t begin = mine.size();
            visit(i, [&](std::int32_t column) {
                if (std::exchange(seen[size_of(column)], row) != row)
                    mine.push_back(column);
            });
            std::sort(mine.begin() + static_cast<std::ptrdiff_t>(begin), mine.end());
            made.start[i + 1] = static_cast<std::int64_t>(mine.size() - begin);
        }
        found[p] = mine; // of exactly this size, where one that grew may have twice as much
    });
    std::partial_sum(made.start.begin(), made.start.end(), made.start.begin());
    make_large(made.column, size_of(made.start.back()), team);
    team.run(pieces, [&](std::size_t p, std::size_t) {
        std::copy(found[p].begin(), found[p].end(), made.column.begin() + made.start[p * piece]);
        std::vector<std::int32_t>().swap(found[p]);
    });
    return made;
}

/// A matrix of zeros.
inline BlockRows with_pattern(Sparsity where, int high, int wide, Team &team) {
    const std::size_t numbers = where.column.size() * size_of(high) * size_of(wide);
    return {high, wide, std::move(where.start), std::move(where.column),
            large<float>(numbers + BlockRows::slack, team)};
}

/// Where the diagonal block of a row stands.
inline std::size_t diagonal_at(const BlockRows &a, std::size_t row) {
    auto at = size_of(a.start[row]);
    while (size_of(a.column[at]) != row)
        ++at;
    return at;
}

} // namespace bezsoma
