// SPDX-License-Identifier: BSD-3-Clause
#include "aggregates.hpp"

namespace bezsoma {

namespace {

float square(const float *block, std::size_t numbers) {
    return std::inner_product(block, block + numbers, block, 0.0F);
}

/// The fourth power of s_ij for every coupling; zero where weak, and on the diagonal.
std::vector<float> strengths(const BlockRows &a, double threshold, Team &team) {
    const std::size_t numbers = size_of(a.high * a.high);
    std::vector<float> own(size_of(a.rows())), most(own.size()), strength(a.column.size());
    each_row(team, a.rows(), [&](std::size_t i, std::size_t) {
        own[i] = 1 / square(a.value.data() + diagonal_at(a, i) * numbers, numbers);
    });
    each_row(team, a.rows(), [&](std::size_t i, std::size_t) {
        for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at) {
            const auto j = size_of(a.column[at]);
            const float s = square(a.value.data() + at * numbers, numbers);
            strength[at] = j == i ? 0 : (s * own[i]) * (s * own[j]);
            most[i] = std::max(most[i], strength[at]);
        }
    });
    const auto least = static_cast<float>(threshold * threshold * threshold * threshold);
    each_row(team, a.rows(), [&](std::size_t i, std::size_t) {
        for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at)
            if (strength[at] < least * std::min(most[i], most[size_of(a.column[at])]))
                strength[at] = 0;
    });
    return strength;
}

/// The passes of the method; what they find stands in `found`.
struct Grouping {
    const BlockRows &a;
    const std::vector<float> &strength;
    Team &team;
    Aggregates found;

    template <class Visit> void each_strong(std::size_t i, const Visit &visit) const {
        for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at)
            if (strength[at] > 0)
                visit(size_of(a.column[at]), strength[at]);
    }

    bool coupled(std::size_t i) const {
        return std::any_of(strength.begin() + a.start[i], strength.begin() + a.start[i + 1],
                           [](float s) { return s > 0; });
    }

    /// Row i and its neighbours without a group become one.
    void gather(std::size_t i) {
        found.of[i] = found.count;
        each_strong(i, [&](std::size_t j, float) {
            if (found.of[j] < 0)
                found.of[j] = found.count;
        });
        ++found.count;
    }

    /// Neighbourhoods that touch no other.
    void whole_neighbourhoods() {
        in_turn(team, found.of.size(), [&](std::size_t i) {
            bool free = found.of[i] < 0 && coupled(i);
            each_strong(i, [&](std::size_t j, float) { free = free && found.of[j] < 0; });
            if (free)
                gather(i);
        });
    }

    /// What is left over joins the neighbour that holds it most.
    void leftovers() {
        const std::vector<std::int32_t> first = found.of;
        in_turn(team, first.size(), [&](std::size_t i) {
            float most = 0;
            if (first[i] < 0)
                each_strong(i, [&](std::size_t j, float s) {
                    if (first[j] >= 0 && s > most) {
                        most = s;
                        found.of[i] = first[j];
                    }
                });
        });
    }

    void rest() {
        in_turn(team, found.of.size(), [&](std::size_t i) {
            if (found.of[i] < 0 && coupled(i))
                gather(i);
        });
    }
};

} // namespace

Aggregates aggregates(const BlockRows &a, double threshold, Team &team) {
    const std::vector<float> strength = strengths(a, threshold, team);
    Grouping grouping{a, strength, team, {std::vector<std::int32_t>(size_of(a.rows()), -1), 0}};
    grouping.whole_neighbourhoods();
    grouping.leftovers();
    grouping.rest();
    return std::move(grouping.found);
}

} // namespace bezsoma
