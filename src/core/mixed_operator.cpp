// SPDX-License-Identifier: BSD-3-Clause
#include "mixed_operator.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "large.hpp"

namespace bezsoma {

namespace {

Chunks chunks_of_displacement(const ElasticTets &tets, Team &team) {
    return chunks(tets.degree, tets.first, tets.tets, controls_of_chunk(tets), team);
}

} // namespace

MixedOperator::MixedOperator(const MixedTets &tets, const Kernels &kernels, Team &team)
    : kernel_(kernels.mixed->form[tets.displacement.degree - 1]),
      pressure_(kernels.mixed->pressure[tets.pressure_degree - 1]), team_(team),
      pressure_degree_(tets.pressure_degree),
      u_(chunks_of_displacement(tets.displacement, team), 3),
      p_(bezsoma::chunks(tets.pressure_degree, tets.first_pressure, cuts(u_.chunks()), team), 1),
      lanes_(u_.chunks(), kernels.lanes64), first_(lanes_.runs(u_.chunks(), 3)),
      first_pressure_(lanes_.runs(p_.chunks(), 1)),
      moduli_(tets.displacement.lame, tets.displacement.lame + 2 * tets.displacement.regions),
      scratch_(team.size()) {
    u_.forget_local();
    p_.forget_local();
    pack(tets.displacement);
}

/// Lanes without a tet keep geometry zero: they read control 0 and add nothing.
void MixedOperator::pack(const ElasticTets &tets) {
    const std::int64_t lanes = lanes_.lanes();
    region_.resize(size_of(lanes_.batches() * lanes));
    make_large(geometry_, size_of(lanes_.batches() * 9 * lanes), team_);
    team_.run(u_.parts(), [&](std::size_t part, std::size_t) {
        lanes_.each(u_.chunks(), part,
                    [&](std::int64_t tet, std::int64_t batch, std::int64_t lane) {
                        const TetShape shape = tets.shape(tet);
                        const double root = std::sqrt(shape.volume);
                        for (std::int64_t k = 0; k < 9; ++k)
                            geometry_[size_of((batch * 9 + k) * lanes + lane)] =
                                root * shape.gradients[1 + k / 3][k % 3];
                        region_[size_of(batch * lanes + lane)] = tets.region(tet);
                    });
    });
}

double *MixedOperator::scratch(std::size_t thread) {
    auto &mine = scratch_[thread];
    mine.resize(2 * (u_.longest() + p_.longest()));
    return mine.data();
}

MixedBatches MixedOperator::batches(std::size_t part) const {
    const std::int64_t b = lanes_.first(part), lanes = lanes_.lanes();
    return {lanes_.count(part),
            pressure_degree_,
            first_.data() + b * entities_of_tet(u_.chunks().degree) * lanes,
            first_pressure_.data() + b * entities_of_tet(pressure_degree_) * lanes,
            geometry_.data() + b * 9 * lanes,
            region_.data() + b * lanes,
            moduli_.data(),
            nullptr,
            nullptr,
            nullptr,
            nullptr};
}

void MixedOperator::apply(const double *u, const double *p, double *f, double *g) {
    team_.run(u_.parts(), [&](std::size_t part, std::size_t thread) {
        double *own_u = scratch(thread), *own_f = own_u + u_.longest();
        double *own_p = own_f + u_.longest(), *own_g = own_p + p_.longest();
        u_.read(part, u, own_u);
        p_.read(part, p, own_p);
        std::fill(own_f, own_p, 0.0);
        std::fill_n(own_g, p_.longest(), 0.0);
        MixedBatches b = batches(part);
        b.u = own_u;
        b.p = own_p;
        b.f = own_f;
        b.g = own_g;
        kernel_.apply(b);
        u_.write(part, own_f, f);
        p_.write(part, own_g, g);
    });
    team_.run(u_.parts(), [&](std::size_t part, std::size_t) {
        u_.add_foreign(part, f);
        p_.add_foreign(part, g);
    });
}

double MixedOperator::work(const double *u, const double *p) {
    std::vector<double> sums(u_.parts());
    team_.run(sums.size(), [&](std::size_t part, std::size_t thread) {
        double *own_u = scratch(thread), *own_p = own_u + u_.longest();
        u_.read(part, u, own_u);
        p_.read(part, p, own_p);
        MixedBatches b = batches(part);
        b.u = own_u;
        b.p = own_p;
        sums[part] = kernel_.work(b);
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

void MixedOperator::couple(const double *p, double *f) {
    team_.run(u_.parts(), [&](std::size_t part, std::size_t thread) {
        double *own_f = scratch(thread), *own_p = own_f + u_.longest();
        p_.read(part, p, own_p);
        std::fill(own_f, own_p, 0.0);
        MixedBatches b = batches(part);
        b.p = own_p;
        b.f = own_f;
        kernel_.couple(b);
        u_.write(part, own_f, f);
    });
    team_.run(u_.parts(), [&](std::size_t part, std::size_t) { u_.add_foreign(part, f); });
}

void MixedOperator::on_pressure(OnPressure what, const std::vector<double> &weight, const double *p,
                                double *g) {
    std::vector<double> moduli(2 * weight.size());
    for (std::size_t r = 0; r < weight.size(); ++r)
        moduli[2 * r] = weight[r];
    team_.run(p_.parts(), [&](std::size_t part, std::size_t thread) {
        double *own_p = scratch(thread), *own_g = own_p + p_.longest();
        if (p)
            p_.read(part, p, own_p);
        std::fill_n(own_g, p_.longest(), 0.0);
        MixedBatches b = batches(part);
        b.moduli = moduli.data();
        b.p = own_p;
        b.g = own_g;
        (pressure_.*what)(b);
        p_.write(part, own_g, g);
    });
    team_.run(p_.parts(), [&](std::size_t part, std::size_t) { p_.add_foreign(part, g); });
}

std::size_t MixedOperator::bytes() const {
    return 4 * (first_.size() + first_pressure_.size() + region_.size()) + 8 * geometry_.size();
}

} // namespace bezsoma
