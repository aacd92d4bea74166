// SPDX-License-Identifier: BSD-3-Clause
#include "saddle.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pieces.hpp"

namespace bezsoma {

namespace {

constexpr int most_beginnings = 20;
// BiCGStab's residuals leap, also where it converges. This far above the least one so far it begins
// anew from where that was; where nothing was gained since the last beginning, the square as far.
constexpr double first_leap = 1e4, last_leap = 1e16;
// Where the inverses of tets, averaged, have their largest eigenvalue times the mass matrix; the
// least is one. By degree of the pressure - 1, measured on irregular meshes and rounded up.
constexpr double largest[] = {2.0, 5.0, 8.0, 9.5, 10.5, 11.5, 12.5};
constexpr int chebyshev_steps[] = {1, 1, 2, 2, 2, 2, 2};
// The additive preconditioner counts what entities of four dimensions and degree 1 share up to
// about 3.7 times. Two or three times that, and it balances the pressure's part: fewest steps.
double displacement_scale(int pressure_degree) { return pressure_degree < 3 ? 2.0 : 3.0; }

} // namespace

PressureInverse::PressureInverse(MixedOperator &form, std::vector<double> weight,
                                 std::vector<double> levels, Team &team)
    : form_(form), weight_(std::move(weight)), levels_(std::move(levels)),
      inverse_(size_of(form.pressures())), divided_(inverse_.size()), x_(inverse_.size()),
      y_(inverse_.size()), step_(inverse_.size()), team_(team) {
    form_.on_pressure(&PressureKernel::diagonal, weight_, nullptr, inverse_.data());
    for (double &d : inverse_)
        d = 1 / d;
}

/// z = sum over tets of W M_T^-1 W r, where W shares a control between its tets: weights as the
/// diagonal of the mass matrix has them.
void PressureInverse::shared(const double *r, double *z) {
    each_number(team_, x_.size(), [&](std::size_t i) { divided_[i] = inverse_[i] * r[i]; });
    form_.on_pressure(&PressureKernel::inverse, weight_, divided_.data(), z);
    each_number(team_, x_.size(), [&](std::size_t i) { z[i] *= inverse_[i]; });
}

void PressureInverse::apply(const double *r, double *z) {
    const auto degree = size_of(form_.pressure_degree() - 1);
    const double middle = (largest[degree] + 1) / 2, reach = (largest[degree] - 1) / 2;
    shared(r, step_.data());
    each_number(team_, x_.size(), [&](std::size_t i) { z[i] = step_[i] /= middle; });
    double rho = reach / middle;
    for (int s = 0; s < chebyshev_steps[degree]; ++s) {
        form_.on_pressure(&PressureKernel::mass, weight_, z, y_.data());
        each_number(team_, x_.size(), [&](std::size_t i) { y_[i] = r[i] - y_[i]; });
        shared(y_.data(), x_.data());
        const double next = 1 / (2 * middle / reach - rho);
        each_number(team_, x_.size(), [&](std::size_t i) {
            step_[i] = next * rho * step_[i] + 2 * next / reach * x_[i];
            z[i] += step_[i];
        });
        rho = next;
    }
    project(z);
}

void PressureInverse::project(double *p) {
    Pieces pieces(x_.size(), team_);
    for (std::size_t at = 0; at < levels_.size(); at += x_.size()) {
        const double *level = levels_.data() + at;
        const double own = pieces.sum([&](std::size_t i) { return level[i] * level[i]; });
        const double part = pieces.sum([&](std::size_t i) { return level[i] * p[i]; }) / own;
        each_number(team_, x_.size(), [&](std::size_t i) { p[i] -= part * level[i]; });
    }
}

namespace {

/// A vector of displacements (or forces) followed by pressures (or changes of volume).
using Vector = std::vector<double>;

/// The two norms of a residual.
struct Norms {
    double forces, volumes;
    double larger() const { return std::max(forces, volumes); }
};

class Iteration {
public:
    Iteration(MixedOperator &form, Search &displacement, PressureInverse &pressure,
              const SaddleProblem &problem, Team &team)
        : form_(form), displacement_(displacement), pressure_(pressure), problem_(problem),
          team_(team), forces_(3 * size_of(form.controls())),
          all_(forces_ + size_of(form.pressures())), of_forces_(forces_, team),
          of_volumes_(all_ - forces_, team), weight_(problem.volume_weight * problem.volume_weight),
          x(all_ + padding), r(x), start(x), direction(x), v(x), t(x), z(x), loaded(x), best(x) {}

    /// The sum of terms, a change of volume by how much it counts where it is: so that what the
    /// soft tets miss is not lost beside what the stiff ones do.
    template <class Term> double sum(const Term &term) {
        const auto &volumes = pressure_.inverse_diagonal();
        return of_forces_.sum(term) / problem_.unit +
               of_volumes_.sum([&](std::size_t i) { return term(forces_ + i) * volumes[i]; });
    }

    Norms norms(const Vector &a) {
        const double forces = of_forces_.sum([&](std::size_t i) { return a[i] * a[i]; });
        const double volumes =
            of_volumes_.sum([&](std::size_t i) { return a[forces_ + i] * a[forces_ + i]; });
        return {std::sqrt(forces), std::sqrt(weight_ * volumes)};
    }

    template <class Work> void each(const Work &work) { each_number(team_, all_, work); }

