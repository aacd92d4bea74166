// SPDX-License-Identifier: BSD-3-Clause
// The diagonal block of an entity with vertices S couples controls a, b whose indices live on S:
//
//   K_ab = sum_(i,j in S) c_ab,ij Q_ij,   c_ab,ij = (1/V) int B^(n-1)_(a-e_i) B^(n-1)_(b-e_j)
//   Q_ij = n^2 sum_tets V (lambda g_i g_j^T + mu g_j g_i^T + mu g_i.g_j I)
//
// so tets are summed once in the few 3x3 matrices Q, and c depends on the degree alone.
#include "entity_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tet_controls.hpp"
#include "vertex_reach.hpp"

namespace bezsoma {

namespace {

using Index = std::array<int, 4>;

/// The indices inside a simplex of that dimension, all entries positive, in the order of controls.
std::vector<Index> indices_inside(int degree, int dim) {
    std::vector<Index> found;
    for (int s3 = degree; s3 >= 0; --s3) // s3 is the first entry: descending lexicographic
        for (int s2 = degree - s3; s2 >= 0; --s2)
            for (int s1 = degree - s3 - s2; s1 >= 0; --s1) {
                const Index a{s3, s2, s1, degree - s3 - s2 - s1};
                const auto positive = std::ranges::count_if(a, [](int x) { return x > 0; });
                const bool leading =
                    std::all_of(a.begin(), a.begin() + dim + 1, [](int x) { return x > 0; });
                if (leading && positive == dim + 1)
                    found.push_back(a);
            }
    return found;
}

/// c_ab,ij for b <= a: (pairs, dim + 1, dim + 1).
std::vector<double> couplings(int degree, int dim) {
    const std::vector<Index> inside = indices_inside(degree, dim);
    const double scale =
        1.0 * combinations(2 * degree - 2, degree - 1) * combinations(2 * degree + 1, 3);
    std::vector<double> c;
    for (std::size_t a = 0; a < inside.size(); ++a)
        for (std::size_t b = 0; b <= a; ++b)
            for (int i = 0; i <= dim; ++i)
                for (int j = 0; j <= dim; ++j) {
                    Index x = inside[a], y = inside[b];
                    --x[size_of(i)];
                    --y[size_of(j)];
                    double product = 1 / scale;
                    for (std::size_t v = 0; v < 4; ++v)
                        product *= combinations(x[v] + y[v], x[v]);
                    c.push_back(product);
                }
    return c;
}

/// c_ij of the function of vertex 0: (1/V) int psi_i psi_j, where grad psi = n sum_i psi_i g_i.
std::array<double, 16> couplings_of_vertex(int degree) {
    const double scale =
        1.0 * combinations(2 * degree - 2, degree - 1) * combinations(2 * degree + 1, 3);
    const VertexReach reach = vertex_reach(degree);
    std::vector<std::pair<Index, double>> parts{{Index{degree}, 1.0}};
    for (int j = 1; j < degree; ++j)
        for (std::size_t k = 1; k < 4; ++k) {
            parts.emplace_back(Index{degree - j}, reach.of[j]);
            parts.back().first[k] = j;
        }
    std::array<double, 16> c{};
    for (const auto &[a, s] : parts)
        for (const auto &[b, t] : parts)
            for (int ij = 0; ij < 16; ++ij)
                c[size_of(ij)] +=
                    s * t * lowered_product(a.data(), ij / 4, b.data(), ij % 4) / scale;
    return c;
}

/// A symmetric matrix by its lower triangle.
struct Dense {
    std::size_t rows;
    double *a; // (rows, rows)
    double &operator()(std::size_t i, std::size_t j) { return a[i * rows + j]; }
};

/// Q_ij summed over the tets around an entity, ((dim + 1)^2, 9).
void sum_tets(const ElasticTets &tets, const Entities &entities, std::size_t e, double *q) {
    const int corners = entities.all[e].dim + 1;
    std::fill_n(q, 9 * corners * corners, 0.0);
    const double square = tets.degree * tets.degree;
    for (auto t = size_of(entities.start[e]); t < size_of(entities.start[e + 1]); ++t) {
        const std::int64_t tet = entities.around[t];
        const TetShape shape = tets.shape(tet);
        const double scale = square * shape.volume;
        const double lambda = scale * tets.lambda(tet);
        const double mu = scale * tets.mu(tet);
        const double *g[4];
        int n = 0;
        for (int v = 0; v < 4; ++v)
            if (entity_vertices[entities.local[t]] >> v & 1)
                g[n++] = shape.gradients[v];
        for (int i = 0; i < corners; ++i)
            for (int j = 0; j < corners; ++j) {
                double *to = q + 9 * (i * corners + j);
                const double dot = g[i][0] * g[j][0] + g[i][1] * g[j][1] + g[i][2] * g[j][2];
                for (int k = 0; k < 3; ++k)
                    for (int l = 0; l < 3; ++l)
                        to[3 * k + l] += lambda * g[i][k] * g[j][l] + mu * g[j][k] * g[i][l] +
                                         (k == l ? mu * dot : 0.0);
            }
    }
}

void fill(Dense &block, const std::vector<double> &c, const double *q, int corners) {
    const double *next = c.data();
    for (std::size_t a = 0; 3 * a < block.rows; ++a)
        for (std::size_t b = 0; b <= a; ++b, next += corners * corners) {
            double sum[9] = {};
            for (int ij = 0; ij < corners * corners; ++ij)
                for (int k = 0; k < 9; ++k)
                    sum[k] += next[ij] * q[9 * ij + k];
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t l = 0; l < 3; ++l)
                    block(3 * a + k, 3 * b + l) = sum[3 * k + l];
        }
}

/// The identity in the rows and columns of what is prescribed.
void take_out(Dense &block, const std::uint8_t *fixed) {
    for (std::size_t i = 0; i < block.rows; ++i)
        for (std::size_t j = 0; j <= i; ++j)
            if (fixed[i] || fixed[j])
                block(i, j) = i == j ? 1.0 : 0.0;
}

/// The lower triangle of the inverse, in place: A = L L^T, then L^-1, then L^-T L^-1.
void invert(Dense &a) {
    const std::size_t n = a.rows;
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t k = 0; k < j; ++k)
            a(j, j) -= a(j, k) * a(j, k);
        a(j, j) = std::sqrt(a(j, j));
        for (std::size_t i = j + 1; i < n; ++i) {
            double s = a(i, j);
            for (std::size_t k = 0; k < j; ++k)
                s -= a(i, k) * a(j, k);
            a(i, j) = s / a(j, j);
        }
    }
    for (std::size_t j = 0; j < n; ++j) {
        a(j, j) = 1 / a(j, j);
        for (std::size_t i = j + 1; i < n; ++i) {
            double s = 0;
            for (std::size_t k = j; k < i; ++k)
                s -= a(i, k) * a(k, j);
            a(i, j) = s / a(i, i);
        }
    }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            double s = 0;
            for (std::size_t k = i; k < n; ++k)
                s += a(k, i) * a(k, j);
            a(i, j) = s;
        }
}

