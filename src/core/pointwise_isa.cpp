// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, as kernels_isa.cpp and under the same rule: nothing of
// the standard library is included.
#include "law_kernel.hpp"
#include "pointwise_kernel.hpp"

namespace bezsoma::BEZSOMA_ISA {

constexpr int lanes64 = BEZSOMA_BYTES / 8;

template <int n, Asked asked> void on_batches(const PointwiseBatches<double> &b) {
    pointwise<n, asked, double, lanes64>(b);
}

#define BEZSOMA_LAW(...) law_kernel<__VA_ARGS__, double, lanes64>()
#define BEZSOMA_DEGREE(n)                                                                          \
    {on_batches<n, Asked::forces>, on_batches<n, Asked::tangent>,                                  \
     pointwise<n, Asked::energy, double, lanes64>}

extern const PointwiseKernels pointwise_kernels;
constinit const PointwiseKernels pointwise_kernels = {
    {BEZSOMA_LAW(SmallStrain<Constant>), BEZSOMA_LAW(SmallStrain<Frobenius<1>>),
     BEZSOMA_LAW(SmallStrain<Mean<1>>), BEZSOMA_LAW(SmallStrain<Frobenius<2>>),
     BEZSOMA_LAW(SmallStrain<Mean<2>>), BEZSOMA_LAW(SmallStrain<EnergyNorm>),
     BEZSOMA_LAW(SmallStrain<Deviatoric>), BEZSOMA_LAW(FiniteStrain<StVenantKirchhoff>),
     BEZSOMA_LAW(FiniteStrain<NeoHooke>), BEZSOMA_LAW(FiniteStrain<NeoHookeIsochoric>),
     BEZSOMA_LAW(FiniteStrain<MooneyRivlin>), BEZSOMA_LAW(FiniteStrain<Ogden>),
     BEZSOMA_LAW(FiniteStrain<VerondaWestmann>), BEZSOMA_LAW(FiniteStrain<Guccione>)},
    {BEZSOMA_DEGREE(1), BEZSOMA_DEGREE(2), BEZSOMA_DEGREE(3), BEZSOMA_DEGREE(4), BEZSOMA_DEGREE(5),
     BEZSOMA_DEGREE(6), BEZSOMA_DEGREE(7), BEZSOMA_DEGREE(8), BEZSOMA_DEGREE(9),
     BEZSOMA_DEGREE(10)}};

} // namespace bezsoma::BEZSOMA_ISA
