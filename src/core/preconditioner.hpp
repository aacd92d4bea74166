// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "chunks.hpp"
#include "elastic_operator.hpp"
#include "entities.hpp"
#include "kernels.hpp"
#include "team.hpp"

namespace bezsoma {

/// z = about A^-1 r for the problem of degree 1 on the same vertices, both (vertices, 3).
using VertexSolver = std::function<void(const float *r, float *z)>;

/// z = sum over entities of the inverse of their block, plus the degree-1 problem: additive, so
/// that an iteration applies the operator once. The block of a vertex is that of a function which
/// reaches along the edges: see vertex_reach.hpp.
///
/// The degree-1 problem spans what is smooth, where the blocks are weak; the blocks span what is
/// rough within a tet. Works in float32 on the residual scaled to norm one.
class Preconditioner {
public:
    Preconditioner(const ElasticTets &tets, const std::int32_t *corners, std::int64_t vertices,
                   const std::uint8_t *fixed, const Chunks &chunks, const Kernels &kernels,
                   Team &team);

    /// The half that reads r: keeps z of the blocks, gives the forces of the degree-1 problem in
    /// `coarse` (vertices, 3) and returns r . z of the blocks. r is padded (see `padding`).
    double forward(const double *r, double norm, std::vector<float> &coarse);

    /// p = beta p + z, with z made of the blocks' and the degree-1 answer. p is padded likewise.
    void back(const std::vector<float> &coarse, double norm, double beta, double *p);

    /// The same halves of z = B r, r of norm one or so: chunks copy what they read and write, so
    /// that neither is padded, and either precision serves.
    template <class T> void read(const T *r, std::vector<float> &coarse);
    template <class T> void write(const std::vector<float> &coarse, T *z);

    std::size_t bytes() const;

private:
    /// The entities of one dimension in one chunk.
    struct Group {
        std::int64_t entities, batches;
        std::int64_t batch; // the first among all of that dimension
    };
    void arrange(const Entities &entities);
    void fill(const ElasticTets &tets, const Entities &entities, const std::uint8_t *fixed);
    void list_moments(std::int64_t vertices);
    double forward_of(std::size_t part, const double *own, double scale);
    void back_of(std::size_t part, double norm, double beta, double *own);
    double of_vertices(std::vector<float> &coarse);
    void keep(const std::vector<float> &coarse);
    double at_vertex(std::size_t vertex, float *coarse);
    /// Where the numbers of a chunk's own controls begin among all, and how many they are.
    std::size_t begin(std::size_t part) const {
        return 3 * static_cast<std::size_t>(control_of_[part]);
    }
    std::size_t length(std::size_t part) const { return begin(part + 1) - begin(part); }
    BlockBatches batches(std::size_t part, std::size_t dim);

    int lanes_;
    const BlockKernel *kernel_;
    Team &team_;
    std::vector<std::int64_t> control_of_; // (parts + 1,) the first own control of each chunk
    std::vector<std::int64_t> range_;      // (parts + 1,) the first entity of each chunk
    std::array<std::vector<Group>, 4> groups_;
    std::array<std::int64_t, 4> rows_;
    std::array<std::vector<std::int32_t>, 4> number_; // of the entity, -1 for a lane without one
    std::array<std::vector<std::int32_t>, 4> control_, vertices_; // control_ as its chunk counts
    std::array<std::vector<float>, 4> value_, z_;
    std::array<std::size_t, 4> moments_from_; // where those of a dimension begin
    std::vector<float> moments_;
    std::vector<std::int64_t> moment_start_; // (vertices + 1,)
    std::vector<std::uint32_t> moment_;      // where a vertex' moments stand
    std::vector<float> vertex_value_;        // (vertices, 6) the inverses of their blocks
    std::vector<float> vertex_z_;            // (vertices, 2, 3) of degree 1, of their own functions
    std::vector<double> dots_;               // a chunk each
    std::vector<double> vertex_dots_;        // a piece of vertices each
    std::vector<std::vector<double>> scratch_; // a thread each
};

} // namespace bezsoma
