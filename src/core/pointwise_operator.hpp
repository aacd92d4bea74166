// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "elastic_operator.hpp"
#include "law.hpp"

namespace bezsoma {

/// Forces, tangents and energy of laws, one a region, by quadrature without a matrix.
///
/// Per tet it keeps 10 numbers of geometry, where its controls lie and its number; nothing a point.
/// Batches have tets of one region: within a chunk the tets are taken region by region.
class PointwiseOperator {
public:
    /// values (points, controls of degree - 1), weights (points,).
    PointwiseOperator(const ElasticTets &tets, std::vector<Law> laws, const double *values,
                      const double *weights, std::int32_t points, const Kernels &kernels,
                      Team &team);

    /// f = forces at u, both (controls, 3).
    void forces(const double *u, double *f);
    /// df = the change of the forces at u for a change du.
    void tangent(const double *u, const double *du, double *df);
    double energy(const double *u);

    std::int64_t controls() const { return chunks_.controls; }
    bool has_energy() const;

    /// What the laws have seen in the last forces or energy; place is the number of a tet.
    const Extremes &seen() const { return seen_; }

private:
    struct Group { // batches of one region
        std::int64_t batch, batches;
        std::int32_t region;
    };
    using Work = double (*)(const PointwiseKernel<double> &, const PointwiseBatches<double> &);

    void group(const ElasticTets &tets);
    void pack(const ElasticTets &tets);
    double on_chunk(std::size_t chunk, const double *u, const double *du, double *f, Work work,
                    std::vector<double> &scratch);
    double run(const double *u, const double *du, double *f, Work work);
    double *take_over(const Chunk &chunk, const double *u, double *to) const;
    void add_foreign(std::size_t chunk, double *f) const;
    void take_seen();

    PointwiseKernel<double> kernel_;
    const LawKernel<double> *law_kernels_;
    std::int64_t lanes_;
    Team &team_;
    std::vector<Law> laws_;
    Rule<double> rule_;
    std::vector<double> values_, tests_, weights_;
    Chunks chunks_;
    std::vector<Group> groups_;
    std::vector<std::size_t> group_;     // (chunks + 1,) the first group of each chunk
    std::vector<std::int32_t> first_;    // (batches, entities, lanes)
    std::vector<double> geometry_;       // (batches, 10, lanes)
    std::vector<std::int32_t> tet_;      // (batches, lanes) of the mesh; -1: none
    std::vector<double> foreign_, sums_; // (foreign controls, 3), (chunks,)
    std::vector<Extremes> extremes_;     // (chunks,)
    Extremes seen_;
    std::vector<std::vector<double>> scratch_; // a thread each
};

} // namespace bezsoma
