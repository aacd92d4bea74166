// SPDX-License-Identifier: BSD-3-Clause
#include "chunks.hpp"

#include <algorithm>

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

/// One past the last control that these tets touch, if that is above `least`.
std::int32_t end_of_owned(const Chunks &all, const std::int32_t *first, const Chunk &chunk) {
    const int per_tet = entities_of_tet(all.degree);
    std::int32_t end = chunk.control;
    for (std::int64_t t = chunk.tet; t < chunk.tet + chunk.tets; ++t)
        for (int e = 0; e < per_tet; ++e)
            end = std::max(end, first[t * per_tet + e] + controls_inside(all.degree, e));
    return end;
}

/// The runs that begin below the chunk's own controls, ascending, each once.
std::vector<Run> foreign_runs(const Chunks &all, const std::int32_t *first, const Chunk &chunk) {
    const int per_tet = entities_of_tet(all.degree);
    std::vector<Run> runs;
    for (std::int64_t t = chunk.tet; t < chunk.tet + chunk.tets; ++t)
        for (int e = 0; e < per_tet; ++e)
            if (first[t * per_tet + e] < chunk.control)
                runs.push_back({first[t * per_tet + e], controls_inside(all.degree, e)});
    std::ranges::sort(runs, {}, &Run::control);
    const auto same = [](const Run &a, const Run &b) { return a.control == b.control; };
    runs.erase(std::unique(runs.begin(), runs.end(), same), runs.end());
    return runs;
}

/// Writes where each run of the chunk's tets begins among the chunk's controls.
void number_locally(Chunks &all, const std::int32_t *first, const Chunk &chunk) {
    const std::size_t per_tet = static_cast<std::size_t>(entities_of_tet(all.degree));
    std::vector<std::int32_t> begin(chunk.runs.size());
    std::int32_t next = chunk.owned;
    for (std::size_t r = 0; r < chunk.runs.size(); ++r) {
        begin[r] = next;
        next += chunk.runs[r].length;
    }
    const std::size_t from = static_cast<std::size_t>(chunk.tet) * per_tet;
    const std::size_t to = from + static_cast<std::size_t>(chunk.tets) * per_tet;
    for (std::size_t i = from; i < to; ++i) {
        if (first[i] >= chunk.control) {
            all.local[i] = first[i] - chunk.control;
        } else {
            const auto run = std::ranges::lower_bound(chunk.runs, first[i], {}, &Run::control);
            all.local[i] = begin[static_cast<std::size_t>(run - chunk.runs.begin())];
        }
    }
}

/// Tells every owner which runs other chunks add to.
void hand_to_owners(Chunks &all) {
    for (auto &chunk : all.parts) {
        std::int64_t from = chunk.foreign_begin;
        for (const Run &run : chunk.runs) {
            const auto after =
                std::ranges::upper_bound(all.parts, run.control, {}, &Chunk::control);
            std::prev(after)->added.push_back({run, from});
            from += run.length;
        }
    }
}

} // namespace

Chunks chunks(int degree, const std::int32_t *first, std::int64_t tets, std::int64_t target) {
    // A tet adds n^3 / 6 controls on the average in a large mesh.
    const std::int64_t per_tet = std::max(1, degree * degree * degree / 6);
    const std::int64_t most = std::max<std::int64_t>(64, target / per_tet);
    const std::int64_t number = (tets + most - 1) / most;
    std::vector<std::int64_t> at;
    for (std::int64_t i = 0; i <= number; ++i)
        at.push_back(tets * i / number);
    return chunks(degree, first, at);
}

Chunks chunks(int degree, const std::int32_t *first, const std::vector<std::int64_t> &cuts) {
    Chunks all{degree, 0, 0, {}, {}, 0};
    all.local.resize(static_cast<std::size_t>(cuts.back() * entities_of_tet(degree)));
    std::int32_t control = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        Chunk chunk{cuts[i], cuts[i + 1] - cuts[i], control, 0, all.foreign, 0, {}, {}};
        control = end_of_owned(all, first, chunk);
        chunk.owned = control - chunk.control;
        chunk.runs = foreign_runs(all, first, chunk);
        for (const Run &run : chunk.runs)
            chunk.foreign += run.length;
        all.foreign += chunk.foreign;
        all.largest = std::max(all.largest, chunk.owned + chunk.foreign);
        number_locally(all, first, chunk);
        all.parts.push_back(std::move(chunk));
    }
    all.controls = control;
    hand_to_owners(all);
    return all;
}

std::vector<std::int64_t> cuts(const Chunks &chunks) {
    std::vector<std::int64_t> at{0};
    for (const Chunk &chunk : chunks.parts)
        at.push_back(chunk.tet + chunk.tets);
    return at;
}

} // namespace bezsoma
