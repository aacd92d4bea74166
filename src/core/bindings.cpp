// SPDX-License-Identifier: BSD-3-Clause
// The one file that knows Python. It checks shapes, releases the interpreter and calls the kernels.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "aggregation.hpp"
#include "block_csr.hpp"
#include "cholesky.hpp"
#include "conjugate_gradients.hpp"
#include "elastic_operator.hpp"
#include "elasticity.hpp"
#include "law.hpp"
#include "mixed_operator.hpp"
#include "pointwise_operator.hpp"
#include "preconditioner.hpp"
#include "simplex.hpp"
#include "vertex_matrix.hpp"

namespace nb = nanobind;

namespace {

template <typename T, long... shape>
using In = nb::ndarray<const T, nb::shape<shape...>, nb::c_contig, nb::device::cpu>;
template <typename T, long... shape>
using Out = nb::ndarray<nb::numpy, T, nb::shape<shape...>, nb::c_contig, nb::device::cpu>;
using Vectors = nb::ndarray<double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Scalars = nb::ndarray<double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

/// A NumPy array that owns the vector.
template <typename T, long... shape>
Out<T, shape...> handed_over(std::vector<T> &&values, std::initializer_list<std::size_t> sizes) {
    auto owned = std::make_unique<std::vector<T>>(std::move(values));
    T *data = owned->data();
    nb::capsule owner(owned.release(),
                      [](void *p) noexcept { delete static_cast<std::vector<T> *>(p); });
    return Out<T, shape...>(data, sizes, owner);
}

void require(bool holds, const char *what) {
    if (!holds)
        throw nb::value_error(what);
}

/// gradients, volumes, lambda and mu of the same tets.
struct Tets {
    In<double, -1, 4, 3> gradients;
    In<double, -1> volumes, lambda, mu;

    void check(std::size_t tets) const {
        require(gradients.shape(0) == tets && volumes.shape(0) == tets && lambda.shape(0) == tets &&
                    mu.shape(0) == tets,
                "gradients, volumes, lam and mu must have one row a tet");
    }
};

bezsoma::Rows rows(const In<std::int64_t, -1> &start, const In<std::int32_t, -1> &column) {
    require(start.shape(0) > 0, "starts must have one entry more than there are rows");
    return {start.shape(0) - 1, start.data(), column.data()};
}

auto element_matrices(int degree, In<double, -1, 4, 3> gradients, In<double, -1> volumes,
                      In<double, -1> lambda, In<double, -1> mu) {
    const std::size_t tets = volumes.shape(0);
    Tets{gradients, volumes, lambda, mu}.check(tets);
    const std::size_t size = 3 * bezsoma::count(degree);
    std::vector<double> out(tets * size * size);
    {
        nb::gil_scoped_release released;
        bezsoma::element_matrices(bezsoma::stiffness(degree), tets, gradients.data(),
                                  volumes.data(), lambda.data(), mu.data(), out.data());
    }
    return handed_over<double, -1, -1, -1>(std::move(out), {tets, size, size});
}

auto pattern(In<std::int64_t, -1, -1> of_tet, std::size_t controls) {
    require(controls <= std::numeric_limits<std::int32_t>::max(),
            "more than 2^31 - 1 controls do not fit the columns of a block matrix");
    bezsoma::Pattern where;
    {
        nb::gil_scoped_release released;
        where = bezsoma::pattern(of_tet.data(), of_tet.shape(0), of_tet.shape(1), controls);
    }
    const std::size_t blocks = where.column.size();
    return nb::make_tuple(handed_over<std::int64_t, -1>(std::move(where.start), {controls + 1}),
                          handed_over<std::int32_t, -1>(std::move(where.column), {blocks}));
}

auto assembled(int degree, In<std::int64_t, -1, -1> of_tet, In<double, -1, 4, 3> gradients,
               In<double, -1> volumes, In<double, -1> lambda, In<double, -1> mu,
               In<std::int64_t, -1> start, In<std::int32_t, -1> column, std::size_t threads) {
    Tets{gradients, volumes, lambda, mu}.check(of_tet.shape(0));
    require(of_tet.shape(1) == bezsoma::count(degree), "of_tet does not fit the degree");
    std::vector<double> blocks(9 * column.shape(0));
    {
        nb::gil_scoped_release released;
        const bezsoma::Elements elements{of_tet.shape(0), of_tet.data(), gradients.data(),
                                         volumes.data(),  lambda.data(), mu.data()};
        bezsoma::assemble(bezsoma::stiffness(degree), elements, rows(start, column), threads,
                          blocks.data());
    }
    return handed_over<double, -1, 3, 3>(std::move(blocks), {column.shape(0), 3, 3});
}

void multiply(In<std::int64_t, -1> start, In<std::int32_t, -1> column, In<double, -1, 3, 3> blocks,
              In<double, -1, 3> x, Vectors y, std::size_t threads) {
    const bezsoma::Rows where = rows(start, column);
    require(x.shape(0) == where.rows && y.shape(0) == where.rows,
            "x and y must have one row a control");
    nb::gil_scoped_release released;
    bezsoma::multiply(where, blocks.data(), x.data(), threads, y.data());
}

auto incomplete_cholesky(In<std::int64_t, -1> start, In<std::int32_t, -1> column,
                         In<double, -1, 3, 3> blocks, In<bool, -1, 3> held, double shift,
                         double least) {
    const bezsoma::Rows where = rows(start, column);
    require(held.shape(0) == where.rows, "held must have one row a control");
    bezsoma::Factor f;
    {
        nb::gil_scoped_release released;
        f = bezsoma::incomplete_cholesky(where, blocks.data(), held.data(), shift, least);
    }
    const std::size_t lower = f.column.size();
    return nb::make_tuple(handed_over<std::int64_t, -1>(std::move(f.start), {where.rows + 1}),
                          handed_over<std::int32_t, -1>(std::move(f.column), {lower}),
                          handed_over<double, -1, 3, 3>(std::move(f.below), {lower, 3, 3}),
                          handed_over<double, -1, 3, 3>(std::move(f.inverse), {where.rows, 3, 3}),
                          f.broken);
}

void solve_cholesky(In<std::int64_t, -1> start, In<std::int32_t, -1> column,
                    In<double, -1, 3, 3> below, In<double, -1, 3, 3> inverse, In<double, -1, 3> r,
                    Vectors z) {
    const bezsoma::Rows where = rows(start, column);
    require(r.shape(0) == where.rows && z.shape(0) == where.rows,
            "r and z must have one row a control");
    nb::gil_scoped_release released;
    bezsoma::solve_cholesky({where, below.data(), inverse.data()}, r.data(), z.data());
}

// ------------------------------------------------------------------ without a matrix

/// Tets in the order of the walk that numbered their controls.
struct Walk {
    Walk(int n, In<std::int32_t, -1, -1> first_of_entity, In<std::int64_t, -1> order_of_walk,
         In<double, -1, 3> where, In<std::int64_t, -1, 4> corners_of_tet,
         In<std::int64_t, -1> region_of_tet, In<double, -1, 2> lambda_and_mu)
        : degree(n), first(std::move(first_of_entity)), order(std::move(order_of_walk)),
          points(std::move(where)), corners(std::move(corners_of_tet)),
          region(std::move(region_of_tet)), lame(std::move(lambda_and_mu)) {}

