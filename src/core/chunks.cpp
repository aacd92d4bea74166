// SPDX-License-Identifier: BSD-3-Clause
#include "chunks.hpp"

#include <algorithm>
#include <iterator>

#include "tet_controls.hpp"

namespace bezsoma {

int entities_of_tet(int degree) {
    constexpr int table[] = {entities(1), entities(2), entities(3), entities(4)};
    return table[std::min(degree, 4) - 1];
}

int controls_inside(int degree, int entity) {
    const int n = degree - 1;
    const int by_dimension[] = {1, n, n * (n - 1) / 2, n * (n - 1) * (n - 2) / 6};
    return by_dimension[entity < 4 ? 0 : entity < 10 ? 1 : entity < 14 ? 2 : 3];
}

namespace {

/// One past the last control that these tets touch.
std::int32_t end_of_touched(const Chunks &all, const std::int32_t *first, const Chunk &chunk) {
    const int per_tet = entities_of_tet(all.degree);
    std::int32_t end = 0;
    for (std::int64_t t = chunk.tet; t < chunk.tet + chunk.tets; ++t)
        for (int e = 0; e < per_tet; ++e)
            end = std::max(end, first[t * per_tet + e] + controls_inside(all.degree, e));
    return end;
}

/// The controls below the chunk's own ones, ascending.
std::vector<std::int32_t> foreign_controls(const Chunks &all, const std::int32_t *first,
                                           const Chunk &chunk) {
    struct Run {
        std::int32_t control, length;
    };
    const int per_tet = entities_of_tet(all.degree);
    std::vector<Run> runs;
    for (std::int64_t t = chunk.tet; t < chunk.tet + chunk.tets; ++t)
        for (int e = 0; e < per_tet; ++e)
            if (first[t * per_tet + e] < chunk.control)
                runs.push_back({first[t * per_tet + e], controls_inside(all.degree, e)});
    std::ranges::sort(runs, {}, &Run::control);
    const auto same = [](const Run &a, const Run &b) { return a.control == b.control; };
    runs.erase(std::unique(runs.begin(), runs.end(), same), runs.end());
    std::vector<std::int32_t> controls;
    for (const Run &run : runs)
        for (std::int32_t i = 0; i < run.length; ++i)
            controls.push_back(run.control + i);
    return controls;
}

/// Writes where each run of the chunk's tets begins among the chunk's controls.
void number_locally(Chunks &all, const std::int32_t *first, const Chunk &chunk) {
    const std::size_t per_tet = static_cast<std::size_t>(entities_of_tet(all.degree));
    const std::size_t from = static_cast<std::size_t>(chunk.tet) * per_tet;
    const std::size_t to = from + static_cast<std::size_t>(chunk.tets) * per_tet;
    for (std::size_t i = from; i < to; ++i) {
        if (first[i] >= chunk.control) {
            all.local[i] = first[i] - chunk.control;
        } else {
            const auto at = std::ranges::lower_bound(chunk.foreign, first[i]);
            all.local[i] = chunk.owned + static_cast<std::int32_t>(at - chunk.foreign.begin());
        }
    }
}

/// Tells every owner what other chunks add to.
void hand_to_owners(Chunks &all, Team &team) {
    for (auto &chunk : all.parts) {
        team.ask();
        auto from = static_cast<std::int32_t>(chunk.foreign_begin);
        auto owner = all.parts.begin();
        for (const std::int32_t control : chunk.foreign) {
            while (control >= owner->control + owner->owned)
                ++owner;
            owner->added.push_back({control, from++});
        }
    }
}

} // namespace

Chunks chunks(int degree, const std::int32_t *first, std::int64_t tets, std::int64_t target,
              Team &team) {
    // A tet adds n^3 / 6 controls on the average in a large mesh. A batch of tets or two at least:
    // fewer would leave lanes empty.
    const std::int64_t cube = std::int64_t{degree} * degree * degree;
    const std::int64_t most = std::max<std::int64_t>(16, 6 * target / cube);
    const std::int64_t number = std::max<std::int64_t>(1, (tets + most / 2) / most);
    std::vector<std::int64_t> at;
    for (std::int64_t i = 0; i <= number; ++i)
        at.push_back(tets * i / number);
    return chunks(degree, first, at, team);
}

Chunks chunks(int degree, const std::int32_t *first, const std::vector<std::int64_t> &cuts,
              Team &team) {
    Chunks all{degree, 0, 0, {}, {}, 0};
    all.local.resize(static_cast<std::size_t>(cuts.back() * entities_of_tet(degree)));
    all.parts.resize(cuts.size() - 1);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        all.parts[i].tet = cuts[i];
        all.parts[i].tets = cuts[i + 1] - cuts[i];
    }
    const auto each = [&](const auto &work) {
        team.run(all.parts.size(), [&](std::size_t i, std::size_t) { work(all.parts[i]); });
    };
    each([&](Chunk &chunk) { chunk.owned = end_of_touched(all, first, chunk); });
    for (Chunk &chunk : all.parts) {
        chunk.control = static_cast<std::int32_t>(all.controls);
        all.controls = std::max<std::int64_t>(all.controls, chunk.owned);
        chunk.owned = static_cast<std::int32_t>(all.controls) - chunk.control;
    }
    each([&](Chunk &chunk) {
        chunk.foreign = foreign_controls(all, first, chunk);
        number_locally(all, first, chunk);
    });
    for (Chunk &chunk : all.parts) {
        chunk.foreign_begin = all.foreign;
        all.foreign += std::ssize(chunk.foreign);
        all.largest =
            std::max(all.largest, chunk.owned + static_cast<std::int32_t>(chunk.foreign.size()));
    }
    hand_to_owners(all, team);
    return all;
}

std::vector<std::int64_t> cuts(const Chunks &chunks) {
    std::vector<std::int64_t> at{0};
    for (const Chunk &chunk : chunks.parts)
        at.push_back(chunk.tet + chunk.tets);
    return at;
}

} // namespace bezsoma
