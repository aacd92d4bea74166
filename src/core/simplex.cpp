// SPDX-License-Identifier: BSD-3-Clause
#include "simplex.hpp"

namespace bezsoma {

double binomial(int n, int k) {
    double c = 1;
    for (int i = 1; i <= k; ++i)
        c = c * (n - k + i) / i;
    return c;
}

std::size_t count(int degree) {
    const auto n = static_cast<std::size_t>(degree);
    return (n + 1) * (n + 2) * (n + 3) / 6;
}

std::vector<MultiIndex> multi_indices(int degree) {
    std::vector<MultiIndex> all;
    all.reserve(count(degree));
    for (int a = degree; a >= 0; --a)
        for (int b = degree - a; b >= 0; --b)
            for (int c = degree - a - b; c >= 0; --c)
                all.push_back({a, b, c, degree - a - b - c});
    return all;
}

std::size_t position(const MultiIndex &alpha) {
    const auto s1 = static_cast<std::size_t>(alpha[3]);
    const auto s2 = s1 + static_cast<std::size_t>(alpha[2]);
    const auto s3 = s2 + static_cast<std::size_t>(alpha[1]);
    return s3 * (s3 + 1) * (s3 + 2) / 6 + s2 * (s2 + 1) / 2 + s1;
}

std::vector<double> mass(int degree) {
    const auto all = multi_indices(degree);
    const double whole = binomial(2 * degree, degree) * binomial(2 * degree + 3, 3);
    std::vector<double> matrix;
    matrix.reserve(all.size() * all.size());
    for (const auto &a : all)
        for (const auto &b : all) {
            double ways = 1;
            for (std::size_t i = 0; i < 4; ++i)
                ways *= binomial(a[i] + b[i], a[i]);
            matrix.push_back(ways / whole);
        }
    return matrix;
}

} // namespace bezsoma