    int degree;
    In<std::int32_t, -1, -1> first;
    In<std::int64_t, -1> order;
    In<double, -1, 3> points;
    In<std::int64_t, -1, 4> corners;
    In<std::int64_t, -1> region;
    In<double, -1, 2> lame;

    bezsoma::ElasticTets tets() const {
        require(degree >= 1 && degree <= 10, "degree must be 1 to 10");
        require(first.shape(1) == static_cast<std::size_t>(bezsoma::entities_of_tet(degree)),
                "first must have a column for each entity that holds controls");
        const std::size_t tets = corners.shape(0);
        require(tets > 0 && first.shape(0) == tets && order.shape(0) == tets &&
                    region.shape(0) == tets,
                "first, order, corners and region must have one row a tet");
        const auto within = [](const auto &numbers, std::size_t count) {
            return std::all_of(numbers.data(), numbers.data() + numbers.size(), [=](auto i) {
                return i >= 0 && static_cast<std::size_t>(i) < count;
            });
        };
        require(within(order, tets) && within(corners, points.shape(0)) &&
                    within(region, lame.shape(0)),
                "order, corners and region must number tets, points and rows of lame");
        return {degree,
                static_cast<std::int64_t>(tets),
                first.data(),
                order.data(),
                points.data(),
                corners.data(),
                region.data(),
                lame.data(),
                static_cast<std::int32_t>(lame.shape(0))};
    }
};

/// Lets Python's signal handlers run: Ctrl-C in the middle of a computation.
void listen_to_signals() {
    nb::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0)
        throw nb::python_error();
}

/// K of one body without a matrix in one precision, its threads, and the kernels of one
/// instruction set. What it was made from is not kept.
class MatrixFree {
public:
    MatrixFree(const Walk &walk, std::size_t threads, const std::string &instructions, bool single)
        : team_(threads),
          kernels_(instructions.empty() ? &bezsoma::best_kernels()
                                        : bezsoma::kernels_named(instructions.c_str())) {
        require(kernels_ != nullptr, "this processor or build lacks that instruction set");
        const bezsoma::ElasticTets tets = walk.tets();
        team_.watch(listen_to_signals);
        nb::gil_scoped_release released;
        if (single)
            single_ = std::make_unique<bezsoma::ElasticOperator<float>>(tets, *kernels_, team_);
        else
            double_ = std::make_unique<bezsoma::ElasticOperator<double>>(tets, *kernels_, team_);
    }

