// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "block_rows.hpp"

namespace bezsoma {

/// Where the blocks of each column of a matrix stand: a transpose without copied numbers.
struct Columns {
    std::vector<std::int64_t> start; // (columns + 1,)
    std::vector<std::int32_t> row;   // ascending in each column
    std::vector<std::uint32_t> at;   // among the blocks

    ColumnsSeen seen() const { return {start.data(), row.data(), at.data()}; }
};

Columns columns_of(const BlockRows &a, std::int64_t columns, Team &team);

/// P^T A P, exactly symmetric, columns ascending; never all of A P at once. Nothing, and no time
/// spent on numbers, where it would have more than `most` blocks.
std::optional<BlockRows> galerkin(const BlockRows &a, const BlockRows &p, const Columns &columns,
                                  std::size_t most, const RowKernels &kernels, Team &team);

} // namespace bezsoma
