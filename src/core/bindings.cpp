// SPDX-License-Identifier: BSD-3-Clause
// With its bindings_*.cpp the one place that knows Python. They check shapes, release the
// interpreter and call the kernels.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "bindings_inverse.hpp"

#include "aggregation.hpp"
#include "block_csr.hpp"
#include "cholesky.hpp"
#include "conjugate_gradients.hpp"
#include "elastic_operator.hpp"
#include "elasticity.hpp"
#include "mixed_operator.hpp"
#include "preconditioner.hpp"
#include "saddle.hpp"
#include "shape.hpp"
#include "simplex.hpp"
#include "topology.hpp"
#include "vertex_matrix.hpp"

namespace nb = nanobind;

namespace {

using bezsoma::handed_over, bezsoma::In, bezsoma::Out, bezsoma::require, bezsoma::Vectors,
    bezsoma::Walk, bezsoma::listen_to_signals, bezsoma::numbered_by_walk, bezsoma::Scalars,
    bezsoma::Turn, bezsoma::Corners, bezsoma::Inverse, bezsoma::Outside, bezsoma::Report;

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
        const Outside released;
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
        const Outside released;
        bezsoma::Team alone(1);
        alone.watch(listen_to_signals);
        where = bezsoma::pattern(of_tet.data(), of_tet.shape(0), of_tet.shape(1), controls, alone);
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
        const Outside released;
        const bezsoma::Elements elements{of_tet.shape(0), of_tet.data(), gradients.data(),
                                         volumes.data(),  lambda.data(), mu.data()};
        const bezsoma::Rows where = rows(start, column);
        bezsoma::Team team(threads, where.rows / bezsoma::rows_assembled);
        team.watch(listen_to_signals);
        bezsoma::assemble(bezsoma::stiffness(degree), elements, where, team, blocks.data());
    }
    return handed_over<double, -1, 3, 3>(std::move(blocks), {column.shape(0), 3, 3});
}

void multiply(In<std::int64_t, -1> start, In<std::int32_t, -1> column, In<double, -1, 3, 3> blocks,
              In<double, -1, 3> x, Vectors y, std::size_t threads) {
    const bezsoma::Rows where = rows(start, column);
    require(x.shape(0) == where.rows && y.shape(0) == where.rows,
            "x and y must have one row a control");
    const Outside released;
    bezsoma::Team team(threads, where.rows / bezsoma::rows_multiplied);
    bezsoma::multiply(where, blocks.data(), x.data(), team, y.data());
}

