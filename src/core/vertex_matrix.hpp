// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "aggregation.hpp"
#include "elastic_operator.hpp"

namespace bezsoma {

/// The stiffness of degree 1 on the vertices of the tets, in float32, columns ascending.
///
/// corners (tets, 4) are the rows of each tet's vertices; the rows and columns of fixed components
/// (vertices, 3) keep their diagonal only, so their scale stays that of their neighbours.
BlockRows vertex_matrix(const ElasticTets &tets, const std::int32_t *corners, std::int64_t vertices,
                        const std::uint8_t *fixed, Team &team);

} // namespace bezsoma
