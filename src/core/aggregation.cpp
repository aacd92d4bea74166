// SPDX-License-Identifier: BSD-3-Clause
#include "aggregation.hpp"

#include <cmath>
#include <optional>

#include "aggregates.hpp"
#include "galerkin.hpp"
#include "prolongation.hpp"
#include "spare.hpp"
#include "sweeps.hpp"

namespace bezsoma {

namespace {

constexpr std::int64_t small = 80; // block rows at which a dense factorisation ends the descent
// Couplings below this part of a row's strongest are weak. Coarse rows have some forty couplings,
// far ones among them: without them aggregates there grow too large for one smoothing step.
constexpr double weak_between_vertices = 0.1, weak_between_aggregates = 0.5;
constexpr int power_steps = 5;
constexpr double margin = 1.1; // what those steps may lack of the largest eigenvalue

/// The largest eigenvalue of D^-1 A by the power method, from below by some ten per cent.
double largest_eigenvalue(const BlockRows &a, const std::vector<float> &inverse,
                          const RowKernel &kernel, Team &team) {
    std::vector<float> x(size_of(a.rows() * a.high)), y(x.size());
    std::uint32_t seed = 1;
    for (float &v : x) { // a fixed rough vector
        seed = seed * 1664525U + 1013904223U;
        v = static_cast<float>(seed >> 8) / 16777216.0F - 0.5F;
    }
    double before = std::inner_product(x.begin(), x.end(), x.begin(), 0.0), value = 1;
    for (int step = 0; step < power_steps; ++step) {
        each_piece(team, a.rows(), [&](std::size_t begin, std::size_t end, std::size_t) {
            kernel.scaled(a.seen(), inverse.data(), begin, end, x.data(), y.data());
        });
        const double after = std::inner_product(y.begin(), y.end(), y.begin(), 0.0);
        value = std::sqrt(after / before);
        before = after;
        x.swap(y);
    }
    return value;
}

/// Makes a coarse matrix definite in spite of rounding: motions that no vertex of an aggregate can
/// make get a diagonal of one, the others a little more than they have.
void make_definite(BlockRows &a) {
    for (std::size_t i = 0; i < size_of(a.rows()); ++i) {
        float *block = a.value.data() + diagonal_at(a, i) * motions * motions;
        for (std::size_t k = 0; k < motions; ++k) {
            float &d = block[k * (motions + 1)];
            d = d == 0 ? 1 : d * (1 + 1e-6F);
        }
    }
}

/// Eight partial sums let the processor overlap additions.
double dot(const double *x, const double *y, std::size_t n) {
    double part[8] = {};
    std::size_t i = 0;
    for (; i + 8 <= n; i += 8)
        for (std::size_t l = 0; l < 8; ++l)
            part[l] += x[i + l] * y[i + l];
    for (; i < n; ++i)
        part[0] += x[i] * y[i];
    return std::accumulate(part, part + 8, 0.0);
}

/// The lower Cholesky factor, row by row.
std::vector<double> dense_factor(const BlockRows &a) {
    const std::size_t b = size_of(a.high), n = size_of(a.rows()) * b;
    std::vector<double> l(n * n);
    for (std::size_t i = 0; i < size_of(a.rows()); ++i)
        for (auto at = size_of(a.start[i]); at < size_of(a.start[i + 1]); ++at)
            for (std::size_t k = 0; k < b; ++k)
                for (std::size_t m = 0; m < b; ++m)
                    l[(i * b + k) * n + size_of(a.column[at]) * b + m] =
                        a.value[(at * b + m) * b + k];
    for (std::size_t j = 0; j < n; ++j) {
        double *lj = l.data() + j * n;
        const double own = lj[j];
        // What rounding to float32 left of a motion without energy may be negative.
        lj[j] = std::sqrt(std::max(own - dot(lj, lj, j), 1e-7 * own));
        for (std::size_t i = j + 1; i < n; ++i) {
            double *li = l.data() + i * n;
            li[j] = (li[j] - dot(li, lj, j)) / lj[j];
        }
    }
    return l;
}

} // namespace

struct Aggregation::Level {
    Sweeps a;
    BlockRows p; // to the next coarser level
    Columns columns;
    std::vector<float> residual; // here
    std::vector<float> r, z;     // on the coarser level

    Level(BlockRows matrix, const RowKernels &kernels, Team &team)
        : a(std::move(matrix), kernels, team) {}

