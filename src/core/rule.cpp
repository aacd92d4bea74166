// SPDX-License-Identifier: BSD-3-Clause
#include "rule.hpp"

#include <algorithm>
#include <cmath>

#include "size_of.hpp"
#include "tet_controls.hpp"

namespace bezsoma {

namespace {

constexpr int moved[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
constexpr int character[4][4] = {{1, 1, 1, 1}, {1, 1, -1, -1}, {1, -1, 1, -1}, {1, -1, -1, 1}};

/// The number of point x moved by permutation j; -1 if the rule lacks it.
std::int32_t moved_point(std::int32_t count, const double *points, const double *x, int j) {
    for (std::int32_t q = 0; q < count; ++q) {
        double apart = 0;
        for (int i = 0; i < 4; ++i)
            apart = std::max(apart, std::abs(points[4 * q + i] - x[moved[j][i]]));
        if (apart < 1e-14)
            return q;
    }
    return -1;
}

} // namespace

/// Fours first, each in the order of the permutations, then all others.
template <class T> void RuleTables<T>::order_points(std::int32_t count, const double *points) {
    std::vector<bool> taken(size_of(count));
    for (std::int32_t q = 0; q < count; ++q) {
        std::int32_t four[4];
        for (int j = 0; j < 4; ++j)
            four[j] = moved_point(count, points, points + 4 * q, j);
        bool whole = !taken[size_of(q)];
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < j; ++i)
                whole = whole && four[j] >= 0 && four[j] != four[i];
        if (!whole)
            continue;
        for (const std::int32_t p : four) {
            taken[size_of(p)] = true;
            order_.push_back(p);
        }
        ++fours_;
    }
    for (std::int32_t q = 0; q < count; ++q)
        if (!taken[size_of(q)])
            order_.push_back(q);
}

/// Orbits of controls, and where their sums with each character go.
template <class T> void RuleTables<T>::order_controls(int degree) {
    std::vector<bool> taken(size_of(controls_));
    for (int s3 = 0; s3 <= degree; ++s3)
        for (int s2 = 0; s2 <= s3; ++s2)
            for (int s1 = 0; s1 <= s2; ++s1) {
                if (taken[size_of(position(s3, s2, s1))])
                    continue;
                const int alpha[4] = {degree - s3, s3 - s2, s2 - s1, s1};
                ControlOrbit orbit{};
                for (int j = 0; j < 4; ++j) {
                    const int *to = moved[j];
                    const int at = position(alpha[to[1]] + alpha[to[2]] + alpha[to[3]],
                                            alpha[to[2]] + alpha[to[3]], alpha[to[3]]);
                    orbit.control[j] = at;
                    taken[size_of(at)] = true;
                }
                const int *at = orbit.control;
                // What a permutation leaves in place has no part with the sign - there.
                for (int k = 0; k < 4; ++k) {
                    orbit.sum[k] = 0;
                    for (int j = 1; j < 4; ++j)
                        if (at[j] == at[0] && character[k][j] < 0)
                            orbit.sum[k] = -1;
                    begin_[k + 1] += orbit.sum[k] == 0;
                }
                orbit.controls = at[1] == at[0] && at[2] == at[0]                     ? 1
                                 : at[1] == at[0] || at[2] == at[0] || at[3] == at[0] ? 2
                                                                                      : 4;
                orbits_.push_back(orbit);
            }
    std::int32_t next[4];
    for (int k = 0; k < 4; ++k) {
        next[k] = begin_[k];
        begin_[k + 1] += begin_[k];
    }
    for (ControlOrbit &orbit : orbits_)
        for (int k = 0; k < 4; ++k)
            if (orbit.sum[k] == 0)
                orbit.sum[k] = next[k]++;
}

template <class T>
RuleTables<T>::RuleTables(int degree, std::int32_t count, const double *points,
                          const double *weights, const double *values)
    : controls_(bezsoma::controls(degree)) {
    order_points(count, points);
    order_controls(degree);
    values_.resize(size_of(count * controls_));
    tests_.resize(values_.size());
    for (std::int32_t i = 0; i < count; ++i) {
        const std::int32_t q = order_[size_of(i)];
        weights_.push_back(static_cast<T>(weights[q]));
        for (const ControlOrbit &orbit : orbits_)
            for (int k = 0; k < 4; ++k) {
                if (orbit.sum[k] < 0)
                    continue;
                double mean = 0;
                for (int j = 0; j < 4; ++j)
                    mean += character[k][j] * values[q * controls_ + orbit.control[j]] / 4;
                values_[size_of(i * controls_ + orbit.sum[k])] = static_cast<T>(mean);
                tests_[size_of(orbit.sum[k] * count + i)] = static_cast<T>(mean * weights[q]);
            }
    }
}

template <class T> Rule<T> RuleTables<T>::rule() const {
    Rule<T> rule{};
    rule.points = static_cast<std::int32_t>(order_.size());
    rule.controls = controls_;
    rule.fours = fours_;
    rule.orbits = static_cast<std::int32_t>(orbits_.size());
    rule.orbit = orbits_.data();
    std::copy_n(begin_, 5, rule.begin);
    rule.values = values_.data();
    rule.tests = tests_.data();
    rule.weights = weights_.data();
    return rule;
}

template class RuleTables<double>;
template class RuleTables<float>;

} // namespace bezsoma
