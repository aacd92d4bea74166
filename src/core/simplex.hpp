// SPDX-License-Identifier: BSD-3-Clause
// Multi-indices of the tetrahedron and the mass matrix of one degree.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace bezsoma {

using MultiIndex = std::array<int, 4>;

/// C(n, k) as a double; exact while it fits 53 bits, which all degrees used here do.
double binomial(int n, int k);

/// The number of multi-indices of a degree, C(n+3, 3).
std::size_t count(int degree);

/// All multi-indices of a degree, in descending lexicographic order.
std::vector<MultiIndex> multi_indices(int degree);

/// Where a multi-index stands among those of its degree.
std::size_t position(const MultiIndex &alpha);

/// (1/V) int B_a B_b, shape (m, m) with m = count(degree).
std::vector<double> mass(int degree);

} // namespace bezsoma
