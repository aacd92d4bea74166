// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "kernels.hpp"
#include "team.hpp"

namespace bezsoma {

/// The entities of a net in the order of their controls, and the tets around each.
struct Entities {
    std::vector<Entity> all;
    std::vector<std::int64_t> start;  // (entities + 1,) into around
    std::vector<std::int32_t> around; // which tets hold the entity, ascending
    std::vector<std::uint8_t> local;  // and which of their entities it is
};

/// first (tets, entities): as in chunks.hpp; corners (tets, 4): the controls of the degree-1 net,
/// in the order of each tet's ascending vertices.
Entities entities(int degree, const std::int32_t *first, const std::int32_t *corners,
                  std::int64_t tets, Team &team);

} // namespace bezsoma
