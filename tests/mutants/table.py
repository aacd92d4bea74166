# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors: small, plausible, wrong; each with the tests that have to notice.

`old` stands exactly once in `file`; `tests` are what pytest is given, the quick ones that should
notice. Add a line here with every new formula. Run with ./dev mutants.
"""

from __future__ import annotations

from typing import NamedTuple


class Mutant(NamedTuple):
    """One error: `old` in `file` becomes `new`, and one of `tests` has to fail."""

    what: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    @property
    def is_cpp(self) -> bool:
        """Whether the core has to be built again to see it."""
        return self.file.endswith((".cpp", ".hpp"))


BERNSTEIN, MESH = "src/bezsoma/bernstein", "src/bezsoma/mesh"
MECHANICS, EQUATIONS = "src/bezsoma/mechanics", "src/bezsoma/equations"
SOLVERS, CORE = "src/bezsoma/solvers", "src/core"
IMAGING = "src/bezsoma/imaging"

ELEMENT = ("tests/laws/test_element.py", "tests/paper/test_equations.py")
ASSEMBLED = ("tests/laws/test_assembled.py", "tests/paper/test_equations.py")
CHOLESKY = ("tests/laws/test_cholesky.py",)
MATRIX_FREE = ("tests/laws/test_matrix_free.py",)
MULTIGRID = ("tests/laws/test_multigrid.py",)
HARD = ("tests/faults/test_hard_problems.py",)
READING = ("tests/laws/test_imaging_reading.py",)
LABELS = ("tests/laws/test_imaging_labels.py::test_labels_meet_the_truth[touching, noisy]",)
LOADS = ("tests/laws/test_loads.py", "tests/paper/test_equations.py")
SOLVES = ("src/bezsoma/equations", "src/bezsoma/solvers", "tests/paper/test_equations.py")

PYTHON = (
    Mutant(
        "the derivative of degree n without its factor n",
        f"{BERNSTEIN}/basis.py",
        "np.moveaxis(values(degree - 1, bary), -1, 0) * degree",
        "np.moveaxis(values(degree - 1, bary), -1, 0)",
        ("tests/laws/test_bernstein_values.py",),
    ),
    Mutant(
        "elevation with alpha_i - 1 where alpha_i belongs",
        f"{BERNSTEIN}/nets.py",
        "_column(below[:, i] + 1, lower)",
        "_column(below[:, i], lower)",
        ("tests/laws/test_bernstein_nets.py",),
    ),
    Mutant(
        "the trace on a face that forgets in which order its vertices were given",
        f"{BERNSTEIN}/nets.py",
        "alpha[:, list(vertices)] = on_face",
        "alpha[:, sorted(vertices)] = on_face",
        ("tests/laws/test_bernstein_nets.py",),
    ),
    Mutant(
        "the mass matrix with one of its two binomials dropped",
        f"{BERNSTEIN}/integrals.py",
        "return binomial(total, degree_a) * binomial(total + dim, dim)",
        "return binomial(total + dim, dim)",
        ("tests/laws/test_bernstein_integrals.py",),
    ),
    Mutant(
        "quadrature on a cone without the Jacobian t^(d-1)",
        f"{BERNSTEIN}/quadrature.py",
        "t, along = cone(exactness // 2 + 1, dim)",
        "t, along = cone(exactness // 2 + 1, 1)",
        ("tests/laws/test_bernstein_quadrature.py",),
    ),
    Mutant(
        "two edges of a face exchanged, so that neighbours disagree",
        f"{MESH}/control_net.py",
        "enumerate(((3, 4, 5), (1, 2, 5), (0, 2, 4), (0, 1, 3)))",
        "enumerate(((3, 4, 5), (1, 2, 5), (0, 4, 2), (0, 1, 3)))",
        ("tests/laws/test_control_net.py", "tests/laws/test_fields.py"),
    ),
    Mutant(
        "the gradient of a field without the factor n",
        f"{MESH}/evaluation.py",
        "direction = field.degree * field.mesh.gradients[tets, i]",
        "direction = field.mesh.gradients[tets, i]",
        ("tests/laws/test_fields.py",),
    ),
    Mutant(
        "a point outside a tet taken for one inside",
        f"{MESH}/locator.py",
        "holds = (bary >= -self.slack[candidates]).all(axis=1)",
        "holds = (bary >= -self.slack[candidates]).any(axis=1)",
        ("tests/laws/test_locator.py",),
    ),
    Mutant(
        "lambda with 1 - nu where 1 + nu belongs",
        f"{MECHANICS}/materials.py",
        "(self.nu / ((1 + self.nu) * (1 - 2 * self.nu)))",
        "(self.nu / ((1 - self.nu) * (1 - 2 * self.nu)))",
        ("tests/laws/test_materials.py",),
    ),
    Mutant(
        "stress with mu where 2 mu belongs",
        f"{MECHANICS}/materials.py",
        "2 * self.mu * strain + self.lam",
        "self.mu * strain + self.lam",
        ("tests/laws/test_materials.py",),
    ),
    Mutant(
        "a rotation the wrong way round",
        f"{MECHANICS}/supports.py",
        "np.sin(angle) * K + 2",
        "-np.sin(angle) * K + 2",
        ("tests/laws/test_supports.py",),
    ),
    Mutant(
        "a rotation about the origin instead of the point given",
        f"{MECHANICS}/supports.py",
        "(points - self.about) @ self._minus_identity.T",
        "points @ self._minus_identity.T",
        ("tests/laws/test_supports.py",),
    ),
    Mutant(
        "pressure that pulls",
        f"{EQUATIONS}/forces.py",
        "work = -work * mesh.normals",
        "work = work * mesh.normals",
        LOADS,
    ),
    Mutant(
        "polynomial loads sampled in place of converted into controls",
        f"{EQUATIONS}/forces.py",
        "frozen(closed @ bernstein.interpolation(value_degree, dim))",
        "frozen(closed)",
        LOADS,
    ),
    Mutant(
        "twice the stored energy",
        f"{EQUATIONS}/matrix_free.py",
        "self.kernel.work(np.ascontiguousarray(x)) / 2",
        "self.kernel.work(np.ascontiguousarray(x))",
        SOLVES,
    ),
    Mutant(
        "von Mises' stress without the square root's factor 3/2",
        f"{EQUATIONS}/stress.py",
        "np.sqrt(1.5 * (deviator**2)",
        "np.sqrt((deviator**2)",
        SOLVES,
    ),
    Mutant(
        "the band between two supports graded with a kink",
        f"{EQUATIONS}/grading.py",
        "(1 - s) ** 2 * (1 + 2 * s)",
        "(1 - s) ** 2 * (1 + s)",
        SOLVES,
    ),
    Mutant(
        "a rigid motion that is none: one sign of a rotation",
        f"{EQUATIONS}/rigid.py",
        "[[zero, z, -y], [-z, zero, x], [y, -x, zero]]",
        "[[zero, z, -y], [-z, zero, x], [y, x, zero]]",
        ("tests/laws/test_rigid.py",),
    ),
    Mutant(
        "reactions that push the other way",
        f"{SOLVERS}/solution.py",
        "pull = -equations.residual(u)",
        "pull = equations.residual(u)",
        SOLVES,
    ),
    Mutant(
        "moments with force and arm exchanged",
        f"{SOLVERS}/solution.py",
        "np.cross(points[controls], f)",
        "np.cross(f, points[controls])",
        SOLVES,
    ),
    Mutant(
        "conjugate gradients whose directions are not conjugate",
        f"{SOLVERS}/krylov.py",
        "p *= now / before",
        "p *= 0.5 * now / before",
        ("tests/laws/test_krylov.py",),
    ),
    Mutant(
        "VTK's inner points of a triangle's third edge the wrong way round",
        "src/bezsoma/view/lagrange.py",
        "_TRIANGLE_EDGES = ((0, 1), (1, 2), (2, 0))",
        "_TRIANGLE_EDGES = ((0, 1), (1, 2), (0, 2))",
        ("tests/laws/test_vtk_triangles.py",),
    ),
    Mutant(
        "degrees of a case file taken for radians",
        "src/bezsoma/case/build.py",
        "angle=radians(table.degrees)",
        "angle=table.degrees",
        ("tests/cases/test_block.py",),
    ),
    Mutant(
        "the tets of an operator in the order of the file in place of the walk's",
        f"{EQUATIONS}/matrix_free.py",
        "net.starts[dim][entities[net.morton]].astype(np.int32)",
        "net.starts[dim][entities].astype(np.int32)",
        MATRIX_FREE,
    ),
    Mutant(
        "supports that degree 1 does not see",
        f"{SOLVERS}/multigrid.py",
        "held_vertices[vertices.starts[0]] = held[net.starts[0]]",
        "held_vertices[vertices.starts[0]] = False",
        MULTIGRID,
    ),
    Mutant(
        "rigid motions about places of the wrong vertices",
        f"{SOLVERS}/multigrid.py",
        "places[vertices.starts[0]] = net.mesh.points",
        "places[:] = net.mesh.points",
        MULTIGRID,
    ),
    Mutant(
        "the residual of the recurrence told in place of the true one",
        f"{SOLVERS}/multigrid.py",
        "history[-1] = residual",
        "history[-1] = min(residual, rtol / 2)",
        MULTIGRID,
    ),
    Mutant(
        "a problem twice as large as the memory let through",
        f"{SOLVERS}/memory.py",
        "needed > there:",
        "needed > 2 * there:",
        ("tests/laws/test_memory.py::test_what_fits_just_so_is_not_refused",),
    ),
    Mutant(
        "a number of threads in the environment that goes unheard",
        f"{SOLVERS}/solve.py",
        'os.environ.get("BEZSOMA_THREADS", "0") if asked is None else asked',
        "0 if asked is None else asked",
        ("tests/laws/test_threads.py::test_the_environment_is_heard_and_the_argument_before_it",),
    ),
    Mutant(
        "slices of a tilted gantry moved the wrong way",
        f"{IMAGING}/dicom.py",
        "ndimage.shift(s, o[::-1]",
        "ndimage.shift(s, -o[::-1]",
        READING,
    ),
    Mutant(
        "the spacing of rows taken for that of columns",
        f"{IMAGING}/dicom.py",
        "Frame(np.array([columns, rows, step])",
        "Frame(np.array([rows, columns, step])",
        READING,
    ),
    Mutant(
        "RAS to LPS as a mirror image instead of half a turn",
        f"{IMAGING}/slicer.py",
        "np.array([-1.0, -1, 1])",
        "np.array([-1.0, 1, 1])",
        READING,
    ),
    Mutant(
        "an axis turned over without its origin",
        f"{IMAGING}/volume.py",
        "* (signs < 0)",
        "* (signs > 0)",
        READING,
    ),
    Mutant(
        "partial volume with the sign of the level turned",
        f"{IMAGING}/shapes.py",
        "0.5 - level / ",
        "0.5 + level / ",
        ("src/bezsoma/imaging/shapes.py",),
    ),
    Mutant(
        "bone to where any of it is, not to half-way",
        f"{IMAGING}/bone.py",
        "level_between(values, 0.5,",
        "level_between(values, 0.1,",
        LABELS,
    ),
    Mutant(
        "the mandible by distance alone, not by the widest bridge",
        f"{IMAGING}/jaw.py",
        "np.arange(np.ceil(flat.max() / STEP), -1, -1)",
        "np.arange(0, -1, -1)",
        LABELS,
    ),
    Mutant(
        "a windpipe that is open where the picture ends",
        f"{IMAGING}/head_mask.py",
        "for face in (parts[-1], parts[:, 0]",
        "for face in (parts[0], parts[-1], parts[:, 0]",
        ("tests/laws/test_imaging_labels.py::test_hollows_are_apart_or_tissue_as_stated",),
    ),
)

CPP = (
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
        "std::int64_t{first[entity * lanes + l]} + begin);",
        "std::int64_t{first[entity * lanes + l / 2]} + begin);",
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
        "chunks that depend on the number of threads",
        f"{CORE}/elastic_operator.cpp",
        "std::clamp(expected_controls(tets) / shares,",
        "std::clamp(most_controls / std::int64_t(team.size()),",
        ("tests/laws/test_threads.py::test_a_whole_solve_has_the_same_bits",),
    ),
)

IN_CI = (*PYTHON, *CPP[:3])
ALL = (*PYTHON, *CPP)