    void apply(In<double, -1, 3, -1> x, nb::ndarray<double, nb::shape<-1, 3, -1>, nb::c_contig> y) {
        apply_to(k(), x, y);
    }

    void apply_single(In<float, -1, 3, -1> x,
                      nb::ndarray<float, nb::shape<-1, 3, -1>, nb::c_contig> y) {
        require(single_ != nullptr, "this operator was made for float64");
        apply_to(*single_, x, y);
    }

    double work(In<double, -1, 3> x) {
        require(static_cast<std::int64_t>(x.shape(0)) == k().controls(),
                "x must have one row a control");
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        return k().work(x.data());
    }

    bezsoma::ElasticOperator<double> &k() {
        require(double_ != nullptr, "this operator was made for float32");
        return *double_;
    }
    bezsoma::Team &team() { return team_; }
    /// Threads of Python take turns: an operator has one team and one scratch space. Wait for it
    /// without the interpreter, which whoever has the turn may need.
    std::mutex &turn() { return turn_; }
    const bezsoma::Kernels &kernels() const { return *kernels_; }

private:
    template <class Operator, class X, class Y> void apply_to(Operator &k, const X &x, const Y &y) {
        require(static_cast<std::int64_t>(x.shape(0)) == k.controls() && y.shape(0) == x.shape(0) &&
                    y.shape(2) == x.shape(2) && x.shape(2) > 0,
                "x and y must have one row a control and as many sides");
        const int sides = static_cast<int>(x.shape(2));
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        k.apply(x.data(), y.data(), sides);
    }

    std::mutex turn_;
    bezsoma::Team team_;
    const bezsoma::Kernels *kernels_;
    std::unique_ptr<bezsoma::ElasticOperator<double>> double_;
    std::unique_ptr<bezsoma::ElasticOperator<float>> single_;
};

/// The displacement-pressure form of one body: as MatrixFree. The walk's moduli are G and 1/kappa.
class MixedFree {
public:
    MixedFree(const Walk &walk, int pressure_degree, In<std::int32_t, -1, -1> first,
              std::size_t threads, const std::string &instructions)
        : team_(threads),
          kernels_(instructions.empty() ? &bezsoma::best_kernels()
                                        : bezsoma::kernels_named(instructions.c_str())) {
        require(kernels_ != nullptr, "this processor or build lacks that instruction set");
        const bezsoma::ElasticTets tets = walk.tets();
        require(tets.degree <= bezsoma::highest_mixed_degree && pressure_degree >= 1 &&
                    pressure_degree < tets.degree,
                "degrees must be 2 to 8 beside a pressure of a lower one, 1 at least");
        require(first.shape(0) == walk.first.shape(0) &&
                    first.shape(1) ==
                        static_cast<std::size_t>(bezsoma::entities_of_tet(pressure_degree)),
                "the pressure's first must have a row a tet and a column for each entity");
        require(numbered_by_walk(pressure_degree, first),
                "the pressure must be numbered as the walk over the tets first touches it");
        team_.watch(listen_to_signals);
        nb::gil_scoped_release released;
        operator_ = std::make_unique<bezsoma::MixedOperator>(
            bezsoma::MixedTets{tets, pressure_degree, first.data()}, *kernels_, team_);
    }

    void apply(In<double, -1, 3> u, In<double, -1> p, Vectors f, Scalars g) {
        require(fits(u, p) && fits(f, g), "u, f and p, g must have one row a control");
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        operator_->apply(u.data(), p.data(), f.data(), g.data());
    }

    double work(In<double, -1, 3> u, In<double, -1> p) {
        require(fits(u, p), "u and p must have one row a control");
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        return operator_->work(u.data(), p.data());
    }

    void mass(In<double, -1> weight, In<double, -1> p, Scalars g) {
        require(static_cast<std::int64_t>(weight.size()) == operator_->regions() &&
                    static_cast<std::int64_t>(p.size()) == operator_->pressures() &&
                    g.size() == p.size(),
                "weight, p and g must fit the regions and the pressure's controls");
        const std::vector<double> weights(weight.data(), weight.data() + weight.size());
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        operator_->mass(weights, p.data(), g.data());
    }

    bezsoma::MixedOperator &form() { return *operator_; }
    bezsoma::Team &team() { return team_; }
    std::mutex &turn() { return turn_; }
    const bezsoma::Kernels &kernels() const { return *kernels_; }

