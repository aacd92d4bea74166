// SPDX-License-Identifier: BSD-3-Clause
// The preconditioner, for Python: what a solver without a matrix has beside its operator.
#include "bindings_inverse.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <string>

#include "simplex.hpp"
#include "vertex_matrix.hpp"

namespace bezsoma {

Inverse::Inverse(Walk &walk, const std::optional<Corners> &corners, const Supported &supported,
                 const Chunks *chunks, const Kernels &kernels, Team &team,
                 std::recursive_mutex &turn) {
    const auto &[points, fixed, held_vertices, controls] = supported;
    const ElasticTets tets = walk.tets();
    const auto vertices = static_cast<std::int64_t>(points.shape(0));
    require(corners
                ? corners->shape(0) == walk.corners.shape(0) && within(*corners, points.shape(0))
                : tets.degree == 1,
            ("corners of " + std::to_string(corners ? corners->shape(0) : 0) +
             " tets do not fit a walk over " + std::to_string(walk.corners.shape(0)) +
             " tets and " + std::to_string(vertices) +
             " vertices: a row for each tet has to number its four from 0; at degree 1 alone there "
             "may be none")
                .c_str());
    require(fixed.shape(0) == static_cast<std::size_t>(controls) &&
                held_vertices.shape(0) == points.shape(0) &&
                (corners || fixed.shape(0) == points.shape(0)) &&
                numbered_by_walk(tets.degree, walk.first) == controls,
            ("held of " + std::to_string(fixed.shape(0)) + " controls and held_vertices of " +
             std::to_string(held_vertices.shape(0)) + " vertices do not fit a walk over " +
             std::to_string(controls) + " controls and " + std::to_string(vertices) +
             " vertices: a row (3,) for each is needed, alike at degree 1 where they are the same")
                .c_str());
    held.assign(fixed.data(), fixed.data() + fixed.size());
    const std::vector<std::uint8_t> at_vertices(held_vertices.data(),
                                                held_vertices.data() + held_vertices.size());
    const std::int32_t *rows = corners ? corners->data() : tets.first;
    const Outside released;
    const Turn ours(turn);
    if (tets.degree > 1) {
        std::optional<Chunks> own;
        if (!chunks)
            chunks = &own.emplace(
                bezsoma::chunks(tets.degree, tets.first, tets.tets, controls_of_chunk(tets), team));
        blocks = std::make_unique<Preconditioner>(tets, rows, vertices, held.data(), *chunks,
                                                  kernels, team);
    }
    BlockRows matrix = vertex_matrix(tets, rows, vertices, at_vertices.data(), team);
    {
        const Inside counted;
        walk.first = {};
    }
    aggregation = std::make_unique<Aggregation>(std::move(matrix), points.data(),
                                                at_vertices.data(), *kernels.rows, team);
}

namespace {

/// The preconditioner by itself, for an operator that is none of the linear law: a tangent.
class StandingAlone {
public:
    StandingAlone(Walk &walk, const std::optional<Corners> &corners, In<double, -1, 3> points,
                  In<bool, -1, 3> held, In<bool, -1, 3> held_vertices, std::size_t threads,
                  const std::string &instructions)
        : team_(threads) {
        team_.watch(listen_to_signals);
        const auto controls = static_cast<std::int64_t>(held.shape(0));
        inverse_ = std::make_unique<Inverse>(walk, corners,
                                             Supported{points, held, held_vertices, controls},
                                             nullptr, kernels_of(instructions), team_, turn_);
    }

    /// z = B r.
    template <class T>
    void apply(In<T, -1, 3> r, nb::ndarray<T, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu> z) {
        const auto &held = inverse_->held;
        require(r.size() == held.size() && z.size() == held.size(),
                "r and z must have one row a control");
        const Outside released;
        const Turn turn(turn_);
        inverse_->search(team_).answer(r.data(), z.data(), held.data(), held.size());
    }

    std::size_t bytes() const { return inverse_->bytes(); }
    std::size_t threads() const { return team_.size(); }

private:
    std::recursive_mutex turn_;
    Team team_;
    std::unique_ptr<Inverse> inverse_;
};

} // namespace

void bind_inverse(nb::module_ &m) {
    using namespace nb::literals;
    nb::class_<StandingAlone>(m, "Inverse")
        .def(nb::init<Walk &, const std::optional<Corners> &, In<double, -1, 3>, In<bool, -1, 3>,
                      In<bool, -1, 3>, std::size_t, const std::string &>(),
             "walk"_a, "corners"_a.none(), "points"_a, "held"_a, "held_vertices"_a, "threads"_a = 0,
             "instructions"_a = "")
        .def("apply", &StandingAlone::apply<double>, "r"_a, "z"_a.noconvert())
        .def("apply_single", &StandingAlone::apply<float>, "r"_a, "z"_a.noconvert())
        .def_prop_ro("bytes", &StandingAlone::bytes)
        .def_prop_ro("threads", &StandingAlone::threads);
}

} // namespace bezsoma