void pack(Dense &block, const std::uint8_t *fixed, float *to) {
    for (std::size_t i = 0; i < block.rows; ++i)
        for (std::size_t j = 0; j <= i; ++j)
            *to++ = fixed[i] || fixed[j] ? 0.0F : static_cast<float>(block(i, j));
}

} // namespace

EntityBlocks::EntityBlocks(const ElasticTets &tets, const Entities &entities)
    : tets_(tets), entities_(entities), of_vertex_{}, rows_{} {
    of_vertex_ = couplings_of_vertex(tets.degree);
    for (int dim = 0; dim < 4; ++dim) {
        couplings_[size_of(dim)] = couplings(tets.degree, dim);
        rows_[size_of(dim)] = 3 * indices_inside(tets.degree, dim).size();
    }
}

/// n^2 V sum_ij c_ij (lambda g_i g_j^T + mu g_j g_i^T + mu g_i.g_j I) of all tets at a vertex, (3,
/// 3).
void EntityBlocks::sum_around_vertex(std::size_t e, double *q) const {
    std::fill_n(q, 9, 0.0);
    for (auto t = size_of(entities_.start[e]); t < size_of(entities_.start[e + 1]); ++t) {
        const std::int64_t tet = entities_.around[t];
        TetShape shape = tets_.shape(tet);
        std::swap(shape.gradients[0], shape.gradients[entities_.local[t]]);
        double g[9] = {};
        for (std::size_t ij = 0; ij < 16; ++ij)
            for (std::size_t k = 0; k < 9; ++k)
                g[k] += of_vertex_[ij] * shape.gradients[ij / 4][k / 3] *
                        shape.gradients[ij % 4][k % 3];
        const double scale = tets_.degree * tets_.degree * shape.volume;
        const double lambda = scale * tets_.lambda(tet), mu = scale * tets_.mu(tet);
        for (std::size_t k = 0; k < 9; ++k)
            q[k] += (lambda + mu) * g[k] + (k % 4 == 0 ? mu * (g[0] + g[4] + g[8]) : 0.0);
    }
}

void EntityBlocks::inverse(std::size_t e, const std::uint8_t *fixed, std::vector<double> &scratch,
                           float *packed) const {
    const Entity &entity = entities_.all[e];
    const std::size_t n = rows(entity.dim);
    if (scratch.size() < n * n)
        scratch.resize(n * n);
    double q[16 * 9];
    Dense block{n, scratch.data()};
    if (entity.dim == 0) {
        sum_around_vertex(e, q);
        std::copy_n(q, 9, block.a);
    } else {
        sum_tets(tets_, entities_, e, q);
        fill(block, couplings_[size_of(entity.dim)], q, entity.dim + 1);
    }
    const std::uint8_t *own = fixed + 3 * size_of(entity.control);
    take_out(block, own);
    invert(block);
    pack(block, own, packed);
}

} // namespace bezsoma
