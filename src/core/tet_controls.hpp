// SPDX-License-Identifier: BSD-3-Clause
// Counting and indexing on a tetrahedron, at compile time; see bernstein/indices.py for the order.
#pragma once

#include <cstdint>

namespace bezsoma {

static constexpr int combinations(int n, int k) {
    if (k < 0 || n < k)
        return 0;
    std::int64_t c = 1;
    for (int i = 1; i <= k; ++i)
        c = c * (n - k + i) / i;
    return static_cast<int>(c);
}

/// Controls of a tet of that degree.
static constexpr int controls(int degree) { return combinations(degree + 3, 3); }

/// Position of alpha = (n - s3, s3 - s2, s2 - s1, s1) in the descending lexicographic order.
static constexpr int position(int s3, int s2, int s1) {
    return combinations(s3 + 2, 3) + combinations(s2 + 1, 2) + s1;
}

/// Entities of a tet that own controls: 4 vertices, 6 edges, 4 faces, 1 interior.
static constexpr int entities(int degree) {
    return degree == 1 ? 4 : degree == 2 ? 10 : degree == 3 ? 14 : 15;
}

/// Controls inside one entity of dimension dim.
static constexpr int inside(int degree, int dim) { return combinations(degree - 1, dim); }

static constexpr int entity_dim(int entity) {
    return entity < 4 ? 0 : entity < 10 ? 1 : entity < 14 ? 2 : 3;
}

/// The vertices of each entity as a bit mask, in the order of TetMesh: edges 01 02 03 12 13 23,
/// faces 123 023 013 012.
constexpr int entity_vertices[15] = {1, 2, 4, 8, 3, 5, 9, 6, 10, 12, 14, 13, 11, 7, 15};

/// Controls of a tet that belong to entities before this one.
static constexpr int first_of_entity(int degree, int entity) {
    int sum = 0;
    for (int e = 0; e < entity; ++e)
        sum += inside(degree, entity_dim(e));
    return sum;
}

/// In the order of entities: which row 3 position + component of the lexicographic order each
/// number of a tet's controls is.
template <int n> struct EntityOrder {
    int row[3 * controls(n)] = {};
    constexpr EntityOrder() {
        int next = 0;
        for (int e = 0; e < entities(n); ++e)
            for (int s3 = 0; s3 <= n; ++s3)
                for (int s2 = 0; s2 <= s3; ++s2)
                    for (int s1 = 0; s1 <= s2; ++s1) {
                        const int support =
                            (n - s3 > 0) | (s3 - s2 > 0) << 1 | (s2 - s1 > 0) << 2 | (s1 > 0) << 3;
                        for (int k = 0; k < 3 && support == entity_vertices[e]; ++k)
                            row[next++] = 3 * position(s3, s2, s1) + k;
                    }
    }
};

} // namespace bezsoma
