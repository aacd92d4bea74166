// SPDX-License-Identifier: BSD-3-Clause
// What the bindings share: arrays as they come and go, refusals, and the walk over the tets. Only
// bindings*.cpp include it; they alone know Python.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "bindings_interpreter.hpp"
#include "elastic_operator.hpp"
#include "kernels.hpp"

namespace bezsoma {

namespace nb = nanobind;

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

inline void require(bool holds, const char *what) {
    if (!holds)
        throw nb::value_error(what);
}

/// Whether all numbers are at least 0 and below a count.
bool within(const auto &numbers, std::size_t count) {
    return std::all_of(numbers.data(), numbers.data() + numbers.size(),
                       [=](auto i) { return i >= 0 && static_cast<std::size_t>(i) < count; });
}

/// How many controls there are where each run begins as the walk first touches it; -1 where not.
inline std::int64_t numbered_by_walk(int degree, const In<std::int32_t, -1, -1> &first) {
    std::int64_t next = 0;
    const std::size_t per_tet = first.shape(1);
    for (std::size_t i = 0; i < first.size(); ++i) {
        const std::int32_t run = first.data()[i];
        if (run < 0 || run > next)
            return -1;
        if (run == next)
            next += controls_inside(degree, static_cast<int>(i % per_tet));
    }
    return next;
}

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

    ElasticTets tets() const {
        require(degree >= 1 && degree <= 10, "degree must be 1 to 10");
        require(best_kernels().f64[degree - 1].apply != nullptr,
                "this build of the core lacks the kernels of that degree");
        require(first.is_valid(),
                "this walk has given its numbering to the preconditioner that was made of it; make "
                "another walk of the same tets");
        require(first.shape(1) == static_cast<std::size_t>(entities_of_tet(degree)),
                "first must have a column for each entity that holds controls");
        const std::size_t tets = corners.shape(0);
        require(tets > 0 && first.shape(0) == tets && order.shape(0) == tets &&
                    region.shape(0) == tets,
                "first, order, corners and region must have one row a tet");
        require(within(order, tets) && within(corners, points.shape(0)) &&
                    within(region, lame.shape(0)),
                "order, corners and region must number tets, points and rows of lame");
        require(numbered_by_walk(degree, first) > 0,
                "first numbers the controls in another order than that in which the walk first "
                "meets them; give first and order of one net (net.walked(), net.morton)");
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

/// Threads of Python take turns: an operator has one team and one scratch space. Wait for a turn
/// without the interpreter, which whoever has it may need. Who is told of an iteration has the turn
/// and may use the operator too: nothing of it is in use between two jobs. A signal's handler is
/// called in the midst of one; it has the turn as well, and the team refuses it.
using Turn = std::lock_guard<std::recursive_mutex>;

/// Lets Python's signal handlers run: Ctrl-C in the middle of a computation.
inline void listen_to_signals() {
    const Inside held;
    if (PyErr_CheckSignals() != 0)
        throw nb::python_error();
}

/// The widest instruction set for an empty name.
inline const Kernels &kernels_of(const std::string &instructions) {
    const Kernels *found =
        instructions.empty() ? &best_kernels() : kernels_named(instructions.c_str());
    require(found != nullptr, "this processor or build lacks that instruction set");
    return *found;
}

/// Adds laws at points and their operator to the module.
void bind_laws(nb::module_ &m);

/// Adds the preconditioner that stands by itself.
void bind_inverse(nb::module_ &m);

} // namespace bezsoma