    template <class U, class P> bool fits(const U &u, const P &p) const {
        return static_cast<std::int64_t>(u.shape(0)) == operator_->controls() &&
               static_cast<std::int64_t>(p.shape(0)) == operator_->pressures();
    }

    static bool numbered_by_walk(int degree, const In<std::int32_t, -1, -1> &first) {
        std::int32_t next = 0;
        const std::size_t per_tet = first.shape(1);
        for (std::size_t i = 0; i < first.size(); ++i) {
            const std::int32_t run = first.data()[i];
            if (run < 0 || run > next)
                return false;
            if (run == next)
                next += bezsoma::controls_inside(degree, static_cast<int>(i % per_tet));
        }
        return true;
    }

private:
    std::mutex turn_;
    bezsoma::Team team_;
    const bezsoma::Kernels *kernels_;
    std::unique_ptr<bezsoma::MixedOperator> operator_;
};

/// The preconditioner of a body with its supports, and the iteration that it serves.
class Multigrid {
public:
    Multigrid(MatrixFree &k, const Walk &walk, In<std::int32_t, -1, 4> corners,
              In<double, -1, 3> points, In<bool, -1, 3> held, In<bool, -1, 3> held_vertices)
        : k_(k) {
        const bezsoma::ElasticTets tets = walk.tets();
        const auto vertices = static_cast<std::int64_t>(points.shape(0));
        require(corners.shape(0) == walk.corners.shape(0) &&
                    held.shape(0) == static_cast<std::size_t>(k.k().controls()) &&
                    held_vertices.shape(0) == points.shape(0),
                "corners, held and held_vertices must fit the tets, controls and vertices");
        held_.assign(held.data(), held.data() + held.size());
        const std::vector<std::uint8_t> at_vertices(held_vertices.data(),
                                                    held_vertices.data() + held_vertices.size());
        nb::gil_scoped_release released;
        const std::lock_guard turn(k_.turn());
        if (tets.degree > 1)
            blocks_ = std::make_unique<bezsoma::Preconditioner>(tets, corners.data(), vertices,
                                                                held_.data(), k.k().chunks(),
                                                                k.kernels(), k.team());
        aggregation_ = std::make_unique<bezsoma::Aggregation>(
            bezsoma::vertex_matrix(tets, corners.data(), vertices, at_vertices.data(), k.team()),
            points.data(), at_vertices.data(), k.team());
    }

    auto solve(In<double, -1, 3> f, Vectors x, double reference, double rtol, int most,
               const std::function<void(int, double)> &report) {
        require(f.size() == held_.size() && x.size() == held_.size(),
                "f and x must have one row a control");
        bezsoma::Convergence found;
        {
            nb::gil_scoped_release released;
            const std::lock_guard turn(k_.turn());
            found = bezsoma::conjugate_gradients(
                k_.k(), blocks_.get(), [&](const float *r, float *z) { aggregation_->apply(r, z); },
                held_.data(), f.data(), x.data(), reference, rtol, most, k_.team(),
                [&](int iteration, double residual) {
                    nb::gil_scoped_acquire held;
                    report(iteration, residual);
                });
        }
        return nb::make_tuple(found.history, found.residual, found.converged, found.indefinite,
                              found.rounded);
    }

    /// z = B r.
    void apply(In<double, -1, 3> r, Vectors z) {
        require(r.size() == held_.size() && z.size() == held_.size(),
                "r and z must have one row a control");
        nb::gil_scoped_release released;
        const std::lock_guard turn(k_.turn());
        std::vector<double> from(r.data(), r.data() + r.size()), to(r.size() + 16);
        from.resize(to.size());
        bezsoma::Search search{
            blocks_.get(), [&](const float *x, float *y) { aggregation_->apply(x, y); }, k_.team()};
        search.take(from.data(), 1.0, held_.size());
        search.follow(1.0, 0.0, to.data());
        for (std::size_t i = 0; i < held_.size(); ++i)
            z.data()[i] = held_[i] ? 0.0 : to[i];
    }

    std::vector<std::int64_t> levels() const { return aggregation_->sizes(); }
    std::size_t bytes() const { return (blocks_ ? blocks_->bytes() : 0) + aggregation_->bytes(); }

private:
    MatrixFree &k_;
    std::vector<std::uint8_t> held_;
    std::unique_ptr<bezsoma::Preconditioner> blocks_;
    std::unique_ptr<bezsoma::Aggregation> aggregation_;
};

// ------------------------------------------------------------------ laws at points

