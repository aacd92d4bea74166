// SPDX-License-Identifier: BSD-3-Clause
#include "conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bezsoma {

namespace {

constexpr std::size_t piece = 16384; // numbers a thread takes at a time; sums add piece by piece
constexpr std::size_t padding = 16;
constexpr int most_beginnings = 3; // from the true residual, before rounding is taken as the reason

template <class Work> void each(Team &team, std::size_t length, const Work &work) {
    team.run((length + piece - 1) / piece, [&](std::size_t p, std::size_t) {
        for (std::size_t i = p * piece; i < std::min((p + 1) * piece, length); ++i)
            work(i);
    });
}

/// Vectors of one length, worked on in pieces that do not depend on the number of threads.
class Pieces {
public:
    Pieces(std::size_t length, Team &team)
        : length_(length), team_(team), sums_((length + piece - 1) / piece) {}

    /// The sum over all i of term(i), which may also write at i.
    template <class Term> double sum(const Term &term) {
        team_.run(sums_.size(), [&](std::size_t p, std::size_t) {
            // Eight partial sums let the processor overlap additions.
            double part[8] = {};
            const std::size_t end = std::min((p + 1) * piece, length_);
            std::size_t i = p * piece;
            for (; i + 8 <= end; i += 8)
                for (std::size_t l = 0; l < 8; ++l)
                    part[l] += term(i + l);
            for (; i < end; ++i)
                part[0] += term(i);
            sums_[p] = std::accumulate(part, part + 8, 0.0);
        });
        return std::accumulate(sums_.begin(), sums_.end(), 0.0);
    }

private:
    std::size_t length_;
    Team &team_;
    std::vector<double> sums_;
};

} // namespace

double Search::take(const double *r, double norm, std::size_t length) {
    double blocks = 0;
    if (blocks_) {
        blocks = blocks_->forward(r, norm, r_);
    } else {
        r_.resize(length);
        each(team_, length, [&](std::size_t i) { r_[i] = static_cast<float>(r[i] / norm); });
    }
    z_.resize(r_.size());
    vertices_(r_.data(), z_.data());
    return blocks + norm * norm * std::inner_product(r_.begin(), r_.end(), z_.begin(), 0.0);
}

void Search::follow(double norm, double beta, double *p) {
    if (blocks_)
        blocks_->back(z_, norm, beta, p);
    else
        each(team_, z_.size(), [&](std::size_t i) { p[i] = beta * p[i] + norm * double{z_[i]}; });
}

Convergence conjugate_gradients(ElasticOperator<double> &k, Preconditioner *blocks,
                                const VertexSolver &vertices, const std::uint8_t *fixed,
                                const double *f, double *x, double reference, double rtol, int most,
                                Team &team, const Watch &watch) {
    const std::size_t length = 3 * static_cast<std::size_t>(k.controls());
    Pieces pieces(length, team);
    std::vector<double> r(length + padding), p(length + padding), q(length);
    Search search(blocks, vertices, team);
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
        if (norm <= rtol * reference || i == most) {
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
