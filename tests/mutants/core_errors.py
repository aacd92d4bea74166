# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors in the C++ core."""

from __future__ import annotations

from mutants.mutant import Mutant

CORE = "src/core"
ELEMENT = ("tests/laws/test_element.py", "tests/paper/test_equations.py")
ASSEMBLED = ("tests/laws/test_assembled.py", "tests/paper/test_equations.py")
CHOLESKY = ("tests/laws/test_cholesky.py",)
MATRIX_FREE = ("tests/laws/test_matrix_free.py",)
MIXED_FREE = ("tests/laws/test_mixed_free.py",)
MULTIGRID = ("tests/laws/test_multigrid.py",)
LAWS = ("tests/laws/test_laws_core.py",)
POINTWISE = ("tests/laws/test_pointwise_free.py",)
HARD = ("tests/faults/test_hard_problems.py",)
TEAM = ("tests/faults/test_core.py",)
MESHES = (
    "tests/laws/test_mesh_tets.py",
    "tests/laws/test_mesh_shape.py",
    "tests/faults/test_meshes.py",
)

CPP = (
    Mutant(
        "the mean strain taken out of the deviator twice as often as it should",
        f"{CORE}/mixed_kernel.hpp",
        "swelling * (2.0 / 3.0)",
        "swelling * (4.0 / 3.0)",
        MIXED_FREE,
    ),
    Mutant(
        "a pressure that is not brought back to its own degree",
        f"{CORE}/mixed_kernel.hpp",
        "lower(m, low, trace);",
        "",
        MIXED_FREE,
    ),
    Mutant(
        "the inverse ladder without one of its levels",
        f"{CORE}/mixed_kernel.hpp",
        "left -= b[j] * number(j, i);",
        "left -= b[j] * number(j, j);",
        MIXED_FREE,
    ),
    Mutant(
        "the pressure's load forgotten in the triangular preconditioner",
        f"{CORE}/saddle.cpp",
        "problem_.fixed[i] ? 0.0 : a[i] - loaded[i];",
        "problem_.fixed[i] ? 0.0 : a[i];",
        MIXED_FREE,
    ),
    Mutant(
        "lambda and mu exchanged between the two transposed products",
        f"{CORE}/elasticity.cpp",
        "(lambda * (p[k] * q[l]) + mu * (p[l] * q[k]))",
        "(lambda * (p[l] * q[k]) + mu * (p[k] * q[l]))",
        ELEMENT,
    ),
    Mutant(
        "blocks below the diagonal not transposed as a whole",
        f"{CORE}/elasticity.cpp",
        "{1, 3}, {2, 6}, {5, 7}",
        "{1, 3}, {5, 7}",
        ELEMENT,
    ),
    Mutant(
        "the back substitution with a transposed index",
        f"{CORE}/cholesky.cpp",
        "v[1] -= b[1] * p + b[4] * q + b[7] * t;",
        "v[1] -= b[3] * p + b[4] * q + b[5] * t;",
        CHOLESKY,
    ),
    Mutant(
        "stiffness with the factor n in place of n^2",
        f"{CORE}/elasticity.cpp",
        "all[b], degree * degree, lower_mass",
        "all[b], degree, lower_mass",
        ELEMENT,
    ),
    Mutant(
        "half of the term mu delta_kl tr D",
        f"{CORE}/elasticity.cpp",
        "out[4 * k] += dot;",
        "out[4 * k] += dot / 2;",
        ELEMENT,
    ),
    Mutant(
        "the mean of a product with one dimension too few",
        f"{CORE}/simplex.cpp",
        "binomial(2 * degree + 3, 3)",
        "binomial(2 * degree + 2, 2)",
        ELEMENT,
    ),
    Mutant(
        "the product of matrix and vector with one block index transposed",
        f"{CORE}/block_csr.cpp",
        "y1 += b[3] * v[0]",
        "y1 += b[1] * v[0]",
        ASSEMBLED,
    ),
    Mutant(
        "a tet's rows added for one corner in place of all",
        f"{CORE}/block_csr.cpp",
        "sum[e] += part[e];",
        "sum[e] = part[e];",
        ASSEMBLED,
    ),
    Mutant(
        "the Cholesky factor of a block without one correction",
        f"{CORE}/cholesky.cpp",
        "l21 = (a[7] - l20 * l10) / l11",
        "l21 = a[7] / l11",
        CHOLESKY,
    ),
    Mutant(
        "held components that still pull in the preconditioner",
        f"{CORE}/cholesky.cpp",
        "held_i[r] || held_k[c] ? 0.0",
        "held_i[r] && held_k[c] ? 0.0",
        CHOLESKY,
    ),
    Mutant(
        "what other chunks add to a chunk's controls is dropped",
        f"{CORE}/elastic_operator.cpp",
        "to[i] += from[i];",
        "to[i] += 0 * from[i];",
        MATRIX_FREE,
    ),
    Mutant(
        "a lane that reads its neighbour's controls",
        f"{CORE}/elastic_kernel.hpp",
        "from[l] = place(b.u, b.u_end, first[entity * lanes + l]);",
        "from[l] = place(b.u, b.u_end, first[entity * lanes + l / 2]);",
        MATRIX_FREE,
    ),
    Mutant(
        "forces on shared controls that land among a chunk's own",
        f"{CORE}/elastic_kernel.hpp",
        "(control < 0 ? foreign_end : own) + std::int64_t{control} * row;",
        "(control < -1 ? foreign_end : own) + std::int64_t{control} * row;",
        MATRIX_FREE,
    ),
    Mutant(
        "forces of the call before that are not cleared",
        f"{CORE}/kernels_isa.cpp",
        "k < std::int64_t{b.met[i]} * row; ++k)",
        "k < std::int64_t{b.met[i]} * row - 3; ++k)",
        MATRIX_FREE,
    ),
    Mutant(
        "a force cleared in the tet although another control has added to it",
        f"{CORE}/elastic_kernel.hpp",
        "f[3 * p2 + k] = f[3 * p2 + k] + x",
        "f[3 * p2 + k] = x",
        MATRIX_FREE,
    ),
    Mutant(
        "forces parted to the wrong lane",
        f"{CORE}/elastic_kernel.hpp",
        "parted + l % rows * lanes + l / rows * rows;",
        "parted + l % rows * lanes;",
        MATRIX_FREE,
    ),
    Mutant(
        "an elevation that forgets a neighbour where two are summed first",
        f"{CORE}/elastic_kernel.hpp",
        "other = lower[below[2]] + lower[below[3]];",
        "other = lower[below[2]] + lower[below[2]];",
        MATRIX_FREE,
    ),
    Mutant(
        "a rung of the ladder that forgets one of four neighbours",
        f"{CORE}/elastic_kernel.hpp",
        "lower[p] = (y[p] + y[p1]) + (y[p2] + y[p3]);",
        "lower[p] = (y[p] + y[p1]) + y[p2];",
        MATRIX_FREE,
    ),
    Mutant(
        "the ladder's factors with one binomial in place of its square",
        f"{CORE}/elastic_kernel.hpp",
        "1.0 * combinations(m, j) * combinations(m, j)",
        "1.0 * combinations(m, j)",
        MATRIX_FREE,
    ),
    Mutant(
        "several sides that all take the material of a batch's first tet",
        f"{CORE}/kernels_isa.cpp",
        "tet.mu = R{} + b.lame[2 * b.region[i * lanes + lane] + 1];",
        "tet.mu = R{} + b.lame[2 * b.region[i * lanes] + 1];",
        MATRIX_FREE,
    ),
    Mutant(
        "a block that forgets half of its symmetry",
        f"{CORE}/block_kernel.hpp",
        "y[column] += entry * x[row];",
        "y[column] += 0 * entry * x[row];",
        MULTIGRID,
    ),
    Mutant(
        "lambda and mu exchanged in the blocks of entities",
        f"{CORE}/entity_blocks.cpp",
        "lambda * g[i][k] * g[j][l] + mu * g[j][k] * g[i][l]",
        "mu * g[i][k] * g[j][l] + lambda * g[j][k] * g[i][l]",
        MULTIGRID,
    ),
    Mutant(
        "a rigid motion that aggregation misses",
        f"{CORE}/prolongation.cpp",
        "x[i * motions + k] *= kept ? 1 / length : 0;",
        "x[i * motions + k] *= kept && k != 5 ? 1 / length : 0;",
        MULTIGRID,
    ),
    Mutant(
        "a sweep back that is not the adjoint of the one before",
        f"{CORE}/sweeps.cpp",
        "for (std::size_t i = end; i-- > begin;) {",
        "for (std::size_t i = begin; i < end; ++i) {",
        MULTIGRID,
    ),
    Mutant(
        "convergence believed without forming the true residual",
        f"{CORE}/conjugate_gradients.cpp",
        "found.converged = norm <= rtol * reference * (1 + 1e-6);",
        "found.converged = true;",
        HARD,
    ),
    Mutant(
        "an error in one thread of a team that nobody hears of",
        f"{CORE}/team.cpp",
        "std::rethrow_exception(std::exchange(failure_, nullptr));",
        "failure_ = nullptr;",
        TEAM,
    ),
    Mutant(
        "a fork that waits for threads which its parent has",
        f"{CORE}/team.cpp",
        "        job_ = 0;\n        begin_threads();\n",
        "        job_ = 0;\n",
        TEAM,
    ),
    Mutant(
        "long work that no signal stops",
        f"{CORE}/team.hpp",
        "begin += stretch) {\n        team.ask();\n",
        "begin += stretch) {\n",
        TEAM,
    ),
    Mutant(
        "a fold that goes unseen in a mesh",
        f"{CORE}/topology.cpp",
        "&& side[face] != here;",
        "&& side[face] < 2;",
        MESHES,
    ),
    Mutant(
        "parts joined by faces that are not found to be one",
        f"{CORE}/topology.cpp",
        "parent[size(std::max(a, b))] = std::min(a, b);",
        "parent[size(pairs[2 * f + 1])] = pairs[2 * f];",
        (*MESHES, "tests/faults/test_rigid_motions.py"),
    ),
    Mutant(
        "a flat tet let through because one coordinate is large",
        f"{CORE}/shape.cpp",
        "std::max(flat * length, 4 * eps * coordinate)",
        "flat * length",
        MESHES,
    ),
    Mutant(
        "chunks that depend on the number of threads",
        f"{CORE}/elastic_operator.cpp",
        "tets.tets, controls_of_chunk(tets), team)",
        "tets.tets, most_controls / std::int64_t(team.size()), team)",
        ("tests/laws/test_threads.py::test_a_whole_solve_has_the_same_bits",),
    ),
    Mutant(
        "a dual product that forgets one half of its change",
        f"{CORE}/laws/dual.hpp",
        "return {a.v * b.v, a.v * b.d + a.d * b.v};",
        "return {a.v * b.v, a.v * b.d};",
        LAWS,
    ),
    Mutant(
        "an isochoric energy with a quarter of I1 F^-T where a third belongs",
        f"{CORE}/laws/finite_strain.hpp",
        "const S b = x.trace * T(2.0 / 3);",
        "const S b = x.trace * T(2.0 / 4);",
        LAWS,
    ),
    Mutant(
        "shears counted once in the norm of the strain",
        f"{CORE}/laws/small_strain.hpp",
        "Plain<S>(0.5 * shear * shear)",
        "Plain<S>(0.25 * shear * shear)",
        LAWS,
    ),
    Mutant(
        "a constant kappa where volume stiffens too",
        f"{CORE}/laws/small_strain.hpp",
        "tau[6] = -tr - e[6] * reciprocal(g) * (1 / kappa);",
        "tau[6] = -tr - e[6] * (1 / kappa);",
        LAWS,
    ),
    Mutant(
        "Ogden's tangent by plain differences of nearly equal stretches",
        f"{CORE}/laws/ogden.hpp",
        "const auto close = square < T(0.0025);",
        "const auto close = square < T(0.0);",
        LAWS,
    ),
    Mutant(
        "the shear of fibre and sheet with the stiffness across",
        f"{CORE}/laws/finite_strain.hpp",
        "{par[2], par[3], par[3], par[4], par[3], par[4]}",
        "{par[2], par[3], par[3], par[3], par[3], par[4]}",
        LAWS,
    ),
    Mutant(
        "an exponential with one term too few",
        f"{CORE}/laws/lane_functions.hpp",
        "static constexpr int exp_terms = 13,",
        "static constexpr int exp_terms = 10,",
        LAWS,
    ),
    Mutant(
        "points taken in fours, their weights in the order of the rule",
        f"{CORE}/rule.cpp",
        "static_cast<T>(mean * weights[q])",
        "static_cast<T>(mean * weights[i])",
        POINTWISE,
    ),
    Mutant(
        "all regions of a chunk with the parameters of the first",
        f"{CORE}/pointwise_operator.cpp",
        "b.parameters = parameters_[size(group.region)].data();",
        "b.parameters = parameters_[0].data();",
        POINTWISE,
    ),
    Mutant(
        "the place of the least J by the number of a batch",
        f"{CORE}/pointwise_operator.cpp",
        "x->place = tet_[size(x->place)];",
        "x->place = x->place / lanes_;",
        POINTWISE,
    ),
)