const bezsoma::Kernels &kernels_of(const std::string &instructions) {
    const bezsoma::Kernels *found = instructions.empty()
                                        ? &bezsoma::best_kernels()
                                        : bezsoma::kernels_named(instructions.c_str());
    require(found != nullptr, "this processor or build lacks that instruction set");
    return *found;
}

/// A law of the core by its name, asked at points.
class LawAtPoints {
public:
    using Tensors = In<double, -1, 3, 3>;
    using Numbers = In<double, -1>;

    LawAtPoints(const std::string &name, std::vector<double> parameters,
                const std::string &instructions)
        : law_{bezsoma::law_numbered(name.c_str()), std::move(parameters)},
          kernels_(kernels_of(instructions)) {
        if (law_.number < 0)
            throw nb::value_error(("no law '" + name + "'; see _core.law_names()").c_str());
        const auto many = law_.parameters.size();
        const auto asked = static_cast<std::size_t>(law_.name().parameters);
        if (law_.name().is_sum ? many < asked || many % 2 == 0 : many != asked)
            throw nb::value_error(("the law '" + name + "' has " + std::to_string(asked) +
                                   " parameters, kappa first, not " + std::to_string(many))
                                      .c_str());
    }

    auto stress(Tensors H) const { return tensors(bezsoma::Answer::stress, H, H); }
    auto derivative(Tensors H, Tensors dH) const {
        return tensors(bezsoma::Answer::derivative, H, dH);
    }
    auto energy(Tensors H) const { return energies(H, nullptr); }

    auto mixed_stress(Tensors H, Numbers p) const {
        return mixed(bezsoma::Answer::stress, H, p, H, p);
    }
    auto mixed_derivative(Tensors H, Numbers p, Tensors dH, Numbers dp) const {
        return mixed(bezsoma::Answer::derivative, H, p, dH, dp);
    }
    auto mixed_energy(Tensors H, Numbers p) const {
        require(p.shape(0) == H.shape(0), "H and p must have one row a point");
        require_split();
        return energies(H, p.data());
    }

    const bezsoma::Law &law() const { return law_; }
    const bezsoma::LawKernel<double> &kernel() const {
        return kernels_.pointwise->laws[law_.number];
    }
    bool splits() const { return kernel().mixed_stress != nullptr; }
    void require_compressible() const {
        require(
            std::isfinite(law_.parameters[0]),
            "kappa = inf needs the mixed form: the displacement alone does not give the stress");
    }
    void require_split() const {
        require(splits(), "this law has no mixed form: it does not split into shape and volume");
    }

private:
    Out<double, -1, 3, 3> tensors(bezsoma::Answer which, const Tensors &H,
                                  const Tensors &dH) const {
        require_compressible();
        require(dH.shape(0) == H.shape(0), "H and dH must have one row a point");
        const std::size_t count = H.shape(0);
        std::vector<double> P(9 * count);
        check(bezsoma::answers(law_, kernels_, which, {count, H.data(), nullptr},
                               {count, dH.data(), nullptr}, P.data(), nullptr));
        return handed_over<double, -1, 3, 3>(std::move(P), {count, 3, 3});
    }

    nb::tuple mixed(bezsoma::Answer which, const Tensors &H, const Numbers &p, const Tensors &dH,
                    const Numbers &dp) const {
        const std::size_t count = H.shape(0);
        require(p.shape(0) == count && dH.shape(0) == count && dp.shape(0) == count,
                "H, p, dH and dp must have one row a point");
        require_split();
        std::vector<double> P(9 * count), c(count);
        check(bezsoma::answers(law_, kernels_, which, {count, H.data(), p.data()},
                               {count, dH.data(), dp.data()}, P.data(), c.data()));
        return nb::make_tuple(handed_over<double, -1, 3, 3>(std::move(P), {count, 3, 3}),
                              handed_over<double, -1>(std::move(c), {count}));
    }

    Out<double, -1> energies(const Tensors &H, const double *p) const {
        require(kernel().has_energy, "this law has no energy");
        if (!p)
            require_compressible();
        const std::size_t count = H.shape(0);
        std::vector<double> W(count);
        check(bezsoma::answers(law_, kernels_, bezsoma::Answer::energy, {count, H.data(), p},
                               {count, H.data(), p}, W.data(), nullptr));
        return handed_over<double, -1>(std::move(W), {count});
    }

    /// A law asked where it has no answer says so; numbers that are none never leave in silence.
    static void check(const bezsoma::Extremes &seen) {
        const auto &J = seen.least_J;
        if (J.place >= 0 && !(J.value > 0))
            throw nb::value_error(("J = " + std::to_string(J.value) + " in row " +
                                   std::to_string(J.place) + ": a law holds for J > 0")
                                      .c_str());
        const auto &x = seen.greatest_exponent;
        if (x.place >= 0 && !(x.value <= 700))
            throw nb::value_error(("exp(" + std::to_string(x.value) + ") in row " +
                                   std::to_string(x.place) + " leaves the range of numbers")
                                      .c_str());
    }

