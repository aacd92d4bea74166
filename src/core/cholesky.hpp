// SPDX-License-Identifier: BSD-3-Clause
// Incomplete Cholesky factorisation without fill, IC(0), of a symmetric matrix of 3x3 blocks.
//
// L keeps the lower blocks of A and no others. Controls may have components that are held: their
// rows and columns count as those of the identity, so that the factor acts on the free part alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "block_csr.hpp"

namespace bezsoma {

/// L of A + shift diag(A) ~ L L^T: blocks below the diagonal and inverses of those on it.
struct Factor {
    std::vector<std::int64_t> start;  // (c + 1,)
    std::vector<std::int32_t> column; // (lower,) ascending in each row, all < row
    std::vector<double> below;        // (lower, 3, 3)
    std::vector<double> inverse;      // (c, 3, 3), lower triangular
    std::int64_t broken = -1;         // the first control with a pivot that is not positive, or -1
};

/// held (c, 3): which components are prescribed. A pivot counts as positive when it is above
/// `least` times its entry of diag(A).
Factor incomplete_cholesky(const Rows &where, const double *blocks, const bool *held, double shift,
                           double least);

/// A factor, seen from elsewhere.
struct FactorRows {
    Rows where;
    const double *below;
    const double *inverse;
};

/// z = (L L^T)^-1 r, both (c, 3); may be the same array.
void solve_cholesky(const FactorRows &factor, const double *r, double *z);

} // namespace bezsoma
