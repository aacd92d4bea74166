// SPDX-License-Identifier: BSD-3-Clause
// The preconditioner of a displacement as the bindings build it: beside the operator that is to be
// solved with, or by itself.
#pragma once

#include "bindings.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "aggregation.hpp"
#include "conjugate_gradients.hpp"
#include "preconditioner.hpp"

namespace bezsoma {

using Corners = In<std::int32_t, -1, 4>;

/// Which components of a net's controls are held, and what degree 1 is made from: the places of the
/// vertices and which of their components are held.
struct Supported {
    const In<double, -1, 3> &points;
    const In<bool, -1, 3> &held, &held_vertices;
    std::int64_t controls;
};

/// About the inverse of the stiffness of a displacement with its supports: blocks of entities, and
/// degree 1 by multigrid, which is all there is at degree 1.
struct Inverse {
    std::vector<std::uint8_t> held;
    std::unique_ptr<Preconditioner> blocks;
    std::unique_ptr<Aggregation> aggregation;

    /// corners (tets, 4) are the rows of each tet's vertices. The walk is used up: its numbering
    /// has done its work halfway, and is much of the memory. `chunks` are those of the operator
    /// beside which it stands; null where it stands alone. `turn` is that of the team.
    Inverse(Walk &walk, const std::optional<Corners> &corners, const Supported &supported,
            const Chunks *chunks, const Kernels &kernels, Team &team, std::recursive_mutex &turn);

    Search search(Team &team) {
        return {blocks.get(), [this](const float *r, float *z) { aggregation->apply(r, z); }, team};
    }

    std::size_t bytes() const { return (blocks ? blocks->bytes() : 0) + aggregation->bytes(); }
};

} // namespace bezsoma
