// SPDX-License-Identifier: BSD-3-Clause
// Solving the displacement-pressure form: K indefinite, the preconditioner block triangular.
#pragma once

#include <cstdint>
#include <vector>

#include "conjugate_gradients.hpp"
#include "mixed_operator.hpp"

namespace bezsoma {

/// What the pressure needs: about (int weight p q)^-1, and what is taken out of it.
class PressureInverse {
public:
    /// weight: one a region. levels (count, pressures): orthogonal vectors that are projected out.
    PressureInverse(MixedOperator &form, std::vector<double> weight, std::vector<double> levels,
                    Team &team);

    /// z = about the inverse times r, free of levels.
    void apply(const double *r, double *z);

    /// 1 over the diagonal of the mass matrix, N/mm5: what makes changes of volume comparable.
    const std::vector<double> &inverse_diagonal() const { return inverse_; }

    /// Takes the levels out of a vector.
    void project(double *p);

private:
    void shared(const double *r, double *z);

    MixedOperator &form_;
    std::vector<double> weight_, levels_;
    std::vector<double> inverse_; // of the diagonal of the mass matrix
    std::vector<double> divided_, x_, y_, step_;
    Team &team_;
};

/// Where a saddle-point problem is to be solved: forces and changes of volume, what is fixed.
struct SaddleProblem {
    const std::uint8_t *fixed; // (controls, 3)
    const double *f;           // (controls, 3)
    const double *g;           // (pressures,)
    double unit;               // N/mm: the displacement's preconditioner is that of A / unit
    double volume_weight;      // N/mm3: makes a change of volume comparable with a force
    double rtol;
    int most;
};

/// Solves for u (controls, 3) and p (pressures,), which come in with zeros.
///
/// BiCGStab (H. A. van der Vorst, SIAM J. Sci. Stat. Comput. 13, 1992), preconditioned from the
/// right by the block triangular [A B^T; 0 -S]^-1; an iteration applies the form twice. Where its
/// residual leaps away it begins anew from the best answer so far. Converged
/// where both parts of the true residual, forces and weighted changes of volume, are below rtol of
/// the right-hand side. `history` has the larger of both.
Convergence saddle(MixedOperator &form, Search &displacement, PressureInverse &pressure,
                   const SaddleProblem &problem, double *u, double *p, Team &team,
                   const Watch &watch);

} // namespace bezsoma
