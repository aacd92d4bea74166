// SPDX-License-Identifier: BSD-3-Clause
#include "topology.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace bezsoma {

namespace {

constexpr int edge_corners[6][3] = {{0, 1, 0}, {0, 2, 0}, {0, 3, 0},
                                    {1, 2, 0}, {1, 3, 0}, {2, 3, 0}};
constexpr int face_corners[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

/// Which simplices of which tets begin at each vertex: per_tet * tet + local.
struct Beginning {
    std::vector<std::int64_t> start; // (vertices + 1,)
    std::vector<std::uint32_t> entry;
};

template <class First>
Beginning beginning(std::int64_t vertices, std::size_t entries, const First &first, Team &team) {
    Beginning found{std::vector<std::int64_t>(size_of(vertices) + 2),
                    std::vector<std::uint32_t>(entries)};
    // Two places ahead, so that filling moves each start to where it belongs.
    in_turn(team, entries, [&](std::size_t e) { ++found.start[size_of(first(e)) + 2]; });
    std::partial_sum(found.start.begin(), found.start.end(), found.start.begin());
    in_turn(team, entries, [&](std::size_t e) {
        found.entry[size_of(found.start[size_of(first(e)) + 1]++)] = static_cast<std::uint32_t>(e);
    });
    found.start.pop_back();
    return found;
}

} // namespace

Simplices simplices(const TetRows &mesh, int width, Team &team) {
    const auto *corners = width == 2 ? edge_corners : face_corners;
    const std::size_t per_tet = width == 2 ? 6 : 4, entries = per_tet * size_of(mesh.tets);
    const auto corner = [&](std::size_t e, int k) {
        return mesh.corners[4 * (e / per_tet) + size_of(corners[e % per_tet][k])];
    };
    Simplices found{width, {}, std::vector<std::int32_t>(entries)};
    std::int32_t next = 0;
    {
        const Beginning at =
            beginning(mesh.vertices, entries, [&](std::size_t e) { return corner(e, 0); }, team);
        std::vector<std::pair<std::uint64_t, std::uint32_t>> here; // the other vertices, the entry
        in_turn(team, size_of(mesh.vertices), [&](std::size_t v) {
            here.clear();
            for (auto i = size_of(at.start[v]); i < size_of(at.start[v + 1]); ++i) {
                const std::uint32_t e = at.entry[i];
                const auto low = width == 3 ? static_cast<std::uint64_t>(corner(e, 2)) : 0;
                here.emplace_back(static_cast<std::uint64_t>(corner(e, 1)) << 32 | low, e);
            }
            std::sort(here.begin(), here.end());
            for (std::size_t i = 0; i < here.size(); ++i) {
                next += i == 0 || here[i].first != here[i - 1].first;
                found.of_tet[here[i].second] = next - 1;
            }
        });
    }
    found.rows.resize(size_of(next) * size_of(width));
    in_turn(team, entries, [&](std::size_t e) {
        for (int k = 0; k < width; ++k)
            found.rows[size_of(found.of_tet[e]) * size_of(width) + size_of(k)] =
                static_cast<std::int32_t>(corner(e, k));
    });
    return found;
}

Neighbours neighbours(const std::int32_t *faces_of_tet, std::int64_t tets, std::int64_t faces,
                      const std::int8_t *sign, Team &team) {
    Neighbours found{std::vector<std::int32_t>(2 * size_of(faces), -1), true};
    std::vector<std::int8_t> side(size_of(faces)); // of the first tet met
    in_turn(team, 4 * size_of(tets), [&](std::size_t i) {
        const auto face = size_of(faces_of_tet[i]);
        const auto tet = static_cast<std::int32_t>(i / 4);
        // Moving vertex i to the front of the others gives the sign (-1)^i.
        const auto here = static_cast<std::int8_t>(i % 2 ? -sign[i / 4] : sign[i / 4]);
        if (found.pairs[2 * face] < 0) {
            found.pairs[2 * face] = tet;
            side[face] = here;
        } else {
            found.sound = found.sound && found.pairs[2 * face + 1] < 0 && side[face] != here;
            found.pairs[2 * face + 1] = tet;
        }
    });
    return found;
}

std::vector<std::int32_t> components(const std::int32_t *pairs, std::int64_t faces,
                                     std::int64_t tets, Team &team) {
    std::vector<std::int32_t> parent(size_of(tets)); // towards the lowest tet of the part
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::int32_t tet) {
        while (parent[size_of(tet)] != tet)
            tet = parent[size_of(tet)] = parent[size_of(parent[size_of(tet)])];
        return tet;
    };
    in_turn(team, size_of(faces), [&](std::size_t f) {
        if (pairs[2 * f + 1] < 0)
            return;
        const std::int32_t a = root(pairs[2 * f]), b = root(pairs[2 * f + 1]);
        parent[size_of(std::max(a, b))] = std::min(a, b);
    });
    std::vector<std::int32_t> label(size_of(tets));
    std::int32_t count = 0;
    in_turn(team, size_of(tets), [&](std::size_t t) {
        const auto least = size_of(root(static_cast<std::int32_t>(t)));
        label[t] = least == t ? count++ : label[least];
    });
    return label;
}

