// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "block_rows.hpp"

namespace bezsoma {

/// Groups of rows that hang together.
struct Aggregates {
    std::vector<std::int32_t> of; // (rows,) -1 where nothing couples to a row
    std::int32_t count = 0;
};

/// Neighbourhoods of strong couplings. With s_ij = |A_ij| / sqrt(|A_ii| |A_jj|) a coupling is
/// strong where s_ij >= threshold times the largest s of row i or of row j, so that every row that
/// couples at all does so strongly somewhere, whatever the scale and shape of the tets.
///
/// A row that couples to nothing belongs to none: a smoother solves it exactly.
Aggregates aggregates(const BlockRows &a, double threshold, Team &team);

} // namespace bezsoma
