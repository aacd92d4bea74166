// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, as kernels_isa.cpp and under the same rule: nothing of
// the standard library is included.
#include "law_kernel.hpp"
#include "pointwise_kernel.hpp"

namespace bezsoma::BEZSOMA_ISA {

constexpr int lanes64 = BEZSOMA_BYTES / 8, lanes32 = BEZSOMA_BYTES / 4;

#define BEZSOMA_LAW(T, lanes, ...) law_kernel<__VA_ARGS__, T, lanes>()
#define BEZSOMA_LAWS(T, lanes)                                                                     \
    {BEZSOMA_LAW(T, lanes, SmallStrain<Constant>),                                                 \
     BEZSOMA_LAW(T, lanes, SmallStrain<Frobenius<1>>),                                             \
     BEZSOMA_LAW(T, lanes, SmallStrain<Mean<1>>),                                                  \
     BEZSOMA_LAW(T, lanes, SmallStrain<Frobenius<2>>),                                             \
     BEZSOMA_LAW(T, lanes, SmallStrain<Mean<2>>),                                                  \
     BEZSOMA_LAW(T, lanes, SmallStrain<EnergyNorm>),                                               \
     BEZSOMA_LAW(T, lanes, SmallStrain<Deviatoric>),                                               \
     BEZSOMA_LAW(T, lanes, FiniteStrain<StVenantKirchhoff>),                                       \
     BEZSOMA_LAW(T, lanes, FiniteStrain<NeoHooke>),                                                \
     BEZSOMA_LAW(T, lanes, FiniteStrain<NeoHookeIsochoric>),                                       \
     BEZSOMA_LAW(T, lanes, FiniteStrain<MooneyRivlin>),                                            \
     BEZSOMA_LAW(T, lanes, FiniteStrain<Ogden>),                                                   \
     BEZSOMA_LAW(T, lanes, FiniteStrain<VerondaWestmann>),                                         \
     BEZSOMA_LAW(T, lanes, FiniteStrain<Guccione>)}

#define BEZSOMA_NETS(T, lanes)                                                                     \
    {net_kernel<1, T, lanes>(), net_kernel<2, T, lanes>(), net_kernel<3, T, lanes>(),              \
     net_kernel<4, T, lanes>(), net_kernel<5, T, lanes>(), net_kernel<6, T, lanes>(),              \
     net_kernel<7, T, lanes>(), net_kernel<8, T, lanes>(), net_kernel<9, T, lanes>(),              \
     net_kernel<10, T, lanes>()}

extern const PointwiseKernels pointwise_kernels;
constinit const PointwiseKernels pointwise_kernels = {pointwise<Asked::forces, double, lanes64>,
                                                      pointwise<Asked::tangent, double, lanes64>,
                                                      pointwise<Asked::energy, double, lanes64>,
                                                      pointwise<Asked::tangent, float, lanes32>,
                                                      BEZSOMA_NETS(double, lanes64),
                                                      BEZSOMA_NETS(float, lanes32),
                                                      BEZSOMA_LAWS(double, lanes64),
                                                      BEZSOMA_LAWS(float, lanes32)};

} // namespace bezsoma::BEZSOMA_ISA