    bezsoma::Law law_;
    const bezsoma::Kernels &kernels_;
};

/// Forces and tangents of laws, one a region, and the threads that work on them. With a pressure
/// the mixed form.
class Pointwise {
public:
    using First = In<std::int32_t, -1, -1>;

    Pointwise(const Walk &walk, const std::vector<const LawAtPoints *> &laws,
              In<double, -1, 4> points, In<double, -1> weights, In<double, -1, -1> values,
              std::size_t threads, const std::string &instructions, bool single,
              int pressure_degree, std::optional<First> first)
        : team_(threads), kernels_(kernels_of(instructions)) {
        const bezsoma::ElasticTets tets = walk.tets();
        require(laws.size() == static_cast<std::size_t>(tets.regions), "one law a region");
        require(values.shape(1) == bezsoma::count(tets.degree - 1) &&
                    values.shape(0) == weights.shape(0) && points.shape(0) == weights.shape(0) &&
                    weights.shape(0) > 0,
                "points (q, 4), weights (q,) and values (q, controls of degree - 1) must fit");
        std::optional<bezsoma::PressureNet> pressure;
        if (first) {
            check_pressure(walk, tets, pressure_degree, *first, single);
            pressure = {pressure_degree, first->data()};
        }
        std::vector<bezsoma::Law> own;
        for (const LawAtPoints *law : laws) {
            if (first)
                law->require_split();
            else
                law->require_compressible();
            own.push_back(law->law());
        }
        team_.watch(listen_to_signals);
        const bezsoma::GivenRule rule{static_cast<std::int32_t>(weights.shape(0)), points.data(),
                                      weights.data(), values.data()};
        nb::gil_scoped_release released;
        if (single)
            single_ = std::make_unique<bezsoma::PointwiseOperator<float>>(
                tets, pressure, std::move(own), rule, kernels_, team_);
        else
            double_ = std::make_unique<bezsoma::PointwiseOperator<double>>(
                tets, pressure, std::move(own), rule, kernels_, team_);
    }

    void forces(In<double, -1, 3> u, Vectors f) {
        fits(u.shape(0), f.shape(0), false);
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        laws().forces({u.data(), nullptr}, {f.data(), nullptr});
    }

    void tangent(In<double, -1, 3> u, In<double, -1, 3> du, Vectors df) {
        fits(u.shape(0), df.shape(0), false);
        fits(du.shape(0), df.shape(0), false);
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        laws().tangent({u.data(), nullptr}, {du.data(), nullptr}, {df.data(), nullptr});
    }

    void tangent_single(In<float, -1, 3> u, In<float, -1, 3> du,
                        nb::ndarray<float, nb::shape<-1, 3>, nb::c_contig> df) {
        require(single_ != nullptr, "this operator was made for float64");
        const auto rows = static_cast<std::size_t>(single_->controls());
        require(u.shape(0) == rows && du.shape(0) == rows && df.shape(0) == rows,
                "displacements and forces must have one row a control");
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        single_->tangent({u.data(), nullptr}, {du.data(), nullptr}, {df.data(), nullptr});
    }

    double energy(In<double, -1, 3> u) {
        fits(u.shape(0), u.shape(0), false);
        require_energy();
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        return laws().energy({u.data(), nullptr});
    }

    void mixed_forces(In<double, -1, 3> u, In<double, -1> p, Vectors f, Scalars g) {
        fits(u.shape(0), f.shape(0), true);
        fits_pressure(p.shape(0), g.shape(0));
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        laws().forces({u.data(), p.data()}, {f.data(), g.data()});
    }

    void mixed_tangent(In<double, -1, 3> u, In<double, -1> p, In<double, -1, 3> du,
                       In<double, -1> dp, Vectors df, Scalars dg) {
        fits(u.shape(0), df.shape(0), true);
        fits(du.shape(0), df.shape(0), true);
        fits_pressure(p.shape(0), dg.shape(0));
        fits_pressure(dp.shape(0), dg.shape(0));
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        laws().tangent({u.data(), p.data()}, {du.data(), dp.data()}, {df.data(), dg.data()});
    }

    double mixed_energy(In<double, -1, 3> u, In<double, -1> p) {
        fits(u.shape(0), u.shape(0), true);
        fits_pressure(p.shape(0), p.shape(0));
        require_energy();
        nb::gil_scoped_release released;
        const std::lock_guard turn(turn_);
        return laws().energy({u.data(), p.data()});
    }

