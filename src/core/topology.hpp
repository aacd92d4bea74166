// SPDX-License-Identifier: BSD-3-Clause
// Who touches whom in a mesh of tets (t, 4) with ascending vertices: what reading a mesh and
// numbering its controls ask for, in passes that stop when the team's watch says so.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "team.hpp"

namespace bezsoma {

/// Tets in rows of four vertex numbers.
struct TetRows {
    std::int64_t tets;
    const std::int64_t *corners;
    std::int64_t vertices;
};

/// The distinct edges (width 2) or faces (width 3) of tets, and which of them each tet has.
struct Simplices {
    int width;
    std::vector<std::int32_t> rows;   // (simplices, width), ascending and in lexicographic order
    std::vector<std::int32_t> of_tet; // (tets, 6 or 4), numbers into rows
};

/// Edges in the order 01, 02, 03, 12, 13, 23; face i lies opposite vertex i.
Simplices simplices(const TetRows &mesh, int width, Team &team);

/// The two tets at each face (faces, 2), the lower number first, -1 where none is.
///
/// sign (tets,) is each tet's orientation. Sound: no face has three tets, and no two tets lie on
/// the same side of theirs, as they would in a folded mesh or where a tet is listed twice.
struct Neighbours {
    std::vector<std::int32_t> pairs;
    bool sound;
};
Neighbours neighbours(const std::int32_t *faces_of_tet, std::int64_t tets, std::int64_t faces,
                      const std::int8_t *sign, Team &team);

/// The part of each tet: parts hang together by faces and are numbered as their first tets are.
std::vector<std::int32_t> components(const std::int32_t *pairs, std::int64_t faces,
                                     std::int64_t tets, Team &team);

/// The number of each row (rows, width) in a list in lexicographic order, -1 where it is not there.
std::vector<std::int64_t> numbers_among(const std::int64_t *rows, std::int64_t count,
                                        const std::int32_t *among, std::int64_t there, int width);

/// Sorts every row (rows, width) in place; the first row that has a number twice, or -1.
std::int64_t sort_rows(std::int64_t *rows, std::int64_t count, int width, Team &team);

/// Entities of each tet, by kind: vertices, edges, faces, interior; null where a kind has none.
struct EntitiesOfTets {
    const std::int64_t *corners;
    const std::int32_t *edges, *faces;
};

/// The first control of each vertex, edge, face and tet, one after the other, as a walk over the
/// tets in that order meets them; an entity holds `inside` controls of its kind, and kinds without
/// any are left out.
std::vector<std::int64_t> first_controls(const EntitiesOfTets &of, const std::int64_t *order,
                                         std::int64_t tets,
                                         const std::array<std::int64_t, 4> &count,
                                         const std::array<std::int64_t, 4> &inside, Team &team);

} // namespace bezsoma
