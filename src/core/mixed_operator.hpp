// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "chunked_field.hpp"
#include "elastic_operator.hpp"
#include "mixed_kernels.hpp"

namespace bezsoma {

/// The tets and their two numberings; `lame` of `displacement` holds G and 1/kappa by region.
struct MixedTets {
    ElasticTets displacement;
    int pressure_degree;
    const std::int32_t *first_pressure; // (tets, entities of that degree), by the same walk
};

/// The displacement-pressure form without a matrix, in float64:
///
///   f = int 2 G eps'(u) : eps'(v) - p div v,   g = - int q (div u + p / kappa)
///
/// In one pass over the tets; the same bits for any number of threads.
class MixedOperator {
public:
    MixedOperator(const MixedTets &tets, const Kernels &kernels, Team &team);

    /// u, f (controls, 3); p, g (pressures,).
    void apply(const double *u, const double *p, double *f, double *g);

    /// int 2 G eps' : eps' + p^2 / kappa, N mm: twice the stored energy.
    double work(const double *u, const double *p);

    /// g = int weight p q, by regions.
    void mass(const std::vector<double> &weight, const double *p, double *g);

    std::int64_t controls() const { return u_.controls(); }
    std::int64_t pressures() const { return p_.controls(); }
    std::int64_t regions() const { return static_cast<std::int64_t>(moduli_.size()) / 2; }
    const Chunks &chunks() const { return u_.chunks(); }
    std::size_t bytes() const;

private:
    void pack(const ElasticTets &tets);
    MixedBatches batches(std::size_t part) const;
    double *scratch(std::size_t thread);

    const MixedKernel kernel_;
    void (*const mass_)(const MixedBatches &);
    Team &team_;
    int pressure_degree_;
    ChunkedField<double> u_, p_;
    LanesOfTets lanes_;
    std::vector<std::int32_t> first_, first_pressure_; // (batches, entities, lanes)
    std::vector<std::int32_t> region_;                 // (batches, lanes)
    std::vector<double> geometry_;                     // (batches, 9, lanes)
    std::vector<double> moduli_;                       // (regions, 2)
    std::vector<std::vector<double>> scratch_;         // a thread each: u, f, p, g of a chunk
};

} // namespace bezsoma
