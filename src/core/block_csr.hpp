// SPDX-License-Identifier: BSD-3-Clause
// Sparse matrices of 3x3 blocks, one block row a control, columns ascending.
//
// starts are int64 since a matrix may hold more than 2^31 blocks; columns are int32, which the
// number of controls must fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "elasticity.hpp"
#include "team.hpp"

namespace bezsoma {

/// Which entries of of_tet (t, m) name a control: tet * m + local, ascending in each control.
struct Incidence {
    std::vector<std::int64_t> start; // (c + 1,)
    std::vector<std::int64_t> entry; // (t m,)
};

Incidence incidence(const std::int64_t *of_tet, std::size_t tets, std::size_t per_tet,
                    std::size_t controls, Team &team);

/// Which controls meet in a tet.
struct Pattern {
    std::vector<std::int64_t> start;  // (c + 1,)
    std::vector<std::int32_t> column; // (blocks,)
};

Pattern pattern(const std::int64_t *of_tet, std::size_t tets, std::size_t per_tet,
                std::size_t controls, Team &team);

/// Where blocks stand, seen from elsewhere: start (rows + 1,), column (blocks,).
struct Rows {
    std::size_t rows;
    const std::int64_t *start;
    const std::int32_t *column;
};

/// A mesh of tets, seen: of_tet (t, m), gradients (t, 4, 3), volumes, lambda, mu (t,).
struct Elements {
    std::size_t tets;
    const std::int64_t *of_tet;
    const double *gradients;
    const double *volumes;
    const double *lambda;
    const double *mu;
};

// What a thread takes at a time: more threads than that many rows fill are of no use.
constexpr std::size_t rows_assembled = 64, rows_multiplied = 1024;

/// Fills out (blocks, 3, 3); each block is summed over its
/// tets in ascending order, by one thread.
void assemble(const Stiffness &k, const Elements &elements, const Rows &where, Team &team,
              double *out);

/// y = A x, both (c, 3), for blocks (blocks, 3, 3).
void multiply(const Rows &where, const double *blocks, const double *x, Team &team, double *y);

} // namespace bezsoma
