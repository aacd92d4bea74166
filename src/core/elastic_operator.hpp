// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "chunks.hpp"
#include "kernels.hpp"
#include "team.hpp"

namespace bezsoma {

/// grad L_i and the volume of a tet.
struct TetShape {
    double gradients[4][3]; // 1/mm
    double volume;          // mm3
};

/// What an operator is made from: the tets of a mesh, and the walk over them that numbered the
/// controls. Tet i of the walk is tet order[i] of the mesh. Shapes are formed where they are
/// needed: kept, they would be the largest part of a problem of low degree.
struct ElasticTets {
    int degree;
    std::int64_t tets;
    const std::int32_t *first;         // (tets, entities) first control of each entity, by the walk
    const std::int64_t *order;         // (tets,)
    const double *points;              // (points, 3) mm
    const std::int64_t *corners;       // (tets, 4) of the mesh, ascending
    const std::int64_t *region_of_tet; // (tets,)
    const double *lame;                // (regions, 2) lambda, mu in MPa
    std::int32_t regions;

    // Of tet i of the walk:
    TetShape shape(std::int64_t i) const;
    std::int32_t region(std::int64_t i) const {
        return static_cast<std::int32_t>(region_of_tet[order[i]]);
    }
    double lambda(std::int64_t i) const { return lame[2 * region(i)]; }
    double mu(std::int64_t i) const { return lame[2 * region(i) + 1]; }
};

/// The controls that a chunk of the walk should have.
std::int64_t controls_of_chunk(const ElasticTets &tets);

/// K u without a matrix, in float64 or float32, on one or several right-hand sides.
///
/// Per tet it keeps 9 numbers of geometry, 4 to 15 of where its controls lie and its region; at
/// degree 1 the points in place of the geometry (`forms_shapes`).
template <class T> class ElasticOperator {
public:
    ElasticOperator(const ElasticTets &tets, const Kernels &kernels, Team &team);

    /// f = K u, both (controls, 3, sides).
    void apply(const T *u, T *f, int sides = 1);

    /// int tau(u) : eps(u), N mm: twice the stored energy.
    double work(const T *u);

    std::int64_t controls() const { return chunks_.controls; }
    int lanes() const { return lanes_; }
    const Chunks &chunks() const { return chunks_; }

private:
    void pack(const ElasticTets &tets);
    void keep_shape(const TetShape &shape, T *geometry) const;
    void keep_points(const ElasticTets &tets, const Chunk &chunk, std::int64_t tet);
    Batches<T> batches(std::size_t chunk) const;
    bool may_read_past(const Chunk &chunk) const;
    bool works_in_area() const { return kernel_.row == row_of_area; }
    Batches<T> with_area(std::size_t chunk, const T *u, int sides, std::vector<T> &scratch) const;
    void forces_of_chunk(std::size_t chunk, const T *u, T *f, T *f_foreign, int sides, bool alone,
                         std::vector<T> &scratch);
    void forces_beside(std::size_t chunk, const T *u, T *f, T *f_foreign, int sides, bool alone,
                       std::vector<T> &scratch);
    void forces_of_side(std::size_t chunk, const T *u, T *f, T *f_foreign, int sides, bool alone,
                        std::vector<T> &scratch);
    void forces_in_area(std::size_t chunk, const T *u, T *f, T *f_foreign, int sides, bool alone,
                        std::vector<T> &scratch);

    Kernel<T> kernel_;
    int lanes_;
    Team &team_;
    Chunks chunks_;
    std::vector<std::int64_t> batch_;     // (chunks + 1,) the first batch of each chunk
    std::vector<std::int32_t> first_;     // (batches, entities, lanes)
    std::vector<std::int32_t> region_;    // (batches, lanes)
    std::vector<std::int32_t> met_;       // (batches,) own controls met until the end of each
    std::vector<T> geometry_;             // (batches, 9, lanes), or none
    std::vector<T> points_;               // of each chunk foreign, own (controls, 3), or none
    std::vector<T> lame_;                 // (regions + 1, 2), the last row zero
    std::vector<T> foreign_;              // (foreign controls, 3, sides) of all chunks, or of one,
                                          // from a line of the cache on
    std::vector<std::vector<T>> scratch_; // a thread each
};

} // namespace bezsoma
