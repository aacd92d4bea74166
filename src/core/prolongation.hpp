// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "aggregates.hpp"
#include "block_rows.hpp"

namespace bezsoma {

/// The rigid motions of vertices about their centre, (vertices, 3, 6), lengths scaled to one; zero
/// where a component is fixed.
std::vector<double> rigid_motions(const double *points, const std::uint8_t *fixed,
                                  std::size_t vertices);

/// A basis of the motions of each aggregate.
struct Tentative {
    std::vector<float> basis;   // (rows, high, 6) orthonormal over an aggregate
    std::vector<double> coarse; // (aggregates, 6, 6) the motions in that basis
};

/// Motions (rows, high, 6) that an aggregate lacks, like the turn of a single vertex, become zero.
Tentative tentative(const std::vector<double> &of_rows, int high, const Aggregates &groups,
                    Team &team);

/// P = (I - omega D^-1 A) T: one damped Jacobi step on the tentative basis.
///
/// Its jumps between aggregates cost too much energy; `inverse` (rows, high, high) is D^-1.
BlockRows smoothed(const BlockRows &a, const std::vector<float> &inverse, double omega,
                   const std::vector<float> &basis, const Aggregates &groups, Team &team);

} // namespace bezsoma
