// SPDX-License-Identifier: BSD-3-Clause
#include "entities.hpp"

#include <algorithm>

#include "chunks.hpp"
#include "tet_controls.hpp"

namespace bezsoma {

namespace {

Entity entity_of_tet(std::int32_t control, int local, const std::int32_t *corners) {
    Entity entity{control, -1, {}};
    for (int v = 0; v < 4; ++v)
        if (entity_vertices[local] >> v & 1)
            entity.vertices[++entity.dim] = corners[v];
    return entity;
}

} // namespace

Entities entities(int degree, const std::int32_t *first, const std::int32_t *corners,
                  std::int64_t tets) {
    const std::size_t per_tet = static_cast<std::size_t>(entities_of_tet(degree));
    const std::size_t touches = static_cast<std::size_t>(tets) * per_tet;
    Entities found;
    // The walk numbered entities as it met them, so a new one begins where the last one ended.
    std::int32_t next = 0;
    for (std::size_t i = 0; i < touches; ++i)
        if (first[i] == next) {
            const int local = static_cast<int>(i % per_tet);
            found.all.push_back(entity_of_tet(next, local, corners + 4 * (i / per_tet)));
            next += controls_inside(degree, local);
        }
    const auto number = [&](std::int32_t control) {
        return static_cast<std::size_t>(
            std::ranges::lower_bound(found.all, control, {}, &Entity::control) - found.all.begin());
    };
    std::vector<std::int32_t> of_touch(touches);
    found.start.assign(found.all.size() + 1, 0);
    for (std::size_t i = 0; i < touches; ++i) {
        of_touch[i] = static_cast<std::int32_t>(number(first[i]));
        ++found.start[static_cast<std::size_t>(of_touch[i]) + 1];
    }
    for (std::size_t e = 0; e < found.all.size(); ++e)
        found.start[e + 1] += found.start[e];
    found.around.resize(touches);
    found.local.resize(touches);
    std::vector<std::int64_t> at(found.start.begin(), found.start.end() - 1);
    for (std::size_t i = 0; i < touches; ++i) {
        const auto to = static_cast<std::size_t>(at[static_cast<std::size_t>(of_touch[i])]++);
        found.around[to] = static_cast<std::int32_t>(i / per_tet);
        found.local[to] = static_cast<std::uint8_t>(i % per_tet);
    }
    return found;
}

} // namespace bezsoma
