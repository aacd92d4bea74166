// SPDX-License-Identifier: BSD-3-Clause
// How the tets of a mesh are cut into chunks that one thread works on at a time.
//
// Tets come in the order of the walk that numbered the controls, so the controls that a chunk
// touches first are one range of numbers: it owns them. The others it touches (foreign ones) are
// owned by earlier chunks; forces on them are written beside and added by the owner afterwards, in
// the order of the chunks. Chunks depend on the mesh alone, so the number of threads shows nowhere
// in the answer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "team.hpp"

namespace bezsoma {

/// Numbers that a kernel may read past the end of the controls it works on.
constexpr std::size_t padding = 16;

/// Entities of a tet that hold controls at this degree, and the controls inside each.
int entities_of_tet(int degree);
int controls_inside(int degree, int entity);

/// A control that another chunk added to: what its owner has to sum.
struct Addition {
    std::int32_t control;
    std::int32_t from; // its place among the foreign controls of all chunks
};

struct Chunk {
    std::int64_t tet, tets;            // its tets are [tet, tet + tets) of the walk
    std::int32_t control, owned;       // it owns controls [control, control + owned)
    std::int64_t foreign_begin;        // its foreign controls begin here among those of all chunks
    std::vector<std::int32_t> foreign; // they, ascending
    std::vector<Addition> added; // what other chunks add to its own, in the order of the chunks
};

struct Chunks {
    int degree;
    std::int64_t controls;
    std::int64_t foreign; // foreign controls of all chunks
    std::vector<Chunk> parts;
    std::vector<std::int32_t> local; // (tets, entities): where the run of controls inside each
                                     // begins in its chunk, own controls first, then the foreign
    std::int32_t largest;            // the most controls that a chunk touches
};

/// Cuts the walk into chunks of about `target` controls.
///
/// first (tets, entities): the first control of each entity of each tet, tets in the order of the
/// walk that numbered them.
Chunks chunks(int degree, const std::int32_t *first, std::int64_t tets, std::int64_t target,
              Team &team);

/// The same walk cut where it is told: chunk i holds tets [cuts[i], cuts[i + 1]). So fields of
/// several degrees share their chunks.
Chunks chunks(int degree, const std::int32_t *first, const std::vector<std::int64_t> &cuts,
              Team &team);

/// Where a walk was cut.
std::vector<std::int64_t> cuts(const Chunks &chunks);

} // namespace bezsoma