auto incomplete_cholesky(In<std::int64_t, -1> start, In<std::int32_t, -1> column,
                         In<double, -1, 3, 3> blocks, In<bool, -1, 3> held, double shift,
                         double least) {
    const bezsoma::Rows where = rows(start, column);
    require(held.shape(0) == where.rows, "held must have one row a control");
    bezsoma::Factor f;
    {
        const Outside released;
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
    const Outside released;
    bezsoma::solve_cholesky({where, below.data(), inverse.data()}, r.data(), z.data());
}

// ------------------------------------------------------------------ topology

using TetCorners = In<std::int64_t, -1, 4>;

/// Work that one thread does and Ctrl-C stops, outside of the interpreter.
template <class Work> auto interruptible(const Work &work) {
    const Outside released;
    bezsoma::Team alone(1);
    alone.watch(listen_to_signals);
    return work(alone);
}

std::int64_t rows_of(const auto &array) { return static_cast<std::int64_t>(array.shape(0)); }

auto orientations(In<double, -1, 3> points, TetCorners tets, double flat, double largest) {
    auto found = interruptible([&](bezsoma::Team &team) {
        return bezsoma::orientations(points.data(), tets.data(), rows_of(tets), flat, largest,
                                     team);
    });
    return handed_over<std::int8_t, -1>(std::move(found), {tets.shape(0)});
}

auto simplices(TetCorners tets, std::int64_t vertices, int width) {
    require(width == 2 || width == 3, "width is 2 for edges and 3 for faces");
    const std::size_t per_tet = width == 2 ? 6 : 4;
    require(vertices <= std::numeric_limits<std::int32_t>::max() &&
                per_tet * tets.shape(0) <= std::numeric_limits<std::int32_t>::max(),
            "more than 2^31 - 1 vertices, edges or faces of tets do not fit 32-bit numbers");
    auto found = interruptible([&](bezsoma::Team &team) {
        return bezsoma::simplices({rows_of(tets), tets.data(), vertices}, width, team);
    });
    const auto wide = static_cast<std::size_t>(width);
    const std::size_t count = found.rows.size() / wide;
    return nb::make_tuple(
        handed_over<std::int32_t, -1, -1>(std::move(found.rows), {count, wide}),
        handed_over<std::int32_t, -1, -1>(std::move(found.of_tet), {tets.shape(0), per_tet}));
}

auto neighbours(In<std::int32_t, -1, 4> faces_of_tet, std::int64_t faces,
                In<std::int8_t, -1> sign) {
    require(sign.shape(0) == faces_of_tet.shape(0), "sign must have one number a tet");
    auto found = interruptible([&](bezsoma::Team &team) {
        return bezsoma::neighbours(faces_of_tet.data(), rows_of(faces_of_tet), faces, sign.data(),
                                   team);
    });
    const std::size_t rows = found.pairs.size() / 2;
    return nb::make_tuple(handed_over<std::int32_t, -1, 2>(std::move(found.pairs), {rows, 2}),
                          found.sound);
}

auto components(In<std::int32_t, -1, 2> pairs, std::int64_t tets) {
    auto found = interruptible([&](bezsoma::Team &team) {
        return bezsoma::components(pairs.data(), rows_of(pairs), tets, team);
    });
    return handed_over<std::int32_t, -1>(std::move(found), {static_cast<std::size_t>(tets)});
}

auto numbers_among(In<std::int64_t, -1, -1> rows, In<std::int32_t, -1, -1> among) {
    require(rows.shape(1) == among.shape(1), "rows and among must have the same width");
    auto found = bezsoma::numbers_among(rows.data(), rows_of(rows), among.data(), rows_of(among),
                                        static_cast<int>(rows.shape(1)));
    return handed_over<std::int64_t, -1>(std::move(found), {rows.shape(0)});
}

std::int64_t sort_rows(nb::ndarray<std::int64_t, nb::shape<-1, -1>, nb::c_contig> rows) {
    return interruptible([&](bezsoma::Team &team) {
        return bezsoma::sort_rows(rows.data(), rows_of(rows), static_cast<int>(rows.shape(1)),
                                  team);
    });
}

auto first_controls(In<std::int64_t, -1> order, TetCorners tets,
                    std::optional<In<std::int32_t, -1, 6>> edges_of_tet,
                    std::optional<In<std::int32_t, -1, 4>> faces_of_tet,
                    std::array<std::int64_t, 4> counts, std::array<std::int64_t, 4> inside) {
    require(order.shape(0) == tets.shape(0) &&
                (inside[1] == 0 || (edges_of_tet && edges_of_tet->shape(0) == tets.shape(0))) &&
                (inside[2] == 0 || (faces_of_tet && faces_of_tet->shape(0) == tets.shape(0))),
            "order, edges_of_tet and faces_of_tet must have one row a tet");
    auto found = interruptible([&](bezsoma::Team &team) {
        return bezsoma::first_controls({tets.data(), edges_of_tet ? edges_of_tet->data() : nullptr,
                                        faces_of_tet ? faces_of_tet->data() : nullptr},
                                       order.data(), rows_of(tets), counts, inside, team);
    });
    const std::size_t count = found.size();
    return handed_over<std::int64_t, -1>(std::move(found), {count});
}

// ------------------------------------------------------------------ without a matrix

/// K of one body without a matrix in one precision, its threads, and the kernels of one
/// instruction set. What it was made from is not kept.
class MatrixFree {
public:
    MatrixFree(const Walk &walk, std::size_t threads, const std::string &instructions, bool single)
        : team_(threads), kernels_(&bezsoma::kernels_of(instructions)) {
        const bezsoma::ElasticTets tets = walk.tets();
        team_.watch(listen_to_signals);
        const Outside released;
        if (single)
            single_ = std::make_unique<bezsoma::ElasticOperator<float>>(tets, *kernels_, team_);
        else
            double_ = std::make_unique<bezsoma::ElasticOperator<double>>(tets, *kernels_, team_);
    }

    void apply(In<double, -1, 3, -1> x, nb::ndarray<double, nb::shape<-1, 3, -1>, nb::c_contig> y) {
        apply_to(form(), x, y);
    }

    void apply_single(In<float, -1, 3, -1> x,
                      nb::ndarray<float, nb::shape<-1, 3, -1>, nb::c_contig> y) {
        require(single_ != nullptr, "this operator was made for float64");
        apply_to(*single_, x, y);
    }

    double work(In<double, -1, 3> x) {
        require(static_cast<std::int64_t>(x.shape(0)) == form().controls(),
                "x must have one row a control");
        const Outside released;
        const Turn turn(turn_);
        return form().work(x.data());
    }

    bezsoma::ElasticOperator<double> &form() {
        require(double_ != nullptr, "this operator was made for float32");
        return *double_;
    }
    bezsoma::Team &team() { return team_; }
    std::recursive_mutex &turn() { return turn_; }
    const bezsoma::Kernels &kernels() const { return *kernels_; }

private:
    template <class Operator, class X, class Y> void apply_to(Operator &k, const X &x, const Y &y) {
        require(static_cast<std::int64_t>(x.shape(0)) == k.controls() && y.shape(0) == x.shape(0) &&
                    y.shape(2) == x.shape(2) && x.shape(2) > 0,
                "x and y must have one row a control and as many sides");
        require(x.data() + x.size() <= y.data() || y.data() + y.size() <= x.data(),
                "x and y must not share memory: y is written while x is still read");
        const int sides = static_cast<int>(x.shape(2));
        const Outside released;
        const Turn turn(turn_);
        k.apply(x.data(), y.data(), sides);
    }

    std::recursive_mutex turn_;
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
        : team_(threads), kernels_(&bezsoma::kernels_of(instructions)) {
        const bezsoma::ElasticTets tets = walk.tets();
        require(tets.degree <= bezsoma::highest_mixed_degree && pressure_degree >= 1 &&
                    pressure_degree < tets.degree,
                "degrees must be 2 to 8 beside a pressure of a lower one, 1 at least");
        require(first.shape(0) == walk.first.shape(0) &&
                    first.shape(1) ==
                        static_cast<std::size_t>(bezsoma::entities_of_tet(pressure_degree)),
                "the pressure's first must have a row a tet and a column for each entity");
        require(numbered_by_walk(pressure_degree, first) > 0,
                "the pressure's first numbers its controls in another order than that in which the "
                "walk first meets them; give net.walked() of a net on the same mesh");
        team_.watch(listen_to_signals);
        const Outside released;
        operator_ = std::make_unique<bezsoma::MixedOperator>(
            bezsoma::MixedTets{tets, pressure_degree, first.data()}, *kernels_, team_);
    }

    void apply(In<double, -1, 3> u, In<double, -1> p, Vectors f, Scalars g) {
        require(fits(u, p) && fits(f, g), "u, f and p, g must have one row a control");
        const Outside released;
        const Turn turn(turn_);
        operator_->apply(u.data(), p.data(), f.data(), g.data());
    }

    double work(In<double, -1, 3> u, In<double, -1> p) {
        require(fits(u, p), "u and p must have one row a control");
        const Outside released;
        const Turn turn(turn_);
        return operator_->work(u.data(), p.data());
    }

    void mass(In<double, -1> weight, In<double, -1> p, Scalars g) {
        require(static_cast<std::int64_t>(weight.size()) == operator_->regions() &&
                    static_cast<std::int64_t>(p.size()) == operator_->pressures() &&
                    g.size() == p.size(),
                "weight, p and g must fit the regions and the pressure's controls");
        const std::vector<double> weights(weight.data(), weight.data() + weight.size());
        const Outside released;
        const Turn turn(turn_);
        operator_->on_pressure(&bezsoma::PressureKernel::mass, weights, p.data(), g.data());
    }

    bezsoma::MixedOperator &form() { return *operator_; }
    bezsoma::Team &team() { return team_; }
    std::recursive_mutex &turn() { return turn_; }
    const bezsoma::Kernels &kernels() const { return *kernels_; }

    template <class U, class P> bool fits(const U &u, const P &p) const {
        return static_cast<std::int64_t>(u.shape(0)) == operator_->controls() &&
               static_cast<std::int64_t>(p.shape(0)) == operator_->pressures();
    }

private:
    std::recursive_mutex turn_;
    bezsoma::Team team_;
    const bezsoma::Kernels *kernels_;
    std::unique_ptr<bezsoma::MixedOperator> operator_;
};

auto told(const bezsoma::Convergence &found) {
    return nb::make_tuple(found.history, found.residual, found.converged, found.indefinite,
                          found.rounded);
}

/// The preconditioner of a body with its supports, and the iteration that it serves.
class Multigrid {
public:
    Multigrid(MatrixFree &k, Walk &walk, const std::optional<Corners> &corners,
              In<double, -1, 3> points, In<bool, -1, 3> held, In<bool, -1, 3> held_vertices)
        : k_(k), inverse_(walk, corners, {points, held, held_vertices, k.form().controls()},
                          &k.form().chunks(), k.kernels(), k.team(), k.turn()) {}

    auto solve(In<double, -1, 3> f, Vectors x, double reference, double rtol, int most,
               const nb::callable &report) {
        require(f.size() == inverse_.held.size() && x.size() == inverse_.held.size(),
                "f and x must have one row a control");
        bezsoma::Convergence found;
        {
            const Outside released;
            const Turn turn(k_.turn());
            found = bezsoma::conjugate_gradients(k_.form(), inverse_.search(k_.team()),
                                                 inverse_.held.data(), f.data(), x.data(),
                                                 reference, rtol, most, k_.team(), Report(report));
        }
        return told(found);
    }

    std::vector<std::int64_t> levels() const { return inverse_.aggregation->sizes(); }
    std::size_t bytes() const { return inverse_.bytes(); }

private:
    MatrixFree &k_;
    Inverse inverse_;
};

/// What solves with a MixedFree: its displacement's blocks and multigrid, its pressure's mass.
class Saddle {
public:
    /// The walk's moduli are the lambda and mu of the displacement's preconditioner.
    Saddle(MixedFree &form, Walk &walk, const std::optional<Corners> &corners,
           In<double, -1, 3> points, In<bool, -1, 3> held, In<bool, -1, 3> held_vertices,
           In<double, -1> weight, In<double, -1, -1> levels)
        : form_(form),
          inverse_(walk, corners, {points, held, held_vertices, form.form().controls()},
                   &form.form().chunks(), form.kernels(), form.team(), form.turn()) {
        require(static_cast<std::int64_t>(weight.size()) == form.form().regions() &&
                    levels.shape(1) == static_cast<std::size_t>(form.form().pressures()),
                "weight and levels must fit the regions and the pressure's controls");
        std::vector<double> weights(weight.data(), weight.data() + weight.size());
        std::vector<double> out(levels.data(), levels.data() + levels.size());
        const Outside released;
        const Turn turn(form_.turn());
        pressure_ = std::make_unique<bezsoma::PressureInverse>(form.form(), std::move(weights),
                                                               std::move(out), form.team());
    }

    auto solve(In<double, -1, 3> f, In<double, -1> g, Vectors u, Scalars p, double unit,
               double volume_weight, double rtol, int most, const nb::callable &report) {
        require(form_.fits(f, g) && form_.fits(u, p), "f, u and g, p must have one row a control");
        bezsoma::Convergence found;
        {
            const Outside released;
            const Turn turn(form_.turn());
            bezsoma::Search search = inverse_.search(form_.team());
            found = bezsoma::saddle(
                form_.form(), search, *pressure_,
                {inverse_.held.data(), f.data(), g.data(), unit, volume_weight, rtol, most},
                u.data(), p.data(), form_.team(), Report(report));
        }
        return told(found);
    }

    std::size_t bytes() const { return inverse_.bytes(); }

private:
    MixedFree &form_;
    Inverse inverse_;
    std::unique_ptr<bezsoma::PressureInverse> pressure_;
};

} // namespace

