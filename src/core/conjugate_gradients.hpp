// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "elastic_operator.hpp"
#include "preconditioner.hpp"

namespace bezsoma {

/// Relative residuals of a recurrence below this have left the true one, which is formed instead.
constexpr double deepest = 1e-17;

struct Convergence {
    std::vector<double> history; // relative residuals as the recurrence has them
    double residual = 0;         // the true one at the end, relative
    bool converged = false;
    bool indefinite = false; // a direction without positive energy was met
    bool rounded = false;    // the true residual does not follow the one of the recurrence down
};

/// Told the iteration and its relative residual.
using Watch = std::function<void(int iteration, double residual)>;

/// Preconditioning in two halves, so that an iteration passes over the vectors once less: what is
/// read of the residual, and the new direction p = beta p + z.
class Search {
public:
    /// Without blocks the degree-1 answer is all there is: the problem is of degree 1 itself.
    Search(Preconditioner *blocks, VertexSolver vertices, Team &team)
        : blocks_(blocks), vertices_(std::move(vertices)), team_(team) {}

    /// Reads r (length), of that norm; returns r . z.
    double take(const double *r, double norm, std::size_t length);
    void follow(double norm, double beta, double *p);

    /// z = B r (length), zero where fixed: both halves at once, for r of norm one or so.
    template <class T> void answer(const T *r, T *z, const std::uint8_t *fixed, std::size_t length);

private:
    Preconditioner *blocks_;
    VertexSolver vertices_;
    Team &team_;
    std::vector<float> r_, z_; // of the degree-1 problem, of a residual scaled to norm one
};

/// Solves K x = f on the free components by preconditioned conjugate gradients in float64.
///
/// x (controls, 3) comes in with the prescribed components and a first guess; `reference` is the
/// norm that residuals are relative to. When the recurrence says that rtol is reached the true
/// residual is formed, which has to reach it to a millionth; where that has drifted above, the
/// iteration begins anew from it.
Convergence conjugate_gradients(ElasticOperator<double> &k, Search search,
                                const std::uint8_t *fixed, const double *f, double *x,
                                double reference, double rtol, int most, Team &team,
                                const Watch &watch);

} // namespace bezsoma
