// SPDX-License-Identifier: BSD-3-Clause
// The entity blocks of the preconditioner, one entity a lane: included after elastic_kernel.hpp.
#pragma once

#include "vertex_reach.hpp"

namespace bezsoma::BEZSOMA_ISA {

/// The weights with which the controls inside an entity follow its vertices, (controls inside, 4):
/// a_i / n where a linear function is elevated to degree n, and those of the vertices' own
/// functions, which reach as far as the edges.
template <int n, int dim> struct VertexWeights {
    float of[inside(n, dim) == 0 ? 1 : inside(n, dim)][4] = {};
    float reaching[inside(n, dim) == 0 ? 1 : inside(n, dim)][4] = {};
    constexpr VertexWeights() {
        const VertexReach reach = vertex_reach(n);
        int next = 0;
        for (int a0 = n; a0 >= 1; --a0)
            for (int a1 = n - a0; a1 >= 0; --a1)
                for (int a2 = n - a0 - a1; a2 >= 0; --a2) {
                    const int a[4] = {a0, a1, a2, n - a0 - a1 - a2};
                    bool own = true;
                    for (int v = 0; v < 4; ++v)
                        own = own && (a[v] > 0) == (v <= dim);
                    if (own) {
                        for (int v = 0; v < 4; ++v) {
                            of[next][v] = static_cast<float>(a[v]) / n;
                            if (dim < 2)
                                reaching[next][v] = static_cast<float>(reach.of[n - a[v]]);
                        }
                        ++next;
                    }
                }
    }
};

template <int n, int dim> inline constexpr VertexWeights<n, dim> vertex_weights{};

/// Calls f(first row, rows) for pieces of at most `lanes` rows.
template <int all, int lanes, int begin = 0, class F> BEZSOMA_INLINE void each_piece(F &&f) {
    constexpr int rows = all - begin < lanes ? all - begin : lanes;
    f.template operator()<begin, rows>();
    if constexpr (begin + rows < all)
        each_piece<all, lanes, begin + rows>(f);
}

/// x[row][lane] = from[3 control[lane] + row]; may read past a run, so vectors are padded.
template <int rows, int lanes>
BEZSOMA_INLINE void rows_of_runs(const double *from, const std::int32_t *control,
                                 Lanes<double, lanes> *x) {
    each_piece<rows, lanes>([&]<int begin, int piece>() BEZSOMA_INLINED {
        Lanes<double, lanes> block[lanes];
#pragma GCC unroll 16
        for (int l = 0; l < lanes; ++l)
            block[l] = load<double, lanes>(from + 3 * std::int64_t{control[l]} + begin);
        transpose<double, lanes>(block);
#pragma GCC unroll 16
        for (int r = 0; r < piece; ++r)
            x[begin + r] = block[r];
    });
}

template <int n, int dim, int lanes>
double forward(const BlockBatches &b, const double *r, double scale) {
    using F = Lanes<float, lanes>;
    constexpr int own = inside(n, dim), rows = 3 * own;
    Lanes<double, lanes> dot = {};
    for (std::int64_t i = 0; i < b.count; ++i) {
        Lanes<double, lanes> wide[rows];
        F x[rows], y[rows], moments[moments_of(dim)] = {};
        rows_of_runs<rows, lanes>(r, b.control + i * lanes, wide);
        for (int row = 0; row < rows; ++row) {
            wide[row] *= scale;
            x[row] = __builtin_convertvector(wide[row], F);
            y[row] = F{};
        }
        if constexpr (dim > 0) {
            const float *value = b.value + i * (rows * (rows + 1) / 2) * lanes;
            for (int row = 0; row < rows; ++row) {
                F sum = {};
                for (int column = 0; column < row; ++column, value += lanes) {
                    const F entry = load<float, lanes>(value);
                    sum += entry * x[column];
                    y[column] += entry * x[row];
                }
                y[row] += sum + load<float, lanes>(value) * x[row];
                value += lanes;
            }
            for (int row = 0; row < rows; ++row) {
                store<float, lanes>(b.z + (i * rows + row) * lanes, y[row]);
                dot += wide[row] * __builtin_convertvector(y[row], Lanes<double, lanes>);
            }
        }
        for (int a = 0; a < own; ++a)
            for (int v = 0; v <= dim; ++v)
                for (int k = 0; k < 3; ++k) {
                    moments[3 * v + k] += vertex_weights<n, dim>.of[a][v] * x[3 * a + k];
                    if constexpr (dim == 1)
                        moments[3 * (2 + v) + k] +=
                            vertex_weights<n, dim>.reaching[a][v] * x[3 * a + k];
                }
        for (int m = 0; m < moments_of(dim); ++m)
            store<float, lanes>(b.moments + (i * moments_of(dim) + m) * lanes, moments[m]);
    }
    double sum = 0;
    for (int l = 0; l < lanes; ++l)
        sum += dot[l];
    return sum;
}

template <int n, int dim, int lanes>
void back(const BlockBatches &b, std::int64_t entities, const float *coarse, double scale,
          double beta, double *p) {
    using F = Lanes<float, lanes>;
    constexpr int own = inside(n, dim), rows = 3 * own;
    for (std::int64_t i = 0; i < b.count; ++i) {
        constexpr int taken = dim < 2 ? 6 : 3; // the vertices' own functions reach no farther
        F corner[taken * (dim + 1)] = {};
        for (int v = 0; v <= dim; ++v)
            for (int l = 0; l < lanes; ++l) {
                const float *from =
                    coarse + 6 * std::int64_t{b.vertices[(i * (dim + 1) + v) * lanes + l]};
                for (int k = 0; k < taken; ++k)
                    corner[taken * v + k][l] = from[k];
            }
        Lanes<double, lanes> step[rows];
        for (int a = 0; a < own; ++a)
            for (int k = 0; k < 3; ++k) {
                F z = {};
                if constexpr (dim > 0)
                    z = load<float, lanes>(b.z + (i * rows + 3 * a + k) * lanes);
                for (int v = 0; v <= dim; ++v) {
                    z += vertex_weights<n, dim>.of[a][v] * corner[taken * v + k];
                    if constexpr (dim < 2)
                        z += vertex_weights<n, dim>.reaching[a][v] * corner[taken * v + 3 + k];
                }
                step[3 * a + k] = scale * __builtin_convertvector(z, Lanes<double, lanes>);
            }
        // p is read number by number: what lies past a run may be another thread's to write.
        const std::int64_t left = entities - i * lanes;
        for (int l = 0; l < (left < lanes ? left : lanes); ++l) {
            double *to = p + 3 * std::int64_t{b.control[i * lanes + l]};
            for (int row = 0; row < rows; ++row)
                to[row] = beta * to[row] + step[row][l];
        }
    }
}

} // namespace bezsoma::BEZSOMA_ISA
