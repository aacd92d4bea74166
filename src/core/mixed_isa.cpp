// SPDX-License-Identifier: BSD-3-Clause
// The mixed kernels, compiled once for each instruction set as kernels_isa.cpp is, and like it
// without anything of the standard library.
#include "kernels.hpp"
#include "mixed_kernels.hpp"

#include "elastic_kernel.hpp"

#include "mixed_kernel.hpp"

namespace bezsoma::BEZSOMA_ISA {

#define BEZSOMA_MIXED(n)                                                                           \
    {mixed_apply<n, BEZSOMA_BYTES / 8>, mixed_work<n, BEZSOMA_BYTES / 8>,                          \
     pressure_mass<n, BEZSOMA_BYTES / 8>}

extern const MixedKernels mixed_kernels;
constinit const MixedKernels mixed_kernels = {
    {{nullptr, nullptr, pressure_mass<1, BEZSOMA_BYTES / 8>},
     BEZSOMA_MIXED(2),
     BEZSOMA_MIXED(3),
     BEZSOMA_MIXED(4),
     BEZSOMA_MIXED(5),
     BEZSOMA_MIXED(6),
     BEZSOMA_MIXED(7),
     BEZSOMA_MIXED(8)}};

} // namespace bezsoma::BEZSOMA_ISA
