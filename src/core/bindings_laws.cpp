// SPDX-License-Identifier: BSD-3-Clause
// Laws at points and their operator, for Python.
#include "bindings.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "law.hpp"
#include "mixed_kernels.hpp"
#include "pointwise_operator.hpp"
#include "simplex.hpp"

namespace bezsoma {

namespace {

/// A law of the core by its name, asked at points.
class LawAtPoints {
public:
    using Tensors = In<double, -1, 3, 3>;
    using Numbers = In<double, -1>;

    LawAtPoints(const std::string &name, std::vector<double> parameters,
                const std::string &instructions)
        : law_{law_numbered(name.c_str()), std::move(parameters)},
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

    auto stress(Tensors H) const { return tensors(Answer::stress, H, H); }
    auto derivative(Tensors H, Tensors dH) const { return tensors(Answer::derivative, H, dH); }
    auto energy(Tensors H) const { return energies(H, nullptr); }

    auto mixed_stress(Tensors H, Numbers p) const { return mixed(Answer::stress, H, p, H, p); }
    auto mixed_derivative(Tensors H, Numbers p, Tensors dH, Numbers dp) const {
        return mixed(Answer::derivative, H, p, dH, dp);
    }
    auto mixed_energy(Tensors H, Numbers p) const {
        require(p.shape(0) == H.shape(0), "H and p must have one row a point");
        require_split();
        return energies(H, p.data());
    }

    const Law &law() const { return law_; }
    const LawKernel<double> &kernel() const { return kernels_.pointwise->laws[law_.number]; }
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
    Out<double, -1, 3, 3> tensors(Answer which, const Tensors &H, const Tensors &dH) const {
        require_compressible();
        require(dH.shape(0) == H.shape(0), "H and dH must have one row a point");
        const std::size_t count = H.shape(0);
        std::vector<double> P(9 * count);
        check(answers(law_, kernels_, which, {count, H.data(), nullptr},
                      {count, dH.data(), nullptr}, P.data(), nullptr));
        return handed_over<double, -1, 3, 3>(std::move(P), {count, 3, 3});
    }