    nb::tuple least_jacobian() { return told(laws().seen().least_J, 1e30); }
    nb::tuple greatest_exponent() { return told(laws().seen().greatest_exponent, -1e30); }
    const char *instructions() const { return kernels_.name; }
    std::size_t threads() const { return team_.size(); }
    std::size_t bytes() const { return single_ ? single_->bytes() : double_->bytes(); }

private:
    static void check_pressure(const Walk &walk, const bezsoma::ElasticTets &tets, int degree,
                               const First &first, bool single) {
        require(!single && tets.degree <= bezsoma::highest_mixed_degree && degree >= 1 &&
                    degree < tets.degree,
                "degrees must be 2 to 8 beside a pressure of a lower one, 1 at least, in float64");
        require(first.shape(0) == walk.first.shape(0) &&
                    first.shape(1) == static_cast<std::size_t>(bezsoma::entities_of_tet(degree)),
                "the pressure's first must have a row a tet and a column for each entity");
        require(MixedFree::numbered_by_walk(degree, first),
                "the pressure must be numbered as the walk over the tets first touches it");
    }

    bezsoma::PointwiseOperator<double> &laws() {
        require(double_ != nullptr, "this operator was made for float32");
        return *double_;
    }

    void fits(std::size_t x, std::size_t y, bool mixed) {
        require((laws().pressures() > 0) == mixed,
                mixed ? "this operator has no pressure" : "this operator has a pressure");
        require(static_cast<std::int64_t>(x) == laws().controls() && y == x,
                "displacements and forces must have one row a control");
    }

    void fits_pressure(std::size_t x, std::size_t y) {
        require(static_cast<std::int64_t>(x) == laws().pressures() && y == x,
                "p and g must have one row a control of the pressure");
    }

    void require_energy() {
        for (const bezsoma::Law &law : laws().laws())
            require(kernels_.pointwise->laws[law.number].has_energy,
                    "a law of this body has no energy");
    }

    static nb::tuple told(const bezsoma::Extreme &x, double nothing) {
        const double value = x.value == nothing
                                 ? std::copysign(std::numeric_limits<double>::infinity(), nothing)
                                 : x.value;
        return nb::make_tuple(value, x.place, x.point);
    }

    std::mutex turn_;
    bezsoma::Team team_;
    const bezsoma::Kernels &kernels_;
    std::unique_ptr<bezsoma::PointwiseOperator<double>> double_;
    std::unique_ptr<bezsoma::PointwiseOperator<float>> single_;
};

} // namespace

