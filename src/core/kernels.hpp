// SPDX-License-Identifier: BSD-3-Clause
// The kernels of one instruction set, as function pointers: what differs between processors.
#pragma once

#include <cstdint>

namespace bezsoma {

/// Tets of a batch of `Batches` stand so many from each other in the walk, as each lane walks on
/// from tet to tet through a stretch of that many batches (fewer at the end of a chunk). Neighbours
/// share controls, and of sums onto one control each waits for the one before.
constexpr std::int64_t apart = 4;

/// Numbers of a control in an area: three of displacement and three of force, each with a spare
/// one.
constexpr std::int64_t row_of_area = 8, forces_in_row = 4;

/// Tets of one chunk in batches of one per lane, and the vectors they work on.
///
/// first (batches, entities, lanes): where each entity's run begins, Kernel::row times its first
/// control, among the own ones of the chunk, or below zero, counted from the end of its foreign
/// ones; geometry (batches, 9, lanes): sqrt(V) grad L_i, i = 1..3; region (batches, lanes); lame
/// (regions, 2): lambda, mu.
/// u, f (own controls, 3), u_end, f_end the ends of the same of foreign controls. Past both parts
/// of u 16 numbers may be read but are not used. Own forces are cleared when a stretch first meets
/// them, met (batches,) being one past the own controls met so far; foreign ones are added to.
///
/// area (own controls, row_of_area), foreign ones before: what kernels with such rows have in place
/// of u_end and f_end, and where they leave forces. Own controls come into it from u when a stretch
/// first meets them, and f is only called for, where own forces will go.
template <class T> struct Batches {
    std::int64_t count;
    const std::int32_t *first;
    const T *geometry;
    const std::int32_t *region;
    const std::int32_t *met;
    const T *lame;
    const T *u, *u_end;
    T *f, *f_end;
    T *area;
};

/// A vertex, edge, face or interior with the run of controls inside it.
struct Entity {
    std::int32_t control; // the first of the run
    std::int32_t dim;
    std::int32_t vertices[4]; // dim + 1 controls of the degree-1 net, ascending vertices
};

/// Entities of one dimension in batches of one per lane, with the inverses of their blocks.
///
/// value (batches, rows (rows + 1) / 2, lanes): the lower triangles, row after row; z (batches,
/// rows, lanes) is written by `forward` and read by `back`. Vertices have neither: their blocks are
/// those of functions that reach along edges, put together from moments. moments (batches,
/// `moments_of(dim)`, lanes) are written by `forward`: three for each vertex of the entity, and on
/// edges three more for each, of its own function.
struct BlockBatches {
    std::int64_t count;           // batches
    const std::int32_t *control;  // (batches, lanes) the first control, counted from where r and p
                                  // begin; 0 for a lane without entity
    const std::int32_t *vertices; // (batches, dim + 1, lanes)
    const float *value;
    float *z;
    float *moments;
};

/// With w = a_i / n, what a linear function that is one at vertex i has at control a, and
/// psi = `VertexReach` of its distance from that vertex, the vertex' own function, on edges alone.
struct BlockKernel {
    /// z = B (scale r); moments of vertex i: sum_a w scale r_a, then sum_a psi scale r_a. Returns
    /// the sum of scale r . z, 0 for vertices.
    double (*forward)(const BlockBatches &, const double *r, double scale);
    /// p = beta p + scale (z + sum_i (w coarse_i0 + psi coarse_i1)) for the controls of `entities`
    /// lanes (the last batch may be part full); coarse (vertices, 2, 3).
    void (*back)(const BlockBatches &, std::int64_t entities, const float *coarse, double scale,
                 double beta, double *p);
};

/// Whether groups of right-hand sides are of eight.
constexpr bool by_eights(int lanes, int sides) {
    return lanes >= 8 && (sides % 8 == 0 || sides % 8 > 5);
}

/// How many of the first sides `Kernel::apply_many` works on: in groups of eight, or of four (two
/// where a register holds two). The last one may lack two of eight, or one of the four that a
/// register holds, and is quicker than its sides one by one.
constexpr int sides_beside(int lanes, int sides) {
    const int left = sides % (lanes < 4 ? lanes : 4);
    const bool nearly_whole = by_eights(lanes, sides) || (lanes == 4 && left == 3);
    return nearly_whole ? sides : sides - left;
}

/// What is done on batches. apply_many takes several right-hand sides beside each other, u and f
/// (controls, 3, sides): the first `sides_beside`, and leaves the forces of the others zero. Lanes
/// are sides there, and past each row of u 8 numbers may be read but are not used.
///
/// row: the numbers that `apply` and `work` take a control to have. 3; or row_of_area:
/// displacements and forces of a control beside each other, each with a spare number, so that whole
/// registers move and forces go to a line of the cache that displacements have brought.
template <class T> struct Kernel {
    int row;
    void (*apply)(const Batches<T> &);
    void (*apply_many)(const Batches<T> &, int sides);
    double (*work)(const Batches<T> &); // sum over tets of int tau : eps
};

struct PointwiseKernels;
struct MixedKernels;
struct RowKernels;

struct Kernels {
    const char *name;
    int lanes64, lanes32;
    Kernel<double> f64[10]; // by degree - 1
    Kernel<float> f32[10];
    BlockKernel blocks[10][4]; // by degree - 1 and dimension; empty where no control is inside
    const PointwiseKernels *pointwise;
    const MixedKernels *mixed;
    const RowKernels *rows;
};

/// The widest instruction set that this processor has; or the one named.
const Kernels &best_kernels();
const Kernels *kernels_named(const char *name);

} // namespace bezsoma
