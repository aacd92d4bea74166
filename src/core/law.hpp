// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "kernels.hpp"
#include "pointwise_kernels.hpp"

namespace bezsoma {

/// Names of the laws, in the order of PointwiseKernels::laws, and their parameters after kappa.
struct LawName {
    const char *name;
    int parameters; // including kappa; of a sum those of one term and kappa
    bool is_sum;
};
extern const LawName law_names[number_of_laws];

/// A law with its parameters, kappa first: see docs/theory/laws.md.
struct Law {
    int number;
    std::vector<double> parameters;

    const LawName &name() const { return law_names[number]; }
    std::int32_t terms() const {
        return static_cast<std::int32_t>((parameters.size() - 1) / 2); // asked of sums alone
    }
};

/// The number of a law by its name; -1 for none.
int law_numbered(const char *name);

/// Displacement gradients H (count, 3, 3) with pressures p (count,), if it is mixed; and changes.
struct States {
    std::size_t count;
    const double *H, *p;
};

enum class Answer { stress, derivative, energy };

/// What the law answers: P (count, 3, 3), mixed also c (count,); or energies at P (count,).
Extremes answers(const Law &law, const Kernels &kernels, Answer which, const States &state,
                 const States &change, double *P, double *c);

/// Nothing seen yet.
Extremes nothing_seen();

} // namespace bezsoma