NB_MODULE(_core, m) {
    using namespace nb::literals;
    m.doc() = "BezSoma's kernels over flat arrays";
    m.def("element_matrices", &element_matrices, "degree"_a, "gradients"_a, "volumes"_a, "lam"_a,
          "mu"_a);
    m.def("pattern", &pattern, "of_tet"_a, "controls"_a);
    m.def("assembled", &assembled, "degree"_a, "of_tet"_a, "gradients"_a, "volumes"_a, "lam"_a,
          "mu"_a, "starts"_a, "columns"_a, "threads"_a = 0);
    m.def("multiply", &multiply, "starts"_a, "columns"_a, "blocks"_a, "x"_a, "y"_a,
          "threads"_a = 0);
    m.def("incomplete_cholesky", &incomplete_cholesky, "starts"_a, "columns"_a, "blocks"_a,
          "held"_a, "shift"_a, "least"_a);
    m.def("solve_cholesky", &solve_cholesky, "starts"_a, "columns"_a, "below"_a, "inverse"_a, "r"_a,
          "z"_a);
    nb::class_<Walk>(m, "Walk").def(
        nb::init<int, In<std::int32_t, -1, -1>, In<std::int64_t, -1>, In<double, -1, 3>,
                 In<std::int64_t, -1, 4>, In<std::int64_t, -1>, In<double, -1, 2>>(),
        "degree"_a, "first"_a, "order"_a, "points"_a, "corners"_a, "region"_a, "lame"_a);
    nb::class_<MatrixFree>(m, "MatrixFree")
        .def(nb::init<const Walk &, std::size_t, const std::string &, bool>(), "walk"_a,
             "threads"_a = 0, "instructions"_a = "", "single"_a = false)
        .def("apply", &MatrixFree::apply, "x"_a, "y"_a)
        .def("work", &MatrixFree::work, "x"_a)
        .def("apply_single", &MatrixFree::apply_single, "x"_a, "y"_a)
        .def_prop_ro("instructions", [](const MatrixFree &k) { return k.kernels().name; })
        .def_prop_ro("threads", [](MatrixFree &k) { return k.team().size(); });
    nb::class_<MixedFree>(m, "MixedFree")
        .def(nb::init<const Walk &, int, In<std::int32_t, -1, -1>, std::size_t,
                      const std::string &>(),
             "walk"_a, "pressure_degree"_a, "first"_a, "threads"_a = 0, "instructions"_a = "")
        .def("apply", &MixedFree::apply, "u"_a, "p"_a, "f"_a, "g"_a)
        .def("work", &MixedFree::work, "u"_a, "p"_a)
        .def("mass", &MixedFree::mass, "weight"_a, "p"_a, "g"_a)
        .def_prop_ro("instructions", [](const MixedFree &k) { return k.kernels().name; })
        .def_prop_ro("threads", [](MixedFree &k) { return k.team().size(); });
    nb::class_<Multigrid>(m, "Multigrid")
        .def(nb::init<MatrixFree &, const Walk &, In<std::int32_t, -1, 4>, In<double, -1, 3>,
                      In<bool, -1, 3>, In<bool, -1, 3>>(),
             "k"_a, "walk"_a, "corners"_a, "points"_a, "held"_a, "held_vertices"_a,
             nb::keep_alive<1, 2>())
        .def("solve", &Multigrid::solve, "f"_a, "x"_a, "reference"_a, "rtol"_a, "most"_a,
             "report"_a)
        .def("apply", &Multigrid::apply, "r"_a, "z"_a)
        .def_prop_ro("levels", &Multigrid::levels)
        .def_prop_ro("bytes", &Multigrid::bytes);
    nb::class_<LawAtPoints>(m, "Law")
        .def(nb::init<const std::string &, std::vector<double>, const std::string &>(), "name"_a,
             "parameters"_a, "instructions"_a = "")
        .def("stress", &LawAtPoints::stress, "H"_a)
        .def("derivative", &LawAtPoints::derivative, "H"_a, "dH"_a)
        .def("energy", &LawAtPoints::energy, "H"_a)
        .def("mixed_stress", &LawAtPoints::mixed_stress, "H"_a, "p"_a)
        .def("mixed_derivative", &LawAtPoints::mixed_derivative, "H"_a, "p"_a, "dH"_a, "dp"_a)
        .def("mixed_energy", &LawAtPoints::mixed_energy, "H"_a, "p"_a)
        .def_prop_ro("name", [](const LawAtPoints &law) { return law.law().name().name; })
        .def_prop_ro("parameters", [](const LawAtPoints &law) { return law.law().parameters; })
        .def_prop_ro("finite", [](const LawAtPoints &law) { return law.kernel().finite; })
        .def_prop_ro("has_energy", [](const LawAtPoints &law) { return law.kernel().has_energy; })
        .def_prop_ro("splits", &LawAtPoints::splits);
    m.def("law_names", [] {
        std::vector<std::string> names;
        for (const bezsoma::LawName &law : bezsoma::law_names)
            names.emplace_back(law.name);
        return names;
    });
    nb::class_<Pointwise>(m, "Pointwise")
        .def(nb::init<const Walk &, const std::vector<const LawAtPoints *> &, In<double, -1, 4>,
                      In<double, -1>, In<double, -1, -1>, std::size_t, const std::string &, bool,
                      int, std::optional<Pointwise::First>>(),
             "walk"_a, "laws"_a, "points"_a, "weights"_a, "values"_a, "threads"_a = 0,
             "instructions"_a = "", "single"_a = false, "pressure_degree"_a = 0,
             "first_pressure"_a = nb::none())
        .def("forces", &Pointwise::forces, "u"_a, "f"_a)
        .def("tangent", &Pointwise::tangent, "u"_a, "du"_a, "df"_a)
        .def("tangent_single", &Pointwise::tangent_single, "u"_a, "du"_a, "df"_a)
        .def("energy", &Pointwise::energy, "u"_a)
        .def("mixed_forces", &Pointwise::mixed_forces, "u"_a, "p"_a, "f"_a, "g"_a)
        .def("mixed_tangent", &Pointwise::mixed_tangent, "u"_a, "p"_a, "du"_a, "dp"_a, "df"_a,
             "dg"_a)
        .def("mixed_energy", &Pointwise::mixed_energy, "u"_a, "p"_a)
        .def_prop_ro("bytes", &Pointwise::bytes)
        .def_prop_ro("least_jacobian", &Pointwise::least_jacobian)
        .def_prop_ro("greatest_exponent", &Pointwise::greatest_exponent)
        .def_prop_ro("instructions", &Pointwise::instructions)
        .def_prop_ro("threads", &Pointwise::threads);
    m.def("instruction_sets", [] {
        std::vector<std::string> found;
        for (const char *name : {"avx512", "avx2", "baseline"})
            if (bezsoma::kernels_named(name))
                found.emplace_back(name);
        return found;
    });
}
