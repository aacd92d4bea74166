// SPDX-License-Identifier: BSD-3-Clause
// What the multigrid of vertices does row by row on small blocks in float32 (block_rows.hpp), as
// function pointers of one instruction set: see kernels.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

namespace bezsoma {

constexpr int motions = 6; // rigid motions of an aggregate: the unknowns of every coarse level

/// BlockRows and Columns, seen.
struct RowsSeen {
    const std::int64_t *start;
    const std::int32_t *column;
    const float *value;
};
struct ColumnsSeen {
    const std::int64_t *start;
    const std::int32_t *row;
    const std::uint32_t *at;
};

/// On square blocks (n, n) of one size, those of `a`, and blocks (n, 6) of a prolongation p. Rows
/// begin to end, one after the other. Blocks, `inverse` and `e` of `prolong` are read in whole
/// registers: BlockRows::slack numbers have to follow them.
struct RowKernel {
    /// (D + L) z = r. The blocks at `diagonal`, one a row, hold D^-1; what was swept before stands
    /// before them.
    void (*forward)(const RowsSeen &a, const std::int64_t *diagonal, std::size_t begin,
                    std::size_t end, const float *r, float *z);
    /// residual = -U z.
    void (*later)(const RowsSeen &a, const std::int64_t *diagonal, std::size_t begin,
                  std::size_t end, const float *z, float *residual);
    /// z = D^-1 (r - (L + U) z), from the last row to the first.
    void (*backward)(const RowsSeen &a, const std::int64_t *diagonal, std::size_t begin,
                     std::size_t end, const float *r, float *z);
    /// y = D^-1 A x, for D^-1 (rows, n, n).
    void (*scaled)(const RowsSeen &a, const float *inverse, std::size_t begin, std::size_t end,
                   const float *x, float *y);
    /// z += P e.
    void (*prolong)(const RowsSeen &p, std::size_t begin, std::size_t end, const float *e,
                    float *z);
    /// e = P^T r, for columns begin to end of P.
    void (*restricted)(const RowsSeen &p, const ColumnsSeen &columns, std::size_t begin,
                       std::size_t end, const float *r, float *e);
    /// Adds row i of A P to `row` (its blocks, n, 8): block j of P's column c goes to place[c].
    void (*product)(const RowsSeen &a, const RowsSeen &p, std::size_t i, const std::int32_t *place,
                    float *row);
    /// Adds p^T b to sums (blocks, 6, 8), for one block p of P and each block b of a row (blocks,
    /// n, 8) of A P whose column is not below `least`: column by column of six in eight.
    void (*add_products)(const float *p, const float *row, const std::int32_t *column,
                         std::size_t blocks, std::int32_t least, const std::int32_t *place,
                         float *sums);
};

/// Blocks of vertices and of aggregates.
struct RowKernels {
    RowKernel of3, of6;

    const RowKernel &of(int high) const { return high == 3 ? of3 : of6; }
};

} // namespace bezsoma
