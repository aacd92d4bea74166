// SPDX-License-Identifier: BSD-3-Clause
// Element matrices of linear elasticity in closed form.
//
// K_ab = sum_ij w_ab,ij G_ij, where
//   w_ab,ij = n^2 (1/V) int B_{a-e_i} B_{b-e_j}                 one number for all tets
//   G_ij    = V (lambda g_i g_j^T + mu g_j g_i^T + mu g_i.g_j I)   sixteen 3x3 blocks a tet
// and g_i = grad L_i. Only the i with a_i > 0 and the j with b_j > 0 count: one to sixteen terms.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bezsoma {

using Block = std::array<double, 9>; // row by row

/// What one tet brings: its sixteen 3x3 blocks G_ij at index 4 i + j.
using Couplings = std::array<Block, 16>;

/// One term of a block of the element matrix.
struct Term {
    double weight;
    std::uint32_t pair; // 4 i + j
};

/// The terms of all blocks (a, b) with a <= b; the others are their transposes, bit for bit.
struct Stiffness {
    std::size_t controls;             // m, of a tet
    std::vector<std::uint32_t> start; // (m (m+1) / 2 + 1,)
    std::vector<Term> terms;
};

Stiffness stiffness(int degree);

/// gradients (4, 3); volume, lambda and mu of one tet.
Couplings couplings(const double *gradients, double volume, double lambda, double mu);

/// The 3x3 block of controls a and b.
Block block(const Stiffness &k, const Couplings &g, std::size_t a, std::size_t b);

/// Element matrices of `tets` tets: gradients (t, 4, 3), volumes, lambda, mu (t,),
/// out (t, 3m, 3m).
void element_matrices(const Stiffness &k, std::size_t tets, const double *gradients,
                      const double *volumes, const double *lambda, const double *mu, double *out);

} // namespace bezsoma
