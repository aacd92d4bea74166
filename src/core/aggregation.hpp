// SPDX-License-Identifier: BSD-3-Clause
// Smoothed aggregation for elasticity of degree 1: Vanek, Mandel, Brezina, Computing 56 (1996)
// 179-196, doi:10.1007/BF02238511.
//
// Vertices that hang together strongly form an aggregate; the six rigid motions of each aggregate
// span the coarse space (they cost no energy, so no smoother can find them); one damped Jacobi
// step smooths that basis, since its jumps between aggregates cost too much energy. And again on
// the coarse matrix, whose unknowns are the six motions, until a dense factorisation is nothing.
//
// Smoothing is one Gauss-Seidel sweep by blocks before and one in the opposite order after the
// coarse correction: on the finest level a cycle reads the matrix twice.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "block_rows.hpp"
#include "team.hpp"

namespace bezsoma {

/// One V-cycle a call: a fixed, symmetric, positive definite approximation of the inverse.
class Aggregation {
public:
    /// matrix (vertices, vertices) of 3x3 blocks, its diagonal blocks present, with the identity
    /// in the rows and columns of fixed components; points (vertices, 3); fixed (vertices, 3).
    Aggregation(BlockRows matrix, const double *points, const std::uint8_t *fixed,
                const RowKernels &kernels, Team &team);
    ~Aggregation();
    Aggregation(const Aggregation &) = delete;
    Aggregation &operator=(const Aggregation &) = delete;

    /// z = about A^-1 r, both (vertices, 3).
    void apply(const float *r, float *z);

    std::size_t bytes() const;
    /// Block rows of each level, the finest first.
    std::vector<std::int64_t> sizes() const;

private:
    struct Level;
    using Motions = std::function<std::vector<double>()>; // of the rows of a level
    bool coarsen(Level &level, BlockRows &matrix, Motions &of_rows);
    bool coarsened(Level &level, const std::vector<float> &inverse, double threshold,
                   std::size_t most, BlockRows &matrix, Motions &of_rows);
    void cycle(std::size_t level, const float *r, float *z);
    void restrict_to_coarse(Level &level, const float *residual);
    void add_prolonged(const Level &level, float *z);
    void solve_coarsest(const float *r, float *z);

    std::vector<std::unique_ptr<Level>> levels_;
    std::vector<double> factor_; // the Cholesky factor of the coarsest matrix, dense
    const RowKernels &kernels_;
    Team &team_;
};

} // namespace bezsoma
