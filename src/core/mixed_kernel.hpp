// SPDX-License-Identifier: BSD-3-Clause
// The displacement-pressure form on a batch of tets: included after elastic_kernel.hpp.
//
//   f_a = n V sum_i (M T)_(a-e_i) g_i     T = 2 G (eps - tr eps / 3 I) - (E p) I
//   g   = -V E^T M (tr H + E p / kappa)   E elevates the pressure to degree m = n - 1
//
// Seven components climb the ladder where the elastic operator has six. In the basis scaled by
// multinomials E is a chain of sums, as the ladder itself.
#pragma once

namespace bezsoma::BEZSOMA_ISA {

/// In the order of entities: which row each pressure of a tet is, and its multinomial.
template <int m> struct PressureOrder {
    int row[controls(m)] = {};
    double multinomial[controls(m)] = {};
    constexpr PressureOrder() {
        for (int i = 0; i < controls(m); ++i) {
            row[i] = entity_order<m>.row[3 * i] / 3;
            multinomial[i] = 1 / ladder_scales<m>.top[row[i]];
        }
    }
};

template <int m> inline constexpr PressureOrder<m> pressure_order{};

/// The same for a degree known when this runs: the pressure is a seventh of the work.
struct PressurePlan {
    const int *row;
    const double *multinomial;
    int inside[4];

