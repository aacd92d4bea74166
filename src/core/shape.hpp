// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "team.hpp"

namespace bezsoma {

/// The orientation (tets,), +1 or -1, of each tet whose determinant is beyond doubt and whose
/// height is more than `flat` of its longest edge; 0 for the few that exact arithmetic has to
/// decide on. Lengths below 1 / largest are in doubt too.
std::vector<std::int8_t> orientations(const double *points, const std::int64_t *corners,
                                      std::int64_t tets, double flat, double largest, Team &team);

} // namespace bezsoma