    nb::tuple mixed(Answer which, const Tensors &H, const Numbers &p, const Tensors &dH,
                    const Numbers &dp) const {
        const std::size_t count = H.shape(0);
        require(p.shape(0) == count && dH.shape(0) == count && dp.shape(0) == count,
                "H, p, dH and dp must have one row a point");
        require_split();
        std::vector<double> P(9 * count), c(count);
        check(answers(law_, kernels_, which, {count, H.data(), p.data()},
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
        check(answers(law_, kernels_, Answer::energy, {count, H.data(), p}, {count, H.data(), p},
                      W.data(), nullptr));
        return handed_over<double, -1>(std::move(W), {count});
    }

    /// A law asked where it has no answer says so; numbers that are none never leave in silence.
    static void check(const Extremes &seen) {
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

    Law law_;
    const Kernels &kernels_;
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
        const ElasticTets tets = walk.tets();
        require(laws.size() == static_cast<std::size_t>(tets.regions), "one law a region");
        require(values.shape(1) == count(tets.degree - 1) && values.shape(0) == weights.shape(0) &&
                    points.shape(0) == weights.shape(0) && weights.shape(0) > 0,
                "points (q, 4), weights (q,) and values (q, controls of degree - 1) must fit");
        std::optional<PressureNet> pressure;
        if (first) {
            check_pressure(walk, tets, pressure_degree, *first, single);
            pressure = {pressure_degree, first->data()};
        }
        std::vector<Law> own;
        for (const LawAtPoints *law : laws) {
            if (first)
                law->require_split();
            else
                law->require_compressible();
            own.push_back(law->law());
        }
        team_.watch(listen_to_signals);
        const GivenRule rule{static_cast<std::int32_t>(weights.shape(0)), points.data(),
                             weights.data(), values.data()};
        const Outside released;
        if (single)
            single_ = std::make_unique<PointwiseOperator<float>>(tets, pressure, std::move(own),
                                                                 rule, kernels_, team_);
        else
            double_ = std::make_unique<PointwiseOperator<double>>(tets, pressure, std::move(own),
                                                                  rule, kernels_, team_);
    }

    void forces(In<double, -1, 3> u, Vectors f) {
        fits(u.shape(0), f.shape(0), false);
        const Outside released;
        const Turn turn(turn_);
        laws().forces({u.data(), nullptr}, {f.data(), nullptr});
    }

    void tangent(In<double, -1, 3> u, In<double, -1, 3> du, Vectors df) {
        fits(u.shape(0), df.shape(0), false);
        fits(du.shape(0), df.shape(0), false);
        const Outside released;
        const Turn turn(turn_);
        laws().tangent({u.data(), nullptr}, {du.data(), nullptr}, {df.data(), nullptr});
    }

    void tangent_single(In<float, -1, 3> u, In<float, -1, 3> du,
                        nb::ndarray<float, nb::shape<-1, 3>, nb::c_contig> df) {
        require(single_ != nullptr, "this operator was made for float64");
        const auto rows = static_cast<std::size_t>(single_->controls());
        require(u.shape(0) == rows && du.shape(0) == rows && df.shape(0) == rows,
                "displacements and forces must have one row a control");
        const Outside released;
        const Turn turn(turn_);
        single_->tangent({u.data(), nullptr}, {du.data(), nullptr}, {df.data(), nullptr});
    }

    double energy(In<double, -1, 3> u) {
        fits(u.shape(0), u.shape(0), false);
        require_energy();
        const Outside released;
        const Turn turn(turn_);
        return laws().energy({u.data(), nullptr});
    }

    void mixed_forces(In<double, -1, 3> u, In<double, -1> p, Vectors f, Scalars g) {
        fits(u.shape(0), f.shape(0), true);
        fits_pressure(p.shape(0), g.shape(0));
        const Outside released;
        const Turn turn(turn_);
        laws().forces({u.data(), p.data()}, {f.data(), g.data()});
    }

    void mixed_tangent(In<double, -1, 3> u, In<double, -1> p, In<double, -1, 3> du,
                       In<double, -1> dp, Vectors df, Scalars dg) {
        fits(u.shape(0), df.shape(0), true);
        fits(du.shape(0), df.shape(0), true);
        fits_pressure(p.shape(0), dg.shape(0));
        fits_pressure(dp.shape(0), dg.shape(0));
        const Outside released;
        const Turn turn(turn_);
        laws().tangent({u.data(), p.data()}, {du.data(), dp.data()}, {df.data(), dg.data()});
    }

    double mixed_energy(In<double, -1, 3> u, In<double, -1> p) {
        fits(u.shape(0), u.shape(0), true);
        fits_pressure(p.shape(0), p.shape(0));
        require_energy();
        const Outside released;
        const Turn turn(turn_);
        return laws().energy({u.data(), p.data()});
    }

    nb::tuple least_jacobian() { return told(laws().seen().least_J, 1e30); }
    nb::tuple greatest_exponent() { return told(laws().seen().greatest_exponent, -1e30); }
    const char *instructions() const { return kernels_.name; }
    std::size_t threads() const { return team_.size(); }
    std::size_t bytes() const { return single_ ? single_->bytes() : double_->bytes(); }

private:
    static void check_pressure(const Walk &walk, const ElasticTets &tets, int degree,
                               const First &first, bool single) {
        require(!single && tets.degree <= highest_mixed_degree && degree >= 1 &&
                    degree < tets.degree,
                "degrees must be 2 to 8 beside a pressure of a lower one, 1 at least, in float64");
        require(first.shape(0) == walk.first.shape(0) &&
                    first.shape(1) == static_cast<std::size_t>(entities_of_tet(degree)),
                "the pressure's first must have a row a tet and a column for each entity");
        require(numbered_by_walk(degree, first) > 0,
                "the pressure's first numbers its controls in another order than that in which the "
                "walk first meets them; give net.walked() of a net on the same mesh");
    }

    PointwiseOperator<double> &laws() {
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
        for (const Law &law : laws().laws())
            require(kernels_.pointwise->laws[law.number].has_energy,
                    "a law of this body has no energy");
    }

    static nb::tuple told(const Extreme &x, double nothing) {
        const double value = x.value == nothing
                                 ? std::copysign(std::numeric_limits<double>::infinity(), nothing)
                                 : x.value;
        return nb::make_tuple(value, x.place, x.point);
    }

    std::recursive_mutex turn_;
    Team team_;
    const Kernels &kernels_;
    std::unique_ptr<PointwiseOperator<double>> double_;
    std::unique_ptr<PointwiseOperator<float>> single_;
};

} // namespace

void bind_laws(nb::module_ &m) {
    using namespace nb::literals;
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
        .def_prop_ro("splits", &LawAtPoints::splits)
        // Pickled without its instruction set: the widest where it comes back.
        .def("__reduce__", [](const nb::object &self) {
            return nb::make_tuple(self.type(),
                                  nb::make_tuple(self.attr("name"), self.attr("parameters")));
        });
    m.def("law_names", [] {
        std::vector<std::string> names;
        for (const LawName &law : bezsoma::law_names)
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
        .def("forces", &Pointwise::forces, "u"_a, "f"_a.noconvert())
        .def("tangent", &Pointwise::tangent, "u"_a, "du"_a, "df"_a.noconvert())
        .def("tangent_single", &Pointwise::tangent_single, "u"_a, "du"_a, "df"_a.noconvert())
        .def("energy", &Pointwise::energy, "u"_a)
        .def("mixed_forces", &Pointwise::mixed_forces, "u"_a, "p"_a, "f"_a.noconvert(),
             "g"_a.noconvert())
        .def("mixed_tangent", &Pointwise::mixed_tangent, "u"_a, "p"_a, "du"_a, "dp"_a,
             "df"_a.noconvert(), "dg"_a.noconvert())
        .def("mixed_energy", &Pointwise::mixed_energy, "u"_a, "p"_a)
        .def_prop_ro("bytes", &Pointwise::bytes)
        .def_prop_ro("least_jacobian", &Pointwise::least_jacobian)
        .def_prop_ro("greatest_exponent", &Pointwise::greatest_exponent)
        .def_prop_ro("instructions", &Pointwise::instructions)
        .def_prop_ro("threads", &Pointwise::threads);
}

} // namespace bezsoma
