// SPDX-License-Identifier: BSD-3-Clause
#include "shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bezsoma {

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

struct Vector {
    double x[3];
};

Vector between(const double *from, const double *to) {
    return {{to[0] - from[0], to[1] - from[1], to[2] - from[2]}};
}

double square(const Vector &a) { return a.x[0] * a.x[0] + a.x[1] * a.x[1] + a.x[2] * a.x[2]; }

Vector cross(const Vector &a, const Vector &b) {
    return {{a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2],
             a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}

/// The determinant of three edges and a bound of its rounding error: three subtractions, two
/// products and five sums enter each of six terms, 8 rounding errors of half an eps, taken four
/// times as large.
struct Determinant {
    double value = 0, bound = 0;

    Determinant(const Vector &a, const Vector &b, const Vector &c) {
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const double one = b.x[j] * c.x[k], other = b.x[k] * c.x[j];
            value += a.x[i] * (one - other);
            bound += 16 * eps * std::abs(a.x[i]) * (std::abs(one) + std::abs(other));
        }
    }
};

/// +1 or -1, 0 where in doubt.
std::int8_t orientation(const double *const p[4], double flat, double largest) {
    const Vector a = between(p[0], p[1]), b = between(p[0], p[2]), c = between(p[0], p[3]);
    const Vector d = between(p[1], p[2]), e = between(p[1], p[3]), f = between(p[2], p[3]);
    double length = 0, area = 0, coordinate = 0;
    for (const Vector *edge : {&a, &b, &c, &d, &e, &f})
        length = std::max(length, square(*edge));
    for (const Vector &normal : {cross(a, b), cross(a, c), cross(b, c), cross(d, e)})
        area = std::max(area, square(normal));
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k)
            coordinate = std::max(coordinate, std::abs(p[i][k]));
    length = std::sqrt(length);
    const double least = std::max(flat * length, 4 * eps * coordinate) * std::sqrt(area);
    const Determinant det(a, b, c);
    // Written so that what is no number is in doubt.
    if (!(std::abs(det.value) > (1 + 8 * eps) * (least + det.bound) && length * largest >= 1))
        return 0;
    return det.value > 0 ? 1 : -1;
}

} // namespace

std::vector<std::int8_t> orientations(const double *points, const std::int64_t *corners,
                                      std::int64_t tets, double flat, double largest, Team &team) {
    std::vector<std::int8_t> found(static_cast<std::size_t>(tets));
    in_turn(team, found.size(), [&](std::size_t t) {
        const double *p[4];
        for (std::size_t k = 0; k < 4; ++k)
            p[k] = points + 3 * corners[4 * t + k];
        found[t] = orientation(p, flat, largest);
    });
    return found;
}

} // namespace bezsoma
