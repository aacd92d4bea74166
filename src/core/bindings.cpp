// SPDX-License-Identifier: BSD-3-Clause
// The one file that knows Python. It checks shapes, releases the interpreter and calls the kernels.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "block_csr.hpp"
#include "cholesky.hpp"
#include "elasticity.hpp"
#include "simplex.hpp"

namespace nb = nanobind;

namespace {

template <typename T, long... shape>
using In = nb::ndarray<const T, nb::shape<shape...>, nb::c_contig, nb::device::cpu>;
template <typename T, long... shape>
using Out = nb::ndarray<nb::numpy, T, nb::shape<shape...>, nb::c_contig, nb::device::cpu>;
using Vectors = nb::ndarray<double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

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
}