    std::size_t bytes() const {
        return a.bytes() + p.bytes() + 12 * columns.row.size() + 8 * columns.start.size() +
               4 * (residual.size() + r.size() + z.size());
    }
};

Aggregation::Aggregation(BlockRows matrix, const double *points, const std::uint8_t *fixed,
                         const RowKernels &kernels, Team &team)
    : kernels_(kernels), team_(team) {
    // Of the vertices they are many, and made again where a second try asks for them.
    Motions of_rows = [=, rows = size_of(matrix.rows())] {
        return rigid_motions(points, fixed, rows);
    };
    for (bool coarser = true; coarser;) {
        levels_.push_back(std::make_unique<Level>(std::move(matrix), kernels, team));
        Level &level = *levels_.back();
        if (level.a.matrix().rows() <= small) {
            factor_ = dense_factor(level.a.matrix());
            return;
        }
        coarser = coarsen(level, matrix, of_rows);
    }
}

/// Makes the next coarser matrix and the motions of its rows, unless nothing hangs together.
bool Aggregation::coarsen(Level &level, BlockRows &matrix, Motions &of_rows) {
    give_back_spare_memory();
    const BlockRows &a = level.a.matrix();
    const std::vector<float> inverse = level.a.inverse_diagonal(team_);
    level.residual.resize(size_of(a.rows() * a.high));
    // Flat tets couple strongly in one direction only. Aggregates along it are the better ones but
    // many, with many couplings: where they take more memory than this level, size decides.
    const double threshold = a.high == 3 ? weak_between_vertices : weak_between_aggregates;
    const std::size_t most = a.column.size() * size_of(a.high * a.high) / (motions * motions);
    const bool coarser = coarsened(level, inverse, threshold, most, matrix, of_rows) ||
                         coarsened(level, inverse, threshold / 4, most, matrix, of_rows) ||
                         coarsened(level, inverse, 0, a.column.size(), matrix, of_rows);
    if (!coarser)
        level.p = {};
    level.a.keep_inverse(inverse, team_);
    return coarser;
}

bool Aggregation::coarsened(Level &level, const std::vector<float> &inverse, double threshold,
                            std::size_t most, BlockRows &matrix, Motions &of_rows) {
    const BlockRows &a = level.a.matrix();
    const Aggregates groups = aggregates(a, threshold, team_);
    if (groups.count >= a.rows() * 8 / 10)
        return false;
    Tentative made = tentative(of_rows(), a.high, groups, team_);
    const double largest = margin * largest_eigenvalue(a, inverse, kernels_.of(a.high), team_);
    // 4/3 of its inverse: the step that flattens the spectrum most (Vanek, Mandel, Brezina).
    level.p = smoothed(a, inverse, 4 / (3 * largest), made.basis, groups, team_);
    std::vector<float>().swap(made.basis);
    give_back_spare_memory();
    level.columns = columns_of(level.p, groups.count, team_);
    std::optional<BlockRows> coarse = galerkin(a, level.p, level.columns, most, kernels_, team_);
    if (!coarse)
        return false;
    matrix = std::move(*coarse);
    make_definite(matrix);
    of_rows = [coarse = std::move(made.coarse)] { return coarse; };
    level.r.resize(size_of(groups.count) * motions);
    level.z.resize(level.r.size() + BlockRows::slack); // read in whole registers
    return true;
}

Aggregation::~Aggregation() = default;

void Aggregation::apply(const float *r, float *z) { cycle(0, r, z); }

void Aggregation::cycle(std::size_t at, const float *r, float *z) {
    Level &level = *levels_[at];
    if (at + 1 == levels_.size() && !factor_.empty())
        return solve_coarsest(r, z);
    level.a.forward(r, z, level.residual.data(), team_);
    if (at + 1 < levels_.size()) {
        restrict_to_coarse(level, level.residual.data());
        cycle(at + 1, level.r.data(), level.z.data());
        add_prolonged(level, z);
    }
    level.a.backward(r, z, team_);
}

/// r on the coarser level = P^T residual.
void Aggregation::restrict_to_coarse(Level &level, const float *residual) {
    const auto columns = static_cast<std::int64_t>(level.columns.start.size()) - 1;
    each_piece(team_, columns, [&](std::size_t begin, std::size_t end, std::size_t) {
        kernels_.of(level.p.high)
            .restricted(level.p.seen(), level.columns.seen(), begin, end, residual, level.r.data());
    });
}

/// z += P e, for e on the coarser level.
void Aggregation::add_prolonged(const Level &level, float *z) {
    each_piece(team_, level.p.rows(), [&](std::size_t begin, std::size_t end, std::size_t) {
        kernels_.of(level.p.high).prolong(level.p.seen(), begin, end, level.z.data(), z);
    });
}

void Aggregation::solve_coarsest(const float *r, float *z) {
    const std::size_t n =
        size_of(levels_.back()->a.matrix().rows() * levels_.back()->a.matrix().high);
    std::vector<double> x(r, r + n);
    for (std::size_t i = 0; i < n; ++i) {
        const double *row = factor_.data() + i * n;
        x[i] = (x[i] - dot(row, x.data(), i)) / row[i];
    }
    for (std::size_t i = n; i-- > 0;) {
        x[i] /= factor_[i * n + i];
        for (std::size_t k = 0; k < i; ++k)
            x[k] -= factor_[i * n + k] * x[i];
    }
    std::ranges::transform(x, z, [](double v) { return static_cast<float>(v); });
}

std::size_t Aggregation::bytes() const {
    std::size_t sum = factor_.size() * 8;
    for (const auto &level : levels_)
        sum += level->bytes();
    return sum;
}

std::vector<std::int64_t> Aggregation::sizes() const {
    std::vector<std::int64_t> rows;
    for (const auto &level : levels_)
        rows.push_back(level->a.matrix().rows());
    return rows;
}

} // namespace bezsoma
