// SPDX-License-Identifier: BSD-3-Clause
// Laws at small strain: linear, and stiffening by exp(A s^2) with a measure s of the strain.
//
//   tau = g (2 mu eps' + kappa tr(eps) I),   g = exp(A s^2)            (Roth et al. 1998, eq.
//   22-23)
//
// with mu = G0, kappa of E0 and nu: the paper's E0 exp(A s^2) C1 eps. Mixed: kappa g tr(eps) is -p.
// Strains come as eps_xx, eps_yy, eps_zz and the engineering shears gamma_xy, gamma_yz, gamma_zx.
#pragma once

#include "motion.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// eps':eps', what shears the material without changing its volume.
template <class S> BEZSOMA_INLINE S deviator_squared(const S *e) {
    using T = Plain<S>;
    const S a = e[0] - e[1], b = e[1] - e[2], c = e[2] - e[0];
    return (a * a + b * b + c * c) * T(1.0 / 3) +
           (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]) * T(0.5);
}

/// No stiffening at all.
struct Constant {
    static constexpr bool stiffens = false, has_energy = true, splits = true, volume_too = true;
};

/// s^2 = sum eps_ij^2; `shear` is 1 for tensor shears, 2 for the paper's literal eq. 24.
template <int shear> struct Frobenius {
    static constexpr bool stiffens = true, has_energy = false, splits = true, volume_too = true;
    template <class S, class T> static BEZSOMA_INLINE S squared(const T *, const S *e) {
        return e[0] * e[0] + e[1] * e[1] + e[2] * e[2] +
               (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]) * Plain<S>(0.5 * shear * shear);
    }
};

/// s = (1/9) sum |eps_ij|.
template <int shear> struct Mean {
    static constexpr bool stiffens = true, has_energy = false, splits = true, volume_too = true;
    template <class S, class T> static BEZSOMA_INLINE S squared(const T *, const S *e) {
        const S s = (abs(e[0]) + abs(e[1]) + abs(e[2])) * Plain<S>(1.0 / 9) +
                    (abs(e[3]) + abs(e[4]) + abs(e[5])) * Plain<S>(shear / 9.0);
        return s * s;
    }
};

/// s^2 = eps:C1:eps, so that W = E0/(2A) (exp(A s^2) - 1).
struct EnergyNorm {
    static constexpr bool stiffens = true, has_energy = true, splits = false, volume_too = true;
    template <class S, class T> static BEZSOMA_INLINE S squared(const T *par, const S *e) {
        const T kappa = par[0], mu = par[1], inverse_E = (3 * kappa + mu) / (9 * kappa * mu);
        const S tr = e[0] + e[1] + e[2];
        return tr * tr * Plain<S>(kappa * inverse_E) +
               deviator_squared(e) * Plain<S>(2 * mu * inverse_E);
    }
};

/// s^2 = eps':eps' stiffens the shear alone: W = kappa/2 tr^2 + (G0/A) (exp(A s^2) - 1).
struct Deviatoric {
    static constexpr bool stiffens = true, has_energy = true, splits = true, volume_too = false;
    template <class S, class T> static BEZSOMA_INLINE S squared(const T *, const S *e) {
        return deviator_squared(e);
    }
};

/// Parameters kappa, mu, A.
template <class Measure> struct SmallStrain {
    static constexpr bool finite = false;
    static constexpr bool has_energy = Measure::has_energy, splits = Measure::splits;
    static constexpr int components = 6;

    /// tau (6) from the strains e (6); mixed with e[6] = p also c = -tr eps - p/kappa at tau[6].
    template <bool mixed, class T, class S, class R>
    static BEZSOMA_INLINE void stress(const T *par, int, const S *e, S *tau, Watch<R> &watch) {
        const T kappa = par[0], mu = par[1];
        const S tr = e[0] + e[1] + e[2], third = tr * T(1.0 / 3);
        S g, shear, volume;
        if constexpr (Measure::stiffens) {
            g = watched_exp(Measure::squared(par, e) * par[2], watch);
            shear = g * mu;
        }
        if constexpr (mixed) {
            volume = -e[6];
            if constexpr (Measure::stiffens && Measure::volume_too)
                tau[6] = -tr - e[6] * reciprocal(g) * (1 / kappa);
            else
                tau[6] = -tr - e[6] * (1 / kappa);
        } else if constexpr (Measure::stiffens && Measure::volume_too) {
            volume = g * tr * kappa;
        } else {
            volume = tr * kappa;
        }
        for (int c = 0; c < 6; ++c) {
            const S strain = c < 3 ? (e[c] - third) * T(2) : e[c];
            if constexpr (Measure::stiffens)
                tau[c] = strain * shear;
            else
                tau[c] = strain * mu;
        }
        for (int c = 0; c < 3; ++c)
            tau[c] += volume;
    }

    /// The change of tau for a change of e.
    template <bool mixed, class T, class R>
    static BEZSOMA_INLINE void derivative(const T *par, int n, const R *e, const R *de, R *dtau,
                                          Watch<R> &watch) {
        by_duals<SmallStrain, mixed>(par, n, e, de, dtau, watch);
    }

    /// W, and mixed the potential W' - p tr eps - p^2 / (2 kappa).
    template <bool mixed, class T, class R>
    static BEZSOMA_INLINE R energy(const T *par, int, const R *e, Watch<R> &watch) {
        const T kappa = par[0], mu = par[1];
        const R tr = e[0] + e[1] + e[2];
        if constexpr (!has_energy) {
            return R{};
        } else {
            R squared, growth = R{} + 1;
            if constexpr (Measure::stiffens) {
                squared = Measure::squared(par, e);
                watch.exponent(squared * par[2]);
                growth = expm1_quotient(squared * par[2]);
            } else {
                squared = deviator_squared(e);
            }
            if constexpr (!splits) // E0/2 s^2 (exp(A s^2) - 1) / (A s^2)
                return squared * growth * (9 * kappa * mu / (3 * kappa + mu) / 2);
            const R shear = squared * growth * mu;
            if constexpr (mixed)
                return shear - e[6] * (tr + e[6] * (1 / (2 * kappa)));
            else
                return shear + tr * tr * (kappa / 2);
        }
    }
};

} // namespace bezsoma::BEZSOMA_ISA
