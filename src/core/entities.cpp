// SPDX-License-Identifier: BSD-3-Clause
#include "entities.hpp"

#include <numeric>

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
                  std::int64_t tets, Team &team) {
    const std::size_t per_tet = size_of(entities_of_tet(degree));
    const std::size_t touches = size_of(tets) * per_tet;
    // The walk numbered entities as it met them, so a new one begins where the last one ended.
    std::size_t count = 0, controls = 0;
    in_turn(team, touches, [&](std::size_t i) {
        if (size_of(first[i]) == controls) {
            ++count;
            controls += size_of(controls_inside(degree, static_cast<int>(i % per_tet)));
        }
    });
    Entities found;
    found.all.reserve(count);
    std::vector<std::int32_t> number; // of the entity that begins at a control
    number.reserve(controls);
    in_turn(team, touches, [&](std::size_t i) {
        if (size_of(first[i]) != number.size())
            return;
        const int local = static_cast<int>(i % per_tet);
        number.resize(number.size() + size_of(controls_inside(degree, local)),
                      static_cast<std::int32_t>(found.all.size()));
        found.all.push_back(entity_of_tet(first[i], local, corners + 4 * (i / per_tet)));
    });
    found.start.assign(found.all.size() + 2, 0);
    // Two places ahead, so that filling moves each start to where it belongs.
    in_turn(team, touches,
            [&](std::size_t i) { ++found.start[size_of(number[size_of(first[i])]) + 2]; });
    std::partial_sum(found.start.begin(), found.start.end(), found.start.begin());
    found.around.resize(touches);
    found.local.resize(touches);
    in_turn(team, touches, [&](std::size_t i) {
        const auto to = size_of(found.start[size_of(number[size_of(first[i])]) + 1]++);
        found.around[to] = static_cast<std::int32_t>(i / per_tet);
        found.local[to] = static_cast<std::uint8_t>(i % per_tet);
    });
    found.start.pop_back();
    return found;
}

} // namespace bezsoma
