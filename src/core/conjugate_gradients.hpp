// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "elastic_operator.hpp"
#include "preconditioner.hpp"

namespace bezsoma {

struct Convergence {
    std::vector<double> history; // relative residuals as the recurrence has them
    double residual = 0;         // the true one at the end, relative
    bool converged = false;
    bool indefinite = false; // a direction without positive energy was met
};

/// Told the iteration and its relative residual.
using Watch = std::function<void(int iteration, double residual)>;

/// Solves K x = f on the free components by preconditioned conjugate gradients in float64.
///
/// x (controls, 3) comes in with the prescribed components and a first guess; `reference` is the
/// norm that residuals are relative to. When the recurrence says that rtol is reached the true
/// residual is formed; where that has drifted above, the iteration begins anew from it.
Convergence conjugate_gradients(ElasticOperator<double> &k, Preconditioner &blocks,
                                const VertexSolver &vertices, const std::uint8_t *fixed,
                                const double *f, double *x, double reference, double rtol, int most,
                                Team &team, const Watch &watch);

} // namespace bezsoma
