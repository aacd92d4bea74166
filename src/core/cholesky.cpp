// SPDX-License-Identifier: BSD-3-Clause
#include "cholesky.hpp"

#include <algorithm>
#include <cmath>

namespace bezsoma {

namespace {

/// Block (i, k) of A as the factorisation sees it: identity in held rows and columns, shifted.
Block seen(const double *block, const bool *held_i, const bool *held_k, bool diagonal,
           double shift) {
    Block out{};
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
            out[3 * r + c] = held_i[r] || held_k[c] ? 0.0 : block[3 * r + c];
    if (diagonal)
        for (std::size_t r = 0; r < 3; ++r)
            out[4 * r] = held_i[r] ? 1.0 : out[4 * r] * (1 + shift);
    return out;
}

/// a -= x y^T.
void subtract_product(Block &a, const double *x, const double *y) {
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
            a[3 * r + c] -=
                x[3 * r] * y[3 * c] + x[3 * r + 1] * y[3 * c + 1] + x[3 * r + 2] * y[3 * c + 2];
}

/// a <- a inverse^T, with a lower triangular inverse.
void divide(Block &a, const double *inverse) {
    for (std::size_t r = 0; r < 3; ++r) {
        double *row = a.data() + 3 * r;
        const double x = row[0], y = row[1], z = row[2];
        row[0] = x * inverse[0];
        row[1] = x * inverse[3] + y * inverse[4];
        row[2] = x * inverse[6] + y * inverse[7] + z * inverse[8];
    }
}

/// The inverse of the Cholesky factor of a 3x3 block; false where a pivot is not above `floor`.
bool invert_factor(const Block &a, const std::array<double, 3> &floor, double *inverse) {
    const double p0 = a[0];
    if (!(p0 > floor[0]))
        return false;
    const double l00 = std::sqrt(p0), l10 = a[3] / l00, l20 = a[6] / l00;
    const double p1 = a[4] - l10 * l10;
    if (!(p1 > floor[1]))
        return false;
    const double l11 = std::sqrt(p1), l21 = (a[7] - l20 * l10) / l11;
    const double p2 = a[8] - l20 * l20 - l21 * l21;
    if (!(p2 > floor[2]))
        return false;
    const double l22 = std::sqrt(p2);
    std::fill(inverse, inverse + 9, 0.0);
    inverse[0] = 1 / l00;
    inverse[4] = 1 / l11;
    inverse[8] = 1 / l22;
    inverse[3] = -l10 * inverse[0] / l11;
    inverse[7] = -l21 * inverse[4] / l22;
    inverse[6] = -(l20 * inverse[0] + l21 * inverse[3]) / l22;
    return true;
}

/// The blocks of A below the diagonal, copied; `diagonal` gets where each diagonal block stands.
Factor lower_part(const Rows &where, std::vector<std::int64_t> &diagonal) {
    Factor f;
    f.start.assign(where.rows + 1, 0);
    diagonal.assign(where.rows, 0);
    for (std::size_t i = 0; i < where.rows; ++i) {
        auto s = where.start[i];
        while (static_cast<std::size_t>(where.column[s]) < i)
            ++s;
        diagonal[i] = s;
        f.start[i + 1] = f.start[i] + s - where.start[i];
    }
    f.column.reserve(static_cast<std::size_t>(f.start.back()));
    for (std::size_t i = 0; i < where.rows; ++i)
        f.column.insert(f.column.end(), where.column + where.start[i], where.column + diagonal[i]);
    f.below.assign(9 * f.column.size(), 0.0);
    f.inverse.assign(9 * where.rows, 0.0);
    return f;
}

/// a -= sum_j L_ij L_kj^T over the j < k that rows i and k share; slot[j] is where row i holds j.
void subtract_shared(Block &a, const Factor &f, std::size_t k, std::int64_t row_start,
                     const std::vector<std::int64_t> &slot) {
    for (auto s = f.start[k]; s < f.start[k + 1]; ++s) {
        const auto mine = slot[static_cast<std::size_t>(f.column[static_cast<std::size_t>(s)])];
        if (mine >= row_start)
            subtract_product(a, f.below.data() + 9 * mine, f.below.data() + 9 * s);
    }
}

} // namespace

Factor incomplete_cholesky(const Rows &where, const double *blocks, const bool *held, double shift,
                           double least) {
    std::vector<std::int64_t> diagonal;
    Factor f = lower_part(where, diagonal);
    std::vector<std::int64_t> slot(where.rows, -1); // stale ones lie before the row's start
    for (std::size_t i = 0; i < where.rows; ++i) {
        const bool *held_i = held + 3 * i;
        const auto begin = f.start[i];
        Block pivot = seen(blocks + 9 * diagonal[i], held_i, held_i, true, shift);
        const std::array<double, 3> floor{least * pivot[0], least * pivot[4], least * pivot[8]};
        for (auto s = begin; s < f.start[i + 1]; ++s) {
            const auto k = static_cast<std::size_t>(f.column[static_cast<std::size_t>(s)]);
            Block a =
                seen(blocks + 9 * (where.start[i] + s - begin), held_i, held + 3 * k, false, shift);
            subtract_shared(a, f, k, begin, slot);
            divide(a, f.inverse.data() + 9 * k);
            std::copy(a.begin(), a.end(), f.below.begin() + 9 * s);
            subtract_product(pivot, a.data(), a.data());
            slot[k] = s;
        }
        if (!invert_factor(pivot, floor, f.inverse.data() + 9 * i)) {
            f.broken = static_cast<std::int64_t>(i);
            return f;
        }
    }
    return f;
}

void solve_cholesky(const FactorRows &factor, const double *r, double *z) {
    const Rows &where = factor.where;
    for (std::size_t i = 0; i < where.rows; ++i) {
        double x = r[3 * i], y = r[3 * i + 1], w = r[3 * i + 2];
        for (auto s = where.start[i]; s < where.start[i + 1]; ++s) {
            const double *b = factor.below + 9 * s;
            const double *v = z + 3 * static_cast<std::ptrdiff_t>(where.column[s]);
            x -= b[0] * v[0] + b[1] * v[1] + b[2] * v[2];
            y -= b[3] * v[0] + b[4] * v[1] + b[5] * v[2];
            w -= b[6] * v[0] + b[7] * v[1] + b[8] * v[2];
        }
        const double *d = factor.inverse + 9 * i;
        z[3 * i] = d[0] * x;
        z[3 * i + 1] = d[3] * x + d[4] * y;
        z[3 * i + 2] = d[6] * x + d[7] * y + d[8] * w;
    }
    for (std::size_t i = where.rows; i-- > 0;) {
        const double *d = factor.inverse + 9 * i;
        const double x = z[3 * i], y = z[3 * i + 1], w = z[3 * i + 2];
        const double p = d[0] * x + d[3] * y + d[6] * w, q = d[4] * y + d[7] * w, t = d[8] * w;
        z[3 * i] = p;
        z[3 * i + 1] = q;
        z[3 * i + 2] = t;
        for (auto s = where.start[i]; s < where.start[i + 1]; ++s) {
            const double *b = factor.below + 9 * s;
            double *v = z + 3 * static_cast<std::ptrdiff_t>(where.column[s]);
            v[0] -= b[0] * p + b[3] * q + b[6] * t;
            v[1] -= b[1] * p + b[4] * q + b[7] * t;
            v[2] -= b[2] * p + b[5] * q + b[8] * t;
        }
    }
}

} // namespace bezsoma