std::vector<std::int64_t> numbers_among(const std::int64_t *rows, std::int64_t count,
                                        const std::int32_t *among, std::int64_t there, int width) {
    std::vector<std::int64_t> found(size_of(count), -1);
    for (std::size_t i = 0; i < size_of(count); ++i) {
        const std::int64_t *wanted = rows + i * size_of(width);
        const auto row = [&](std::int64_t at) { return among + size_of(at) * size_of(width); };
        std::int64_t low = 0, high = there; // the first row that is not less lies within
        while (low < high) {
            const std::int64_t middle = (low + high) / 2;
            if (std::lexicographical_compare(row(middle), row(middle) + width, wanted,
                                             wanted + width))
                low = middle + 1;
            else
                high = middle;
        }
        if (low < there && std::equal(wanted, wanted + width, row(low)))
            found[i] = low;
    }
    return found;
}

std::int64_t sort_rows(std::int64_t *rows, std::int64_t count, int width, Team &team) {
    std::int64_t twice = -1;
    in_turn(team, size_of(count), [&](std::size_t i) {
        std::int64_t *row = rows + i * size_of(width);
        for (int k = 1; k < width; ++k) // by insertion: two to four numbers
            for (int j = k; j > 0 && row[j] < row[j - 1]; --j)
                std::swap(row[j], row[j - 1]);
        if (twice < 0 && std::adjacent_find(row, row + width) != row + width)
            twice = static_cast<std::int64_t>(i);
    });
    return twice;
}

std::vector<std::int64_t> first_controls(const EntitiesOfTets &of, const std::int64_t *order,
                                         std::int64_t tets,
                                         const std::array<std::int64_t, 4> &count,
                                         const std::array<std::int64_t, 4> &inside, Team &team) {
    std::array<std::int64_t, 5> base{};
    for (std::size_t dim = 0; dim < 4; ++dim)
        base[dim + 1] = base[dim] + (inside[dim] > 0 ? count[dim] : 0);
    std::vector<std::int64_t> first(size_of(base[4]), -1);
    std::int64_t next = 0;
    const auto meet = [&](std::size_t dim, std::int64_t entity) {
        std::int64_t &control = first[size_of(base[dim] + entity)];
        if (control < 0) {
            control = next;
            next += inside[dim];
        }
    };
    in_turn(team, size_of(tets), [&](std::size_t i) {
        const auto tet = size_of(order[i]);
        for (std::size_t k = 0; k < 4; ++k)
            meet(0, of.corners[4 * tet + k]);
        for (std::size_t k = 0; k < 6 && inside[1] > 0; ++k)
            meet(1, of.edges[6 * tet + k]);
        for (std::size_t k = 0; k < 4 && inside[2] > 0; ++k)
            meet(2, of.faces[4 * tet + k]);
        if (inside[3] > 0)
            meet(3, order[i]);
    });
    return first;
}

} // namespace bezsoma