    int entities() const { return inside[3] ? 15 : inside[2] ? 14 : inside[1] ? 10 : 4; }
};

#define BEZSOMA_PLAN(m)                                                                            \
    {                                                                                              \
        pressure_order<m>.row, pressure_order<m>.multinomial, {                                    \
            inside(m, 0), inside(m, 1), inside(m, 2), inside(m, 3)                                 \
        }                                                                                          \
    }
inline constexpr PressurePlan pressure_plans[] = {BEZSOMA_PLAN(1), BEZSOMA_PLAN(2), BEZSOMA_PLAN(3),
                                                  BEZSOMA_PLAN(4), BEZSOMA_PLAN(5), BEZSOMA_PLAN(6),
                                                  BEZSOMA_PLAN(7)};

/// Calls f(p, p1, p2, p3) for every control of degree m as `each_control` does.
template <class F> BEZSOMA_INLINE void each_control_of(int m, F &&f) {
    int p = 0;
    for (int s3 = 0; s3 <= m; ++s3) {
        const int layer = (s3 + 1) * (s3 + 2) / 2;
        for (int s2 = 0; s2 <= s3; ++s2)
            for (int s1 = 0; s1 <= s2; ++s1, ++p)
                f(p, p + layer, p + layer + s2 + 1, p + layer + s2 + 2);
    }
}

/// Calls f(number among the run's, first of the run, row, multinomial) for the pressures of a tet.
template <class F> BEZSOMA_INLINE void each_pressure(const PressurePlan &plan, F &&f) {
    int next = 0;
    for (int e = 0, all = plan.entities(); e < all; ++e)
        for (int i = 0; i < plan.inside[entity_dim(e)]; ++i, ++next)
            f(e, i, plan.row[next], plan.multinomial[next]);
}

/// p (controls of degree m) of `lanes` tets, scaled by multinomials.
template <int lanes>
BEZSOMA_INLINE void gather_pressure(int m, const double *from, const std::int32_t *first,
                                    Lanes<double, lanes> *p) {
    each_pressure(pressure_plans[m - 1], [&](int e, int i, int row, double multinomial) {
        Lanes<double, lanes> found = {};
#pragma GCC unroll 8
        for (int l = 0; l < lanes; ++l)
            found[l] = from[first[e * lanes + l] + i];
        p[row] = found * multinomial;
    });
}

template <int lanes>
BEZSOMA_INLINE void scatter_pressure(int m, double *to, const std::int32_t *first,
                                     const Lanes<double, lanes> *g) {
    each_pressure(pressure_plans[m - 1], [&](int e, int i, int row, double multinomial) {
        const Lanes<double, lanes> found = g[row] * multinomial;
#pragma GCC unroll 8
        for (int l = 0; l < lanes; ++l)
            to[first[e * lanes + l] + i] += found[l];
    });
}

/// Elevation in the scaled basis from degree `low` to `high`, in place.
template <class R> BEZSOMA_INLINE void raise(int low, int high, R *p) {
    for (int j = low; j < high; ++j) {
        R lower[controls(highest_mixed_degree - 2)];
        each_control_of(j, [&](int at, int, int, int) { lower[at] = p[at]; });
        for (int at = 0, all = (j + 2) * (j + 3) * (j + 4) / 6; at < all; ++at)
            p[at] = R{};
        each_control_of(j, [&](int at, int p1, int p2, int p3) {
            p[at] += lower[at];
            p[p1] += lower[at];
            p[p2] += lower[at];
            p[p3] += lower[at];
        });
    }
}

/// Its transpose, from degree `high` to `low`: rows are read at and after the one written.
template <class R> BEZSOMA_INLINE void lower(int high, int low, R *g) {
    for (int j = high - 1; j >= low; --j)
        each_control_of(
            j, [&](int at, int p1, int p2, int p3) { g[at] = (g[at] + g[p1]) + (g[p2] + g[p3]); });
}

/// sqrt(V) of every lane's tet: |det of the three sqrt(V) grad L_i| is sqrt(V) / 6.
template <int lanes>
BEZSOMA_INLINE Lanes<double, lanes> root_volume(const Batch<double, lanes> &tet) {
    const auto &g = tet.g;
    Lanes<double, lanes> det = g[0][0] * (g[1][1] * g[2][2] - g[1][2] * g[2][1]) -
                               g[0][1] * (g[1][0] * g[2][2] - g[1][2] * g[2][0]) +
                               g[0][2] * (g[1][0] * g[2][1] - g[1][1] * g[2][0]);
    for (int l = 0; l < lanes; ++l)
        det[l] = det[l] < 0 ? -det[l] : det[l];
    return det * 6.0;
}

/// What a batch holds of its tets: G stands in mu, 1/kappa in lambda.
template <int lanes>
BEZSOMA_INLINE Batch<double, lanes> batch_of_mixed(const MixedBatches &b, std::int64_t i) {
    Batch<double, lanes> tet = {};
    for (int k = 0; k < 9; ++k)
        tet.g[k / 3][k % 3] = load<double, lanes>(b.geometry + (9 * i + k) * lanes);
    for (int l = 0; l < lanes; ++l) {
        tet.mu[l] = b.moduli[2 * b.region[i * lanes + l]];
        tet.lambda[l] = b.moduli[2 * b.region[i * lanes + l] + 1];
    }
    return tet;
}

/// n times the moments sqrt(V) M T of the stress, and those of -(tr H + E p / kappa) times
/// sqrt(V) sqrt(V); p comes in scaled and elevated to degree n - 1.
template <int n, int lanes>
BEZSOMA_INLINE void mixed_moments(const Batch<double, lanes> &tet, Lanes<double, lanes> root,
                                  const Lanes<double, lanes> *u, const Lanes<double, lanes> *p,
                                  Lanes<double, lanes> (&stress)[6][controls(n - 1)],
                                  Lanes<double, lanes> (&trace)[controls(n - 1)]) {
    using R = Lanes<double, lanes>;
    constexpr int m = n - 1;
    const R mu = tet.mu * (n * n * ladder_unit<m>), per_n = root * (n * ladder_unit<m>);
    const R compressibility = tet.lambda * root * root * ladder_unit<m>;
    each_control<m>([&](int b, int p1, int p2, int p3) {
        R h[3][3];
        gradient<double, lanes>(tet, u, b, p1, p2, p3, h);
        const double top = ladder_scales<m>.top[b];
        const R swelling = h[0][0] + h[1][1] + h[2][2];
        const R shear = mu * top, pressure = p[b] * (top * top);
        const R mean = shear * swelling * (2.0 / 3.0) + per_n * pressure;
        stress[0][b] = shear * (h[0][0] + h[0][0]) - mean;
        stress[1][b] = shear * (h[1][1] + h[1][1]) - mean;
        stress[2][b] = shear * (h[2][2] + h[2][2]) - mean;
        stress[3][b] = shear * (h[0][1] + h[1][0]);
        stress[4][b] = shear * (h[1][2] + h[2][1]);
        stress[5][b] = shear * (h[2][0] + h[0][2]);
        trace[b] = -(per_n * swelling * top + compressibility * pressure);
    });
    for (int c = 0; c < 6; ++c)
        ladder<m, m, double, lanes>(stress[c]);
    ladder<m, m, double, lanes>(trace);
}

template <int n, int lanes> void mixed_apply(const MixedBatches &b) {
    using R = Lanes<double, lanes>;
    constexpr int m = n - 1;
    const int low = b.pressure_degree, entities_of_pressure = pressure_plans[low - 1].entities();
    R u[3 * controls(n)], f[3 * controls(n)], p[controls(m)];
    R stress[6][controls(m)], trace[controls(m)];
    for (std::int64_t i = 0; i < b.count; ++i) {
        const std::int32_t *first = b.first + i * entities(n) * lanes;
        const std::int32_t *first_pressure = b.first_pressure + i * entities_of_pressure * lanes;
        const Batch<double, lanes> tet = batch_of_mixed<lanes>(b, i);
        gather<n, double, lanes>(b.u, first, u);
        gather_pressure<lanes>(low, b.p, first_pressure, p);
        raise(low, m, p);
        mixed_moments<n, lanes>(tet, root_volume<lanes>(tet), u, p, stress, trace);
        forces_of_moments<n, double, lanes>(tet, stress, f);
        scatter<n, double, lanes>(b.f, first, f);
        for (int at = 0; at < controls(m); ++at)
            trace[at] *= ladder_scales<m>.top[at] * ladder_scales<m>.top[at];
        lower(m, low, trace);
        scatter_pressure<lanes>(low, b.g, first_pressure, trace);
    }
}

/// int 2 G eps' : eps' + p^2 / kappa, from gradients: a body that is carried far loses nothing.
template <int n, int lanes> double mixed_work(const MixedBatches &b) {
    using R = Lanes<double, lanes>;
    constexpr int m = n - 1;
    const int low = b.pressure_degree, entities_of_pressure = pressure_plans[low - 1].entities();
    R u[3 * controls(n)], p[controls(m)], zero[controls(m)] = {};
    R stress[6][controls(m)], trace[controls(m)], sum = {};
    for (std::int64_t i = 0; i < b.count; ++i) {
        Batch<double, lanes> tet = batch_of_mixed<lanes>(b, i);
        const R root = root_volume<lanes>(tet);
        const R compressibility = tet.lambda * root * root * ladder_unit<m>;
        gather<n, double, lanes>(b.u, b.first + i * entities(n) * lanes, u);
        gather_pressure<lanes>(low, b.p, b.first_pressure + i * entities_of_pressure * lanes, p);
        raise(low, m, p);
        mixed_moments<n, lanes>(tet, root, u, zero, stress, trace);
        for (int at = 0; at < controls(m); ++at)
            trace[at] = p[at] = p[at] * (ladder_scales<m>.top[at] * ladder_scales<m>.top[at]);
        ladder<m, m, double, lanes>(trace);
        each_control<m>([&](int at, int p1, int p2, int p3) {
            R h[3][3];
            gradient<double, lanes>(tet, u, at, p1, p2, p3, h);
            const double top = ladder_scales<m>.top[at];
            sum +=
                top * (h[0][0] * stress[0][at] + h[1][1] * stress[1][at] + h[2][2] * stress[2][at] +
                       (h[0][1] + h[1][0]) * stress[3][at] + (h[1][2] + h[2][1]) * stress[4][at] +
                       (h[2][0] + h[0][2]) * stress[5][at]);
            sum += compressibility * p[at] * trace[at];
        });
    }
    double all = 0;
    for (int l = 0; l < lanes; ++l)
        all += sum[l];
    return all;
}

/// f = - int p div v: the part of `mixed_apply` that is the pressure's.
template <int n, int lanes> void mixed_couple(const MixedBatches &b) {
    using R = Lanes<double, lanes>;
    constexpr int m = n - 1;
    const int low = b.pressure_degree, entities_of_pressure = pressure_plans[low - 1].entities();
    R f[3 * controls(n)], p[controls(m)];
    for (std::int64_t i = 0; i < b.count; ++i) {
        const Batch<double, lanes> tet = batch_of_mixed<lanes>(b, i);
        gather_pressure<lanes>(low, b.p, b.first_pressure + i * entities_of_pressure * lanes, p);
        raise(low, m, p);
        const R scale = root_volume<lanes>(tet) * (-n * ladder_unit<m>);
        for (int at = 0; at < controls(m); ++at)
            p[at] *= scale * (ladder_scales<m>.top[at] * ladder_scales<m>.top[at]);
        ladder<m, m, double, lanes>(p);
        for (int row = 0; row < 3 * controls(n); ++row)
            f[row] = R{};
        each_control<m>([&](int at, int p1, int p2, int p3) {
            const R x = p[at] * ladder_scales<m>.top[at];
#pragma GCC unroll 3
            for (int k = 0; k < 3; ++k) {
                const R f1 = x * tet.g[0][k], f2 = x * tet.g[1][k], f3 = x * tet.g[2][k];
                f[3 * at + k] -= f1 + f2 + f3;
                f[3 * p1 + k] += f1;
                f[3 * p2 + k] += f2;
                f[3 * p3 + k] += f3;
            }
        });
        scatter<n, double, lanes>(b.f, b.first + i * entities(n) * lanes, f);
    }
}

// ---------------------------------------------------------------- the pressure alone

/// The diagonal of M, and the levels of the ladder that is M^-1.
///
/// On polynomials of degree i that are orthogonal to lower ones M^m is the number
/// l(m, i) = 3! m!^2 / ((m + i + 3)! (m - i)!) and E_j E_j^T is l(j, i) / l(m, i), or 0 for j < i.
/// So sum_j b_j E_j E_j^T is the inverse where sum_(j >= i) b_j l(j, i) = 1 for all i.
template <int m> struct InverseScales {
    double diagonal[controls(m)] = {};
    double level[combinations(m + 4, 4)] = {};

    static constexpr double number(int j, int i) {
        return 6 * factorial(j) * factorial(j) / factorial(j + i + 3) / factorial(j - i);
    }

    constexpr InverseScales() {
        double b[m + 1] = {};
        for (int i = m; i >= 0; --i) {
            double left = 1;
            for (int j = i + 1; j <= m; ++j)
                left -= b[j] * number(j, i);
            b[i] = left / number(i, i);
        }
        int next = 0;
        for (int j = 0; j <= m; ++j)
            for (int s3 = 0; s3 <= j; ++s3)
                for (int s2 = 0; s2 <= s3; ++s2)
                    for (int s1 = 0; s1 <= s2; ++s1) {
                        const int alpha[4] = {j - s3, s3 - s2, s2 - s1, s1};
                        double multinomial = factorial(j);
                        double own = 1.0 / combinations(2 * m, m) / combinations(2 * m + 3, 3);
                        for (const int a : alpha) {
                            multinomial /= factorial(a);
                            own *= combinations(2 * a, a);
                        }
                        level[next++] = b[j] * multinomial * multinomial;
                        if (j == m)
                            diagonal[position(s3, s2, s1)] = own;
                    }
    }
};

template <int m> inline constexpr InverseScales<m> inverse_scales{};

enum class OnPressure { mass, inverse, diagonal };

template <int m, int lanes, OnPressure what> void on_pressure(const MixedBatches &b) {
    using R = Lanes<double, lanes>;
    constexpr auto &top = ladder_scales<m>.top;
    constexpr auto &diagonal = inverse_scales<m>.diagonal;
    R p[controls(m)];
    for (std::int64_t i = 0; i < b.count; ++i) {
        const std::int32_t *first = b.first_pressure + i * entities(m) * lanes;
        const Batch<double, lanes> tet = batch_of_mixed<lanes>(b, i);
        const R root = root_volume<lanes>(tet), weight = tet.mu * root * root;
        if constexpr (what == OnPressure::diagonal) {
            for (int at = 0; at < controls(m); ++at)
                p[at] = weight * (diagonal[at] * top[at]);
        } else {
            constexpr bool inverse = what == OnPressure::inverse;
            gather_pressure<lanes>(m, b.p, first, p);
            for (int at = 0; at < controls(m); ++at)
                p[at] *= top[at] * top[at] * (inverse ? diagonal[at] : 1.0);
            if constexpr (inverse)
                ladder<m, m, double, lanes, inverse_scales<m>>(p);
            else
                ladder<m, m, double, lanes>(p);
            for (int at = 0; at < controls(m); ++at)
                p[at] *= weight * (top[at] * top[at] * (inverse ? diagonal[at] : ladder_unit<m>));
        }
        scatter_pressure<lanes>(m, b.g, first, p);
    }
}

} // namespace bezsoma::BEZSOMA_ISA
