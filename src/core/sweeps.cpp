// SPDX-License-Identifier: BSD-3-Clause
#include "sweeps.hpp"

#include <array>

namespace bezsoma {

namespace {

/// Inverts a symmetric positive definite matrix (n, n) in place.
template <int n> void invert(std::array<double, 36> &a) {
    for (int k = 0; k < n; ++k) { // Gauss-Jordan; no pivots are needed when definite
        const double pivot = 1 / a[size_of(k * n + k)];
        for (int i = 0; i < n; ++i)
            if (i != k) {
                const double factor = a[size_of(i * n + k)] * pivot;
                for (int j = 0; j < n; ++j)
                    if (j != k)
                        a[size_of(i * n + j)] -= factor * a[size_of(k * n + j)];
                a[size_of(i * n + k)] = -factor;
            }
        for (int j = 0; j < n; ++j)
            if (j != k)
                a[size_of(k * n + j)] *= pivot;
        a[size_of(k * n + k)] = pivot;
    }
}

template <int n> void inverse_of_block(const float *block, float *inverse) {
    std::array<double, 36> a;
    std::copy_n(block, n * n, a.begin());
    invert<n>(a);
    for (int k = 0; k < n; ++k) // symmetric to the last bit
        for (int l = 0; l < n; ++l)
            inverse[k * n + l] = static_cast<float>(a[size_of(k < l ? k * n + l : l * n + k)]);
}

} // namespace

Sweeps::Sweeps(BlockRows matrix, const RowKernels &kernels, Team &team)
    : a_(std::move(matrix)), kernel_(kernels.of(a_.high)), diagonal_(size_of(a_.rows())),
      rows_a_piece_(a_.high == 3 ? 512 : 64) {
    colour(team);
    std::vector<std::int32_t> rank(piece_.size());
    for (std::size_t c = 0; c + 1 < colour_start_.size(); ++c)
        for (auto p = size_of(colour_start_[c]); p < size_of(colour_start_[c + 1]); ++p)
            rank[size_of(piece_[p])] = static_cast<std::int32_t>(c);
    std::vector<Row> scratch(team.size());
    each_row(team, a_.rows(),
             [&](std::size_t i, std::size_t thread) { arrange(i, rank, scratch[thread]); });
}

/// Blocks swept earlier than row i first, then its own, then the later ones.
void Sweeps::arrange(std::size_t i, const std::vector<std::int32_t> &rank, Row &copy) {
    const auto begin = a_.start[i], end = a_.start[i + 1];
    const std::int64_t numbers = a_.high * a_.high;
    copy.column.assign(a_.column.begin() + begin, a_.column.begin() + end);
    copy.value.assign(a_.value.begin() + begin * numbers, a_.value.begin() + end * numbers);
    const auto order = [&](std::size_t row) {
        return std::pair(rank[row / size_of(rows_a_piece_)], row);
    };
    std::int64_t to = begin;
    for (const int which : {-1, 0, 1})
        for (std::size_t from = 0; from < copy.column.size(); ++from) {
            const auto j = size_of(copy.column[from]);
            if ((j == i ? 0 : order(j) < order(i) ? -1 : 1) != which)
                continue;
            if (which == 0)
                diagonal_[i] = to;
            a_.column[size_of(to)] = copy.column[from];
            std::copy_n(copy.value.begin() + static_cast<std::int64_t>(from) * numbers, numbers,
                        a_.value.begin() + to * numbers);
            ++to;
        }
}

/// Greedy: each piece takes the first colour that no neighbour has.
void Sweeps::colour(Team &team) {
    const auto pieces = size_of((a_.rows() + rows_a_piece_ - 1) / rows_a_piece_);
    std::vector<std::int32_t> of(pieces, -1);
    std::vector<std::size_t> taken; // by colour: the last piece that met it at a neighbour
    for (std::size_t p = 0; p < pieces; ++p) {
        team.ask();
        const std::size_t end = std::min((p + 1) * size_of(rows_a_piece_), size_of(a_.rows()));
        for (auto at = size_of(a_.start[p * size_of(rows_a_piece_)]); at < size_of(a_.start[end]);
             ++at)
            if (const auto c = of[size_of(a_.column[at] / rows_a_piece_)]; c >= 0)
                taken[size_of(c)] = p + 1;
        std::size_t c = 0;
        while (c < taken.size() && taken[c] == p + 1)
            ++c;
        if (c == taken.size())
            taken.push_back(0);
        of[p] = static_cast<std::int32_t>(c);
    }
    colour_start_.assign(taken.size() + 1, 0);
    for (const std::int32_t c : of)
        ++colour_start_[size_of(c) + 1];
    std::partial_sum(colour_start_.begin(), colour_start_.end(), colour_start_.begin());
    piece_.resize(pieces);
    std::vector<std::int32_t> next(colour_start_.begin(), colour_start_.end() - 1);
    for (std::size_t p = 0; p < pieces; ++p)
        piece_[size_of(next[size_of(of[p])]++)] = static_cast<std::int32_t>(p);
}

template <class Work>
void Sweeps::each_piece_of_a_colour(bool reversed, Team &team, const Work &work) const {
    const std::size_t colours = colour_start_.size() - 1;
    for (std::size_t k = 0; k < colours; ++k) {
        const std::size_t c = reversed ? colours - 1 - k : k;
        const auto begin = size_of(colour_start_[c]);
        team.run(size_of(colour_start_[c + 1]) - begin, [&](std::size_t p, std::size_t) {
            const auto first = size_of(piece_[begin + p] * rows_a_piece_);
            work(first, std::min(first + size_of(rows_a_piece_), size_of(a_.rows())));
        });
    }
}

std::vector<float> Sweeps::inverse_diagonal(Team &team) const {
    const std::size_t numbers = size_of(a_.high * a_.high);
    std::vector<float> inverse(diagonal_.size() * numbers + BlockRows::slack);
    each_row(team, a_.rows(), [&](std::size_t i, std::size_t) {
        const float *block = a_.value.data() + size_of(diagonal_[i]) * numbers;
        (a_.high == 3 ? inverse_of_block<3> : inverse_of_block<6>)(block,
                                                                   inverse.data() + i * numbers);
    });
    return inverse;
}

void Sweeps::keep_inverse(const std::vector<float> &inverse, Team &team) {
    const std::size_t numbers = size_of(a_.high * a_.high);
    each_row(team, a_.rows(), [&](std::size_t i, std::size_t) {
        std::copy_n(inverse.data() + i * numbers, numbers,
                    a_.value.data() + size_of(diagonal_[i]) * numbers);
    });
}

void Sweeps::forward(const float *r, float *z, float *residual, Team &team) const {
    const RowsSeen a = a_.seen();
    each_piece_of_a_colour(false, team, [&](std::size_t begin, std::size_t end) {
        kernel_.forward(a, diagonal_.data(), begin, end, r, z);
    });
    each_piece(team, a_.rows(), [&](std::size_t begin, std::size_t end, std::size_t) {
        kernel_.later(a, diagonal_.data(), begin, end, z, residual);
    });
}

void Sweeps::backward(const float *r, float *z, Team &team) const {
    each_piece_of_a_colour(true, team, [&](std::size_t begin, std::size_t end) {
        kernel_.backward(a_.seen(), diagonal_.data(), begin, end, r, z);
    });
}

std::size_t Sweeps::bytes() const {
    return a_.bytes() + 8 * diagonal_.size() + 4 * (piece_.size() + colour_start_.size());
}

} // namespace bezsoma
