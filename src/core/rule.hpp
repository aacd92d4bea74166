// SPDX-License-Identifier: BSD-3-Clause
// A quadrature rule and the Bernstein polynomials at its points, in a basis that knows the
// symmetries of a tet.
//
// The permutations id, (01)(23), (02)(13), (03)(12) of the vertices form a group with the four
// characters c_k(j) = + + + +, + + - -, + - + -, + - - +. Controls that they exchange (an orbit)
// are replaced by their sums with these signs, and the polynomials by their means with them. A part
// k of the field then has at a point moved by permutation j its value times c_k(j): where the
// points come in fours, one point and four additions serve for all, and products with constants
// shrink nearly fourfold. Other points use the same basis without that.
#pragma once

#include <cstdint>
#include <vector>

#include "pointwise_kernels.hpp"

namespace bezsoma {

template <class T> class RuleTables {
public:
    /// points (count, 4) barycentric, weights (count,) with sum 1, values (count, controls): the
    /// polynomials of that degree there.
    RuleTables(int degree, std::int32_t count, const double *points, const double *weights,
               const double *values);

    Rule<T> rule() const;

    /// The number that point i of the rule had.
    std::int32_t given(std::int32_t i) const { return order_[static_cast<std::size_t>(i)]; }

private:
    void order_points(std::int32_t count, const double *points);
    void order_controls(int degree);

    std::int32_t controls_, fours_ = 0;
    std::vector<std::int32_t> order_;
    std::vector<ControlOrbit> orbits_;
    std::int32_t begin_[5] = {}; // of each character among the new controls
    std::vector<T> values_, tests_, weights_;
};

} // namespace bezsoma
