// SPDX-License-Identifier: BSD-3-Clause
#include "conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "large.hpp"
#include "pieces.hpp"

namespace bezsoma {

namespace {

constexpr int most_beginnings = 3; // from the true residual, before rounding is taken as the reason

} // namespace

double Search::take(const double *r, double norm, std::size_t length) {
    double blocks = 0;
    if (blocks_) {
        blocks = blocks_->forward(r, norm, r_);
    } else {
        r_.resize(length);
        each_number(team_, length, [&](std::size_t i) { r_[i] = static_cast<float>(r[i] / norm); });
    }
    z_.resize(r_.size());
    vertices_(r_.data(), z_.data());
    return blocks + norm * norm * std::inner_product(r_.begin(), r_.end(), z_.begin(), 0.0);
}

void Search::follow(double norm, double beta, double *p) {
    if (blocks_)
        blocks_->back(z_, norm, beta, p);
    else
        each_number(team_, z_.size(),
                    [&](std::size_t i) { p[i] = beta * p[i] + norm * double{z_[i]}; });
}

template <class T>
void Search::answer(const T *r, T *z, const std::uint8_t *fixed, std::size_t length) {
    if (blocks_) {
        blocks_->read(r, r_);
    } else {
        r_.resize(length);
        each_number(team_, length, [&](std::size_t i) { r_[i] = static_cast<float>(r[i]); });
    }
    z_.resize(r_.size());
    vertices_(r_.data(), z_.data());
    if (blocks_)
        blocks_->write(z_, z);
    each_number(team_, length, [&](std::size_t i) {
        if (fixed[i])
            z[i] = 0;
        else if (!blocks_)
            z[i] = static_cast<T>(z_[i]);
    });
}
template void Search::answer(const double *, double *, const std::uint8_t *, std::size_t);
template void Search::answer(const float *, float *, const std::uint8_t *, std::size_t);

Convergence conjugate_gradients(ElasticOperator<double> &k, Search search,
                                const std::uint8_t *fixed, const double *f, double *x,
                                double reference, double rtol, int most, Team &team,
                                const Watch &watch) {
    const std::size_t length = 3 * static_cast<std::size_t>(k.controls());
    Pieces pieces(length, team);
    std::vector<double> r = large<double>(length + padding, team),
                        p = large<double>(length + padding, team), q = large<double>(length, team);
    Convergence found;
    const auto true_residual = [&] {
        k.apply(x, q.data());
        return std::sqrt(pieces.sum([&](std::size_t i) {
            r[i] = fixed[i] ? 0.0 : f[i] - q[i];
            return r[i] * r[i];
        }));
    };
    int beginnings = 0;
    double norm = true_residual(), before = 0; // `before` is r.z of the last step, 0 at a start
    found.history.push_back(norm / reference);
    for (int i = 0;; ++i) {
        if (norm <= std::max(rtol, deepest) * reference || i == most) {
            norm = true_residual();
            found.converged = norm <= rtol * reference * (1 + 1e-6);
            found.rounded = !found.converged && ++beginnings > most_beginnings;
            before = 0;
        }
        found.residual = norm / reference;
        watch(i, found.residual);
        if (found.converged || found.rounded || i == most)
            return found;
        const double rz = search.take(r.data(), norm, length);
        search.follow(norm, before > 0 ? rz / before : 0.0, p.data());
        before = rz;
        pieces.sum([&](std::size_t j) { return fixed[j] ? p[j] = 0.0 : 0.0; });
        k.apply(p.data(), q.data());
        const double pq = pieces.sum([&](std::size_t j) { return p[j] * q[j]; });
        if (!(pq > 0 && rz > 0)) {
            found.indefinite = true;
            found.residual = true_residual() / reference;
            return found;
        }
        const double alpha = rz / pq;
        norm = std::sqrt(pieces.sum([&](std::size_t j) {
            x[j] += alpha * p[j];
            r[j] = fixed[j] ? 0.0 : r[j] - alpha * q[j];
            return r[j] * r[j];
        }));
        found.history.push_back(norm / reference);
    }
}

} // namespace bezsoma
