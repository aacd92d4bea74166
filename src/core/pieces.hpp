// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "team.hpp"

namespace bezsoma {

/// Numbers that a thread takes at a time; sums add piece by piece.
constexpr std::size_t numbers_of_piece = 16384;

/// Runs work(i) for all i below length.
template <class Work> void each_number(Team &team, std::size_t length, const Work &work) {
    team.run((length + numbers_of_piece - 1) / numbers_of_piece, [&](std::size_t p, std::size_t) {
        const std::size_t end = std::min((p + 1) * numbers_of_piece, length);
        for (std::size_t i = p * numbers_of_piece; i < end; ++i)
            work(i);
    });
}

/// Sums over vectors of one length, in pieces that do not depend on the number of threads.
class Pieces {
public:
    Pieces(std::size_t length, Team &team)
        : length_(length), team_(team), sums_((length + numbers_of_piece - 1) / numbers_of_piece) {}

    /// The sum over all i of term(i), which may also write at i.
    template <class Term> double sum(const Term &term) {
        team_.run(sums_.size(), [&](std::size_t p, std::size_t) {
            // Eight partial sums let the processor overlap additions.
            double part[8] = {};
            const std::size_t end = std::min((p + 1) * numbers_of_piece, length_);
            std::size_t i = p * numbers_of_piece;
            for (; i + 8 <= end; i += 8)
                for (std::size_t l = 0; l < 8; ++l)
                    part[l] += term(i + l);
            for (; i < end; ++i)
                part[0] += term(i);
            sums_[p] = std::accumulate(part, part + 8, 0.0);
        });
        return std::accumulate(sums_.begin(), sums_.end(), 0.0);
    }

private:
    std::size_t length_;
    Team &team_;
    std::vector<double> sums_;
};

} // namespace bezsoma
