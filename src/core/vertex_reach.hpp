// SPDX-License-Identifier: BSD-3-Clause
// How far the functions of vertices reach.
//
// The Bernstein polynomial of a vertex, L_0^n, falls off steeply, and costs much energy that a
// smoother function with the same value at the vertex would not. The blocks of vertices therefore
// belong to functions that reach along the edges,
//
//   psi = B_(n e_0) + sum_(j = 1 to n-1) c_j sum_(k = 1 to 3) B_((n-j) e_0 + j e_k),
//
// with the c_j that make int |grad psi|^2 least on a regular tet. They are the same numbers for
// all tets, so neighbours agree along an edge. The low-energy basis of S. J. Sherwin and M.
// Casarin, J. Comput. Phys. 171 (2001) 394-417, in its smallest form.
#pragma once

#include "tet_controls.hpp"

namespace bezsoma {

/// What an entity hands to its vertices: moments with a linear function, three for each vertex, and
/// those of an edge with their own functions; a vertex' own are both.
static constexpr int moments_of(int dim) { return dim == 1 ? 12 : 3 * (dim + 1); }

/// c_j by the distance j from the vertex: c_0 = 1 at the vertex itself, c_n = 0 at the other end.
struct VertexReach {
    double of[11];
};

/// A number times int B_(a - e_i) B_(b - e_j); zero where an index would be negative.
static constexpr double lowered_product(const int *a, int i, const int *b, int j) {
    if (a[i] == 0 || b[j] == 0)
        return 0;
    double product = 1;
    for (int v = 0; v < 4; ++v) {
        const int x = a[v] - (v == i), y = b[v] - (v == j);
        product *= combinations(x + y, x);
    }
    return product;
}

/// A number times int grad of the sums over edges at distances j and k, on a regular tet, where
/// g_i . g_l is -1/3 of g_i . g_i.
static constexpr double reach_coupling(int n, int j, int k) {
    double sum = 0;
    for (int e = 1; e < (j == 0 ? 2 : 4); ++e)
        for (int f = 1; f < (k == 0 ? 2 : 4); ++f) {
            int a[4] = {n - j, 0, 0, 0}, b[4] = {n - k, 0, 0, 0};
            a[e] += j;
            b[f] += k;
            for (int i = 0; i < 4; ++i)
                for (int l = 0; l < 4; ++l)
                    sum += (i == l ? 3 : -1) * lowered_product(a, i, b, l);
        }
    return sum;
}

/// Elimination without pivots, as the couplings are positive definite.
static constexpr VertexReach vertex_reach(int n) {
    double a[11][11] = {};
    VertexReach c{{1}};
    for (int j = 1; j < n; ++j) {
        for (int k = 1; k < n; ++k)
            a[j][k] = reach_coupling(n, j, k);
        c.of[j] = -reach_coupling(n, j, 0);
    }
    for (int p = 1; p < n; ++p)
        for (int j = p + 1; j < n; ++j) {
            const double factor = a[j][p] / a[p][p];
            for (int k = p; k < n; ++k)
                a[j][k] -= factor * a[p][k];
            c.of[j] -= factor * c.of[p];
        }
    for (int j = n - 1; j > 0; --j) {
        for (int k = j + 1; k < n; ++k)
            c.of[j] -= a[j][k] * c.of[k];
        c.of[j] /= a[j][j];
    }
    return c;
}

} // namespace bezsoma
