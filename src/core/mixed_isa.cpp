// SPDX-License-Identifier: BSD-3-Clause
// The mixed kernels, compiled once for each instruction set as kernels_isa.cpp is, and like it
// without anything of the standard library.
#include "kernels.hpp"
#include "mixed_kernels.hpp"

#include "elastic_kernel.hpp"

#include "mixed_kernel.hpp"

namespace bezsoma::BEZSOMA_ISA {

template <int n> static constexpr MixedKernel form_of_degree() {
    constexpr int lanes = BEZSOMA_BYTES / 8;
    if constexpr (n >= 2 && n <= BEZSOMA_HIGHEST_DEGREE)
        return {mixed_apply<n, lanes>, mixed_couple<n, lanes>, mixed_work<n, lanes>};
    else
        return {};
}

template <int m> static constexpr PressureKernel pressure_of_degree() {
    constexpr int lanes = BEZSOMA_BYTES / 8;
    if constexpr (m < BEZSOMA_HIGHEST_DEGREE)
        return {on_pressure<m, lanes, OnPressure::mass>, on_pressure<m, lanes, OnPressure::inverse>,
                on_pressure<m, lanes, OnPressure::diagonal>};
    else
        return {};
}

extern const MixedKernels mixed_kernels;
constinit const MixedKernels mixed_kernels = {
    {form_of_degree<1>(), form_of_degree<2>(), form_of_degree<3>(), form_of_degree<4>(),
     form_of_degree<5>(), form_of_degree<6>(), form_of_degree<7>(), form_of_degree<8>()},
    {pressure_of_degree<1>(), pressure_of_degree<2>(), pressure_of_degree<3>(),
     pressure_of_degree<4>(), pressure_of_degree<5>(), pressure_of_degree<6>(),
     pressure_of_degree<7>()}};

} // namespace bezsoma::BEZSOMA_ISA
