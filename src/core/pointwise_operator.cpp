// SPDX-License-Identifier: BSD-3-Clause
#include "pointwise_operator.hpp"

#include <algorithm>
#include <numeric>

#include "large.hpp"
#include "tet_controls.hpp"

namespace bezsoma {

namespace {

/// The one for the precision.
template <class T> auto chosen(const auto &in_double, const auto &in_single) {
    if constexpr (sizeof(T) == 8)
        return in_double;
    else
        return in_single;
}

/// The more extreme of both; the first where they are equal.
void take(Extremes &all, const Extremes &here, std::int64_t before) {
    if (here.least_J.place >= 0 && !(here.least_J.value >= all.least_J.value)) {
        all.least_J = here.least_J;
        all.least_J.place += before;
    }
    if (here.greatest_exponent.place >= 0 &&
        !(here.greatest_exponent.value <= all.greatest_exponent.value)) {
        all.greatest_exponent = here.greatest_exponent;
        all.greatest_exponent.place += before;
    }
}

} // namespace

template <class T>
PointwiseOperator<T>::PointwiseOperator(const ElasticTets &tets,
                                        std::optional<PressureNet> pressure, std::vector<Law> laws,
                                        const GivenRule &rule, const Kernels &kernels, Team &team)
    : kernels_(*kernels.pointwise),
      net_(chosen<T>(kernels_.nets + tets.degree - 1, kernels_.single_nets + tets.degree - 1)),
      law_kernels_(chosen<T>(kernels_.laws + 0, kernels_.single_laws + 0)),
      lanes_(sizeof(T) == 8 ? kernels.lanes64 : kernels.lanes32), team_(team),
      laws_(std::move(laws)),
      rule_(tets.degree - 1, rule.count, rule.points, rule.weights, rule.values),
      u_(chunks(tets.degree, tets.first, tets.tets, controls_of_chunk(tets), team), 3),
      sums_(u_.parts()), extremes_(u_.parts()), seen_(nothing_seen()), scratch_(team.size()) {
    if (pressure)
        p_.emplace(chunks(pressure->degree, pressure->first, cuts(u_.chunks()), team), 1);
    for (const Law &law : laws_)
        parameters_.emplace_back(law.parameters.begin(), law.parameters.end());
    group(tets);
    pack(tets);
    u_.forget_local();
    if (p_)
        p_->forget_local();
}

/// Numbers the batches: in each chunk region by region.
template <class T> void PointwiseOperator<T>::group(const ElasticTets &tets) {
    std::vector<std::int64_t> many(size_of(tets.regions));
    std::int64_t batch = 0;
    group_.push_back(0);
    for (const Chunk &chunk : u_.chunks().parts) {
        std::ranges::fill(many, 0);
        for (std::int64_t i = chunk.tet; i < chunk.tet + chunk.tets; ++i)
            ++many[size_of(tets.region(i))];
        for (std::int32_t region = 0; region < tets.regions; ++region)
            if (const std::int64_t batches = (many[size_of(region)] + lanes_ - 1) / lanes_) {
                groups_.push_back({batch, batches, region});
                batch += batches;
            }
        group_.push_back(groups_.size());
    }
    make_large(first_, size_of(batch * entities_of_tet(tets.degree) * lanes_), team_);
    if (p_)
        first_pressure_.resize(size_of(batch * entities_of_tet(p_->chunks().degree) * lanes_));
    make_large(geometry_, size_of(batch * 10 * lanes_), team_);
    tet_.resize(size_of(batch * lanes_));
}

/// Lanes without a tet keep geometry zero: they read control 0 and add nothing.
template <class T> void PointwiseOperator<T>::pack(const ElasticTets &tets) {
    team_.run(u_.parts(), [&](std::size_t part, std::size_t) {
        std::vector<std::int64_t> next(size_of(tets.regions));
        for (std::size_t g = group_[part]; g < group_[part + 1]; ++g)
            next[size_of(groups_[g].region)] = groups_[g].batch * lanes_;
        const Chunk &chunk = u_.chunks().parts[part];
        for (std::int64_t i = chunk.tet; i < chunk.tet + chunk.tets; ++i) {
            const std::int64_t place = next[size_of(tets.region(i))]++;
            const std::int64_t batch = place / lanes_, lane = place % lanes_;
            const auto found_by = [&](const Chunks &chunks, std::int32_t components,
                                      std::vector<std::int32_t> &first) {
                const std::int64_t per_tet = entities_of_tet(chunks.degree);
                for (std::int64_t e = 0; e < per_tet; ++e)
                    first[size_of((batch * per_tet + e) * lanes_ + lane)] =
                        components * chunks.local[size_of(i * per_tet + e)];
            };
            found_by(u_.chunks(), 3, first_);
            if (p_)
                found_by(p_->chunks(), 1, first_pressure_);
            const TetShape shape = tets.shape(i);
            T *geometry = geometry_.data() + batch * 10 * lanes_ + lane;
            for (std::int64_t k = 0; k < 9; ++k)
                geometry[k * lanes_] = static_cast<T>(shape.gradients[1 + k / 3][k % 3]);
            geometry[9 * lanes_] = static_cast<T>(shape.volume);
            tet_[size_of(place)] = static_cast<std::int32_t>(tets.order[i]);
        }
    });
}

template <class T>
void PointwiseOperator<T>::forces(const Fields &at, const Forces &found)
    requires std::same_as<T, double>
{
    if constexpr (std::same_as<T, double>) { // Clang 14 compiles what `requires` leaves out
        run({kernels_.forces, at, {}, found});
        take_seen();
    }
}

template <class T>
void PointwiseOperator<T>::tangent(const Fields &at, const Fields &change, const Forces &found) {
    run({chosen<T>(kernels_.tangent, kernels_.single_tangent), at, change, found});
}

template <class T>
double PointwiseOperator<T>::energy(const Fields &at)
    requires std::same_as<T, double>
{
    double sum = 0;
    if constexpr (std::same_as<T, double>) {
        sum = run({kernels_.energy, at, {}, {}});
        take_seen();
    }
    return sum;
}

template <class T> double PointwiseOperator<T>::run(const Work &work) {
    team_.run(u_.parts(), [&](std::size_t part, std::size_t thread) {
        sums_[part] = on_chunk(part, work, scratch_[thread]);
    });
    if (work.found.f)
        team_.run(u_.parts(), [&](std::size_t part, std::size_t) {
            u_.add_foreign(part, work.found.f);
            if (p_)
                p_->add_foreign(part, work.found.g);
        });
    return std::accumulate(sums_.begin(), sums_.end(), 0.0);
}

template <class T> PointwiseBatches<T> PointwiseOperator<T>::batches(const Group &group) const {
    const auto from = [&](const std::vector<std::int32_t> &first, const ChunkedField<T> &field) {
        return first.data() + group.batch * entities_of_tet(field.chunks().degree) * lanes_;
    };
    PointwiseBatches<T> b{};
    b.count = group.batches;
    b.net = net_;
    b.first = from(first_, u_);
    if (p_) {
        b.first_pressure = from(first_pressure_, *p_);
        b.pressure_degree = p_->chunks().degree;
        b.entities_of_pressure = entities_of_tet(b.pressure_degree);
    }
    b.geometry = geometry_.data() + group.batch * 10 * lanes_;
    const Law &law = laws_[size_of(group.region)];
    b.law = law_kernels_ + law.number;
    b.parameters = parameters_[size_of(group.region)].data();
    b.terms = law.terms();
    b.rule = rule_.rule();
    b.extremes = nothing_seen();
    return b;
}

template <class T>
double PointwiseOperator<T>::on_chunk(std::size_t part, const Work &work, std::vector<T> &scratch) {
    const std::size_t u = u_.longest(), p = p_ ? p_->longest() : 0;
    const std::int64_t batch = scratch_of_pointwise(rule_.rule().controls, lanes_);
    scratch.resize(3 * (u + p) + size_of(batch) + cache_line / sizeof(T));
    T *own_u = scratch.data(), *own_du = own_u + u, *own_f = own_du + u;
    T *own_p = own_f + u, *own_dp = own_p + p, *own_g = own_dp + p, *end = own_g + p;
    u_.read(part, work.at.u, own_u);
    if (p_)
        p_->read(part, work.at.p, own_p);
    if (work.change.u) {
        u_.read(part, work.change.u, own_du);
        if (p_)
            p_->read(part, work.change.p, own_dp);
    }
    std::fill(own_f, own_p, T{});
    std::fill(own_g, end, T{});
    end = on_line(end); // where rows of lanes begin
    double sum = 0;
    extremes_[part] = nothing_seen();
    for (std::size_t g = group_[part]; g < group_[part + 1]; ++g) {
        PointwiseBatches<T> b = batches(groups_[g]);
        b.u = own_u;
        b.du = own_du;
        b.p = own_p;
        b.dp = own_dp;
        b.f = own_f;
        b.g = own_g;
        b.scratch = end;
        sum += work.kernel(b);
        take(extremes_[part], b.extremes, groups_[g].batch * lanes_);
    }
    if (work.found.f) {
        u_.write(part, own_f, work.found.f);
        if (p_)
            p_->write(part, own_g, work.found.g);
    }
    return sum;
}

/// The extremes of all chunks, in their order; places become numbers of tets.
template <class T> void PointwiseOperator<T>::take_seen() {
    seen_ = nothing_seen();
    for (const Extremes &here : extremes_)
        take(seen_, here, 0);
    for (Extreme *x : {&seen_.least_J, &seen_.greatest_exponent})
        if (x->place >= 0) {
            x->place = tet_[size_of(x->place)];
            x->point = rule_.given(x->point);
        }
}

template <class T> std::size_t PointwiseOperator<T>::bytes() const {
    return 4 * (first_.size() + first_pressure_.size() + tet_.size()) +
           sizeof(T) * geometry_.size();
}

template class PointwiseOperator<double>;
template class PointwiseOperator<float>;

} // namespace bezsoma
