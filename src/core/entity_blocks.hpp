// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "elastic_operator.hpp"
#include "entities.hpp"

namespace bezsoma {

/// The inverse of the diagonal block of K that belongs to one entity; for a vertex, of the block of
/// its function that reaches along the edges (vertex_reach.hpp).
class EntityBlocks {
public:
    EntityBlocks(const ElasticTets &tets, const Entities &entities);

    /// The lower triangle, row after row; rows are 3 * control + component. The rows of what is
    /// prescribed (fixed, (controls, 3)) are zero. `scratch` is reused from call to call.
    void inverse(std::size_t entity, const std::uint8_t *fixed, std::vector<double> &scratch,
                 float *packed) const;

    /// Rows of the block of an entity of that dimension.
    std::size_t rows(int dim) const { return rows_[static_cast<std::size_t>(dim)]; }

private:
    const ElasticTets &tets_;
    const Entities &entities_;
    void sum_around_vertex(std::size_t entity, double *q) const;

    std::array<std::vector<double>, 4> couplings_;
    std::array<double, 16> of_vertex_; // couplings of a vertex' function, by vertices of the tet
    std::array<std::size_t, 4> rows_;
};

} // namespace bezsoma