NB_MODULE(_core, m) {
    using namespace nb::literals;
    // Whoever still holds an object when Python ends (a thread, a cache of another package, the
    // frame of an error that was kept) is told of a leak otherwise, in words that help no user.
    // What is held then goes with the process.
    nb::set_leak_warnings(false);
    bezsoma::End::prepare();
    m.doc() = "BezSoma's kernels over flat arrays";
    m.def("element_matrices", &element_matrices, "degree"_a, "gradients"_a, "volumes"_a, "lam"_a,
          "mu"_a);
    m.def("pattern", &pattern, "of_tet"_a, "controls"_a);
    m.def("assembled", &assembled, "degree"_a, "of_tet"_a, "gradients"_a, "volumes"_a, "lam"_a,
          "mu"_a, "starts"_a, "columns"_a, "threads"_a = 0);
    m.def("multiply", &multiply, "starts"_a, "columns"_a, "blocks"_a, "x"_a, "y"_a.noconvert(),
          "threads"_a = 0);
    m.def("incomplete_cholesky", &incomplete_cholesky, "starts"_a, "columns"_a, "blocks"_a,
          "held"_a, "shift"_a, "least"_a);
    m.def("solve_cholesky", &solve_cholesky, "starts"_a, "columns"_a, "below"_a, "inverse"_a, "r"_a,
          "z"_a.noconvert());
    m.def("orientations", &orientations, "points"_a, "tets"_a, "flat"_a, "largest"_a);
    m.def("simplices", &simplices, "tets"_a, "vertices"_a, "width"_a);
    m.def("neighbours", &neighbours, "faces_of_tet"_a, "faces"_a, "sign"_a);
    m.def("components", &components, "pairs"_a, "tets"_a);
    m.def("numbers_among", &numbers_among, "rows"_a, "among"_a);
    m.def("sort_rows", &sort_rows, "rows"_a.noconvert());
    m.def("first_controls", &first_controls, "order"_a, "tets"_a, "edges_of_tet"_a.none(),
          "faces_of_tet"_a.none(), "counts"_a, "inside"_a);
    nb::class_<Walk>(m, "Walk").def(
        nb::init<int, In<std::int32_t, -1, -1>, In<std::int64_t, -1>, In<double, -1, 3>,
                 In<std::int64_t, -1, 4>, In<std::int64_t, -1>, In<double, -1, 2>>(),
        "degree"_a, "first"_a, "order"_a, "points"_a, "corners"_a, "region"_a, "lame"_a);
    nb::class_<MatrixFree>(m, "MatrixFree")
        .def(nb::init<const Walk &, std::size_t, const std::string &, bool>(), "walk"_a,
             "threads"_a = 0, "instructions"_a = "", "single"_a = false)
        .def("apply", &MatrixFree::apply, "x"_a, "y"_a.noconvert())
        .def("work", &MatrixFree::work, "x"_a)
        .def("apply_single", &MatrixFree::apply_single, "x"_a, "y"_a.noconvert())
        .def_prop_ro("instructions", [](const MatrixFree &k) { return k.kernels().name; })
        .def_prop_ro("threads", [](MatrixFree &k) { return k.team().size(); });
    nb::class_<MixedFree>(m, "MixedFree")
        .def(nb::init<const Walk &, int, In<std::int32_t, -1, -1>, std::size_t,
                      const std::string &>(),
             "walk"_a, "pressure_degree"_a, "first"_a, "threads"_a = 0, "instructions"_a = "")
        .def("apply", &MixedFree::apply, "u"_a, "p"_a, "f"_a.noconvert(), "g"_a.noconvert())
        .def("work", &MixedFree::work, "u"_a, "p"_a)
        .def("mass", &MixedFree::mass, "weight"_a, "p"_a, "g"_a.noconvert())
        .def_prop_ro("instructions", [](const MixedFree &k) { return k.kernels().name; })
        .def_prop_ro("threads", [](MixedFree &k) { return k.team().size(); });
    nb::class_<Multigrid>(m, "Multigrid")
        .def(nb::init<MatrixFree &, Walk &, const std::optional<Corners> &, In<double, -1, 3>,
                      In<bool, -1, 3>, In<bool, -1, 3>>(),
             "k"_a, "walk"_a, "corners"_a.none(), "points"_a, "held"_a, "held_vertices"_a,
             nb::keep_alive<1, 2>())
        .def("solve", &Multigrid::solve, "f"_a, "x"_a.noconvert(), "reference"_a, "rtol"_a,
             "most"_a, "report"_a)
        .def_prop_ro("levels", &Multigrid::levels)
        .def_prop_ro("bytes", &Multigrid::bytes);
    nb::class_<Saddle>(m, "Saddle")
        .def(nb::init<MixedFree &, Walk &, const std::optional<Corners> &, In<double, -1, 3>,
                      In<bool, -1, 3>, In<bool, -1, 3>, In<double, -1>, In<double, -1, -1>>(),
             "form"_a, "walk"_a, "corners"_a.none(), "points"_a, "held"_a, "held_vertices"_a,
             "weight"_a, "levels"_a, nb::keep_alive<1, 2>())
        .def("solve", &Saddle::solve, "f"_a, "g"_a, "u"_a.noconvert(), "p"_a.noconvert(), "unit"_a,
             "volume_weight"_a, "rtol"_a, "most"_a, "report"_a)
        .def_prop_ro("bytes", &Saddle::bytes);
    bezsoma::bind_laws(m);
    bezsoma::bind_inverse(m);
    m.def("instruction_sets", [] {
        std::vector<std::string> found;
        for (const char *name : {"avx512", "avx2", "baseline"})
            if (bezsoma::kernels_named(name))
                found.emplace_back(name);
        return found;
    });
}
