// SPDX-License-Identifier: BSD-3-Clause
// Gauss-Seidel by blocks that threads share without a trace: pieces of rows are coloured so that
// no two of a colour touch, colours follow each other, and rows within a piece go one by one.
#pragma once

#include <cstdint>
#include <vector>

#include "block_rows.hpp"

namespace bezsoma {

/// A symmetric positive definite matrix in the order in which sweeps need it.
class Sweeps {
public:
    /// Puts the blocks of each row into the order: swept earlier, the diagonal, swept later.
    Sweeps(BlockRows matrix, const RowKernels &kernels, Team &team);

    const BlockRows &matrix() const { return a_; }

    /// The inverses of the diagonal blocks, column by column.
    std::vector<float> inverse_diagonal(Team &team) const;

    /// From now on the diagonal blocks hold their inverses, which is all that sweeps read.
    void keep_inverse(const std::vector<float> &inverse, Team &team);

    /// (D + L) z = r, and the residual r - A z = -U z, for what one pass over A costs.
    void forward(const float *r, float *z, float *residual, Team &team) const;

    /// One sweep on A z = r in the opposite order: the adjoint of `forward`.
    void backward(const float *r, float *z, Team &team) const;

    std::size_t bytes() const;

private:
    template <class Work>
    void each_piece_of_a_colour(bool reversed, Team &team, const Work &work) const;
    struct Row {
        std::vector<std::int32_t> column;
        std::vector<float> value;
    };
    void colour(Team &team);
    void arrange(std::size_t row, const std::vector<std::int32_t> &rank, Row &copy);

    BlockRows a_;
    const RowKernel &kernel_;
    std::vector<std::int64_t> diagonal_;     // where each row's diagonal block stands
    std::vector<std::int32_t> piece_;        // by colour
    std::vector<std::int32_t> colour_start_; // (colours + 1,) among the pieces
    std::int64_t rows_a_piece_ = 0;
};

} // namespace bezsoma
