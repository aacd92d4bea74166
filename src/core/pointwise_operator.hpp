// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <vector>

#include "chunked_field.hpp"
#include "elastic_operator.hpp"
#include "law.hpp"
#include "rule.hpp"

namespace bezsoma {

/// A quadrature rule and the polynomials of degree - 1 at its points: see RuleTables.
struct GivenRule {
    std::int32_t count;
    const double *points, *weights, *values;
};

/// The numbering of a pressure by the walk of the displacement.
struct PressureNet {
    int degree;
    const std::int32_t *first; // (tets, entities of that degree)
};

/// Forces, tangents and energy of laws, one a region, by quadrature without a matrix; with a
/// pressure net in the mixed form. In float32 the tangent of the displacement form alone.
///
/// Per tet it keeps 10 numbers of geometry, where its controls lie and its number; nothing a point.
/// Batches have tets of one region: within a chunk the tets are taken region by region.
template <class T> class PointwiseOperator {
public:
    PointwiseOperator(const ElasticTets &tets, std::optional<PressureNet> pressure,
                      std::vector<Law> laws, const GivenRule &rule, const Kernels &kernels,
                      Team &team);

    /// A displacement (controls, 3) and its pressure (pressures,), null in the displacement form.
    struct Fields {
        const T *u, *p;
    };
    struct Forces {
        T *f, *g;
    };

    void forces(const Fields &at, const Forces &found)
        requires std::same_as<T, double>;
    /// The change of the forces at a state for a change of it.
    void tangent(const Fields &at, const Fields &change, const Forces &found);
    double energy(const Fields &at)
        requires std::same_as<T, double>;

    std::int64_t controls() const { return u_.controls(); }
    std::int64_t pressures() const { return p_ ? p_->controls() : 0; }
    const std::vector<Law> &laws() const { return laws_; }

    /// What the laws have seen in the last forces or energy; place is the number of a tet, point
    /// that of the rule as given.
    const Extremes &seen() const { return seen_; }
    std::size_t bytes() const;

private:
    struct Group { // batches of one region
        std::int64_t batch, batches;
        std::int32_t region;
    };
    struct Work {
        OnBatches<T> kernel;
        Fields at, change;
        Forces found;
    };

    void group(const ElasticTets &tets);
    void pack(const ElasticTets &tets);
    double run(const Work &work);
    double on_chunk(std::size_t chunk, const Work &work, std::vector<T> &scratch);
    PointwiseBatches<T> batches(const Group &group) const;
    void take_seen();

    const PointwiseKernels &kernels_;
    const NetKernel<T> *net_;
    const LawKernel<T> *law_kernels_;
    std::int64_t lanes_;
    Team &team_;
    std::vector<Law> laws_;
    std::vector<std::vector<T>> parameters_;
    RuleTables<T> rule_;
    ChunkedField<T> u_;
    std::optional<ChunkedField<T>> p_;
    std::vector<Group> groups_;
    std::vector<std::size_t> group_;                   // (chunks + 1,) the first of each chunk
    std::vector<std::int32_t> first_, first_pressure_; // (batches, entities, lanes)
    std::vector<T> geometry_;                          // (batches, 10, lanes)
    std::vector<std::int32_t> tet_;                    // (batches, lanes) of the mesh
    std::vector<double> sums_;                         // (chunks,)
    std::vector<Extremes> extremes_;                   // (chunks,)
    Extremes seen_;
    std::vector<std::vector<T>> scratch_; // a thread each
};

} // namespace bezsoma
