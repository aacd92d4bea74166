// SPDX-License-Identifier: BSD-3-Clause
// The mixed operator's kernels of one instruction set, as function pointers: see kernels.hpp.
#pragma once

#include <cstdint>

namespace bezsoma {

/// Tets of one chunk in batches of one per lane, and the two fields they work on.
///
/// As `Batches`; first_pressure (batches, entities of the pressure's degree, lanes) is for the
/// pressure what `first` is for the displacement. moduli (regions, 2): G and 1/kappa. u, f
/// (controls, 3) and p, g (pressure controls,) over the chunk's own controls, padded by 16 numbers;
/// f and g are added to.
struct MixedBatches {
    std::int64_t count;
    int pressure_degree;
    const std::int32_t *first;
    const std::int32_t *first_pressure;
    const double *geometry;
    const std::int32_t *region;
    const double *moduli;
    const double *u;
    const double *p;
    double *f;
    double *g;
};

constexpr int highest_mixed_degree = 8;

struct MixedKernel {
    void (*apply)(const MixedBatches &);
    double (*work)(const MixedBatches &); // int 2 G eps' : eps' + p^2 / kappa
    /// g = M p, weighted with moduli[2 region], by degree of the pressure.
    void (*mass)(const MixedBatches &);
};

/// By degree of the displacement - 1 (degree 1 has no stable pressure, and is empty); `mass` by
/// degree of the pressure - 1.
struct MixedKernels {
    MixedKernel degree[highest_mixed_degree];
};

} // namespace bezsoma