    /// y = form applied to a, on what is free.
    void apply(const Vector &a, Vector &y) {
        form_.apply(a.data(), a.data() + forces_, y.data(), y.data() + forces_);
        free(y);
    }

    void free(Vector &y) {
        each_number(team_, forces_, [&](std::size_t i) {
            if (problem_.fixed[i])
                y[i] = 0.0;
        });
        pressure_.project(y.data() + forces_);
    }

    /// The residual, formed anew.
    void residual() {
        apply(x, r);
        each([&](std::size_t i) {
            r[i] = (i < forces_ ? problem_.f[i] : problem_.g[i - forces_]) - r[i];
        });
        free(r);
    }

    /// z = [A B^T; 0 -S]^-1 a.
    void precondition(const Vector &a) {
        pressure_.apply(a.data() + forces_, z.data() + forces_);
        for (std::size_t i = forces_; i < all_; ++i)
            z[i] = -z[i];
        form_.couple(z.data() + forces_, loaded.data());
        const double square = of_forces_.sum([&](std::size_t i) {
            loaded[i] = problem_.fixed[i] ? 0.0 : a[i] - loaded[i];
            return loaded[i] * loaded[i];
        });
        const double norm = std::sqrt(square);
        if (norm > 0) {
            displacement_.take(loaded.data(), norm, forces_);
            const double scale = displacement_scale(form_.pressure_degree()) / problem_.unit;
            displacement_.follow(scale * norm, 0.0, z.data());
        }
        each_number(team_, forces_, [&](std::size_t i) {
            if (problem_.fixed[i] || !(norm > 0))
                z[i] = 0.0;
        });
    }

private:
    MixedOperator &form_;
    Search &displacement_;
    PressureInverse &pressure_;
    const SaddleProblem &problem_;
    Team &team_;
    std::size_t forces_, all_;
    Pieces of_forces_, of_volumes_;
    double weight_;

public:
    Vector x, r, start, direction, v, t, z, loaded, best;
};

} // namespace

Convergence saddle(MixedOperator &form, Search &displacement, PressureInverse &pressure,
                   const SaddleProblem &problem, double *u, double *p, Team &team,
                   const Watch &watch) {
    Iteration it(form, displacement, pressure, problem, team);
    Convergence found;
    it.residual();
    const Norms first = it.norms(it.r);
    const double reference = std::hypot(first.forces, first.volumes);
    double rho = 0, alpha = 1, omega = 1, norm = first.larger();
    double least = norm, leap = first_leap;
    bool gained = false;
    double begun = 0, begun_norm = 1; // |r|^2 in the sums' measure, and its norm, at a beginning
    int beginnings = 0;
    found.history.push_back(norm / reference);
    for (int i = 0;; ++i) {
        if (norm <= std::max(problem.rtol, deepest) * reference || i == problem.most) {
            if (norm > least)
                it.x = it.best;
            it.residual();
            least = norm = it.norms(it.r).larger();
            it.best = it.x;
            found.converged = norm <= problem.rtol * reference * (1 + 1e-6);
            found.rounded = !found.converged && ++beginnings > most_beginnings;
            rho = 0;
        }
        found.residual = norm / reference;
        watch(i, found.residual);
        if (found.converged || found.rounded || found.indefinite || i == problem.most)
            break;
        const double before = std::exchange(
            rho, rho == 0 ? 0.0 : it.sum([&](std::size_t j) { return it.start[j] * it.r[j]; }));
        // At a start, or where the shadow has turned away from the residual: begin from there.
        if (before == 0 || std::abs(rho) < 1e-14 * begun * (norm / begun_norm)) {
            it.residual();
            it.start = it.direction = it.r;
            begun = rho = it.sum([&](std::size_t j) { return it.r[j] * it.r[j]; });
            begun_norm = norm;
        } else {
            const double beta = rho / before * (alpha / omega);
            it.each([&](std::size_t j) {
                it.direction[j] = it.r[j] + beta * (it.direction[j] - omega * it.v[j]);
            });
        }
        it.precondition(it.direction);
        it.apply(it.z, it.v);
        alpha = rho / it.sum([&](std::size_t j) { return it.start[j] * it.v[j]; });
        it.each([&](std::size_t j) {
            it.x[j] += alpha * it.z[j];
            it.r[j] -= alpha * it.v[j];
        });
        it.precondition(it.r);
        it.apply(it.z, it.t);
        const double ts = it.sum([&](std::size_t j) { return it.t[j] * it.r[j]; });
        const double tt = it.sum([&](std::size_t j) { return it.t[j] * it.t[j]; });
        omega = tt > 0 ? ts / tt : 0.0;
        it.each([&](std::size_t j) {
            it.x[j] += omega * it.z[j];
            it.r[j] -= omega * it.t[j];
        });
        norm = it.norms(it.r).larger();
        const bool broken = !std::isfinite(norm) || omega == 0;
        if (broken || norm > leap * least) {
            found.indefinite = !gained && (broken || leap >= last_leap);
            leap = gained ? first_leap : leap * leap;
            gained = false;
            it.x = it.best;
            norm = least;
            rho = 0;
        } else if (norm < least / 2) {
            it.best = it.x;
            least = norm;
            gained = true;
        }
        found.history.push_back(norm / reference);
    }
    const auto controls = 3 * form.controls();
    std::copy_n(it.x.begin(), controls, u);
    std::copy_n(it.x.begin() + controls, form.pressures(), p);
    return found;
}

} // namespace bezsoma
