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
READING = ("tests/laws/test_imaging_reading.py",)
LABELS = ("tests/laws/test_imaging_labels.py::test_labels_meet_the_truth[touching, noisy]",)
LOADS = ("tests/laws/test_loads.py", "tests/paper/test_equations.py")
MIXED = ("tests/laws/test_mixed.py",)
PRESSURE = ("tests/paper/test_mixed_equations.py", "tests/twins/test_taylor_hood.py")
SOLVES = ("src/bezsoma/equations", "src/bezsoma/solvers", "tests/paper/test_equations.py")

PYTHON = (
    Mutant(
        "a following pressure whose change forgets one of its two directions",
        f"{EQUATIONS}/following.py",
        "sides = ((spin_t, by_s, 1.0), (spin_s, by_t, -1.0))",
        "sides = ((spin_t, by_s, 1.0), (spin_s, by_t, -0.0))",
        ("tests/laws/test_newton.py",),
    ),
    Mutant(
        "a support that turns on the straight way to its end",
        f"{MECHANICS}/path.py",
        "angle=fraction * support.angle",
        "angle=support.angle",
        ("src/bezsoma/mechanics/path.py", "tests/laws/test_newton.py"),
    ),
    Mutant(
        "Cauchy stress that is not divided by J",
        f"{EQUATIONS}/stress.py",
        "np.swapaxes(F, -1, -2) / np.linalg.det(F)[..., None, None])",
        "np.swapaxes(F, -1, -2))",
        ("tests/laws/test_newton.py",),
    ),
    Mutant(
        "balance judged by the correction alone",
        f"{SOLVERS}/newton.py",
        "not moving and residual <= rule.rtol and energy <= rule.rtol",
        "not moving and energy <= rule.rtol",
        ("tests/laws/test_newton.py", "tests/laws/test_paths.py"),
    ),
    Mutant(
        "the secant of the stiffening law without its growth in volume",
        f"{MECHANICS}/stiffening.py",
        "volume = kappa_part[..., None, None] * kappa * trace",
        "volume = kappa * trace",
        ("tests/laws/test_material_laws.py",),
    ),
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
        "a symmetric rule that forgets the mirror images of its points",
        f"{BERNSTEIN}/quadrature.py",
        "orbit = sorted(set(permutations(point)))",
        "orbit = sorted({(*point[i:], *point[:i]) for i in range(len(point))})",
        ("tests/laws/test_bernstein_quadrature.py",),
    ),
    Mutant(
        "the smallest rule in the table, exact enough or not",
        f"{BERNSTEIN}/quadrature.py",
        "if d == dim and p >= exactness]",
        "if d == dim and p >= exactness - 1]",
        ("tests/laws/test_bernstein_quadrature.py",),
    ),
    Mutant(
        "two edges of a face exchanged, so that neighbours disagree",
        f"{MESH}/control_net.py",
        "EDGES_OF_FACES = np.array([(3, 4, 5), (1, 2, 5), (0, 2, 4), (0, 1, 3)])",
        "EDGES_OF_FACES = np.array([(3, 4, 5), (1, 2, 5), (0, 4, 2), (0, 1, 3)])",
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
        "return resultants(equations.net, equations.of_support, -equations.residual(u))",
        "return resultants(equations.net, equations.of_support, equations.residual(u))",
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
        f"{MESH}/control_net.py",
        "runs = self._starts_of(3, self.morton[part])",
        "runs = self._starts_of(3, part)",
        MATRIX_FREE,
    ),
    Mutant(
        "the edges of a face taken from a wrong face of its tet",
        f"{MESH}/control_net.py",
        "EDGES_OF_FACES[local]",
        "EDGES_OF_FACES[3 - local]",
        ("tests/laws/test_control_net.py",),
    ),
    Mutant(
        "facets of a surface that keep the numbers from before points were dropped",
        f"{MESH}/places.py",
        """members(numbers(renumbered[rows], faces), rows, name, "surface", why)
    return frozen(renumbered[rows])""",
        """members(numbers(renumbered[rows], faces), rows, name, "surface", why)
    return frozen(rows)""",
        ("tests/laws/test_mesh_tets.py",),
    ),
    Mutant(
        "a direct solve told to need half of what it takes",
        f"{SOLVERS}/memory.py",
        "int(22 * (3 * net.count)",
        "int(9 * (3 * net.count)",
        ("tests/laws/test_memory.py::test_the_estimate_is_right_within_a_factor",),
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
        "a level of the pressure that is never open",
        f"{EQUATIONS}/level.py",
        "out = parts.flux[np.flatnonzero(~held.ravel())] / size",
        "out = parts.flux / size",
        MIXED,
    ),
    Mutant(
        "compressible tissue that does not determine a level",
        f"{EQUATIONS}/level.py",
        "rigid = np.setdiff1d(label, label[soft])",
        "rigid = np.unique(label)",
        MIXED,
    ),
    Mutant(
        "a net flux that goes unseen",
        f"{EQUATIONS}/level.py",
        "if abs(flux) > FLUX * whole:",
        "if abs(flux) > 1e6 * FLUX * whole:",
        ("tests/faults/test_mixed.py",),
    ),
    Mutant(
        "a mean that counts controls in place of volume",
        f"{EQUATIONS}/level.py",
        "means = np.repeat(net.mesh.volumes / m, m)",
        "means = np.full(net.of_tet.size, 1.0)",
        ("tests/laws/test_mixed.py", "tests/twins/test_taylor_hood.py"),
    ),
    Mutant(
        "a deviatoric strain that keeps half of the volume",
        f"{EQUATIONS}/mixed.py",
        "np.stack([-2 / 3 * G, G], axis=1)",
        "np.stack([-1 / 2 * G, G], axis=1)",
        PRESSURE,
    ),
    Mutant(
        "a pressure that is positive in tension",
        f"{EQUATIONS}/mixed.py",
        "weights = -mesh.volumes[:, None, None] * mesh.gradients",
        "weights = mesh.volumes[:, None, None] * mesh.gradients",
        PRESSURE,
    ),
    Mutant(
        "kappa where its reciprocal belongs",
        f"{MECHANICS}/materials.py",
        "return 3 * (1 - 2 * self.nu) / self.E",
        "return 3 * (1 - self.nu) / self.E",
        PRESSURE,
    ),
    Mutant(
        "the stress without its pressure elevated",
        f"{EQUATIONS}/stress.py",
        'found -= np.einsum("ab,tb->ta", raised, pressure.of_tet)[..., None, None] * np.eye(3)',
        'found += np.einsum("ab,tb->ta", raised, pressure.of_tet)[..., None, None] * np.eye(3)',
        PRESSURE,
    ),
    Mutant(
        "the second order of a volume change with the wrong sign",
        f"{EQUATIONS}/volume.py",
        "trace + (trace**2 - square) / 2 + cubic",
        "trace - (trace**2 - square) / 2 + cubic",
        MIXED,
    ),
    Mutant(
        "pairs of equal degree let through",
        f"{MECHANICS}/pairs.py",
        "if not 1 <= given <= degree - 1:",
        "if not 1 <= given <= degree:",
        ("tests/faults/test_mixed.py",),
    ),
    Mutant(
        "tets locked that are not looked at",
        f"{EQUATIONS}/locked.py",
        "return np.flatnonzero(whole[net.of_vertices(net.mesh.tets)].all(axis=1))",
        "return np.flatnonzero(whole[net.of_vertices(net.mesh.tets[:, :0])].any(axis=1))",
        ("tests/laws/test_mixed.py", "tests/faults/test_mixed.py"),
    ),
    Mutant(
        "a torn mesh that holds together",
        "src/bezsoma/mesh/torn.py",
        "keys = mesh.tets * len(mesh.regions) + mesh.region[:, None]",
        "keys = mesh.tets * len(mesh.regions)",
        ("tests/laws/test_mixed.py", "tests/cases/test_incompressible.py"),
    ),
    Mutant(
        "fluxes scaled for their size and not scaled back",
        f"{EQUATIONS}/level.py",
        "_plain(modes / size[:, None])",
        "_plain(modes)",
        MIXED,
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

IN_CI = (*PYTHON, *CPP[:3])
ALL = (*PYTHON, *CPP)
