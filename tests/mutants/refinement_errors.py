# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors in estimates, refinement and the solves that start from an earlier one."""

from __future__ import annotations

from mutants.mutant import Mutant

REFINEMENT = "src/bezsoma/refinement"
SOLVERS = "src/bezsoma/solvers"
BISECTION = ("tests/laws/test_bisection.py",)
STARTS = ("tests/laws/test_start.py",)

REFINING = (
    Mutant(
        "an error that is believed to end where two degrees see it",
        f"{REFINEMENT}/saturation.py",
        "told = second + (second - first) * (1 - two) / (two - one)",
        "told = second",
        ("src/bezsoma/refinement/saturation.py",),
    ),
    Mutant(
        "an energy estimate without what two degrees do not see",
        f"{REFINEMENT}/estimates.py",
        "richer.gain / _seen(_rate(richer), richer)",
        "richer.gain",
        ("tests/laws/test_estimates.py::test_beside_a_singular_edge",),
    ),
    Mutant(
        "a dual that is believed to come as fast as the displacement",
        f"{REFINEMENT}/estimates.py",
        "_fall(duals[0].energy, last.energy, richer)",
        "_fall(richer.between.gain, richer.gain, richer)",
        (
            "tests/laws/test_estimates.py::test_a_patch_smaller_than_the_tets_has_a_dual_that_comes_slowly",
        ),
    ),
    Mutant(
        "an energy that forgets what the loose solve left",
        f"{REFINEMENT}/raised.py",
        'energy + float(np.einsum("i,i->", left, x))',
        "energy",
        ("tests/laws/test_estimates.py::test_an_energy_is_wrong_by_that_of_what_was_left_alone",),
    ),
    Mutant(
        "forces of a tet whose controls stand in another order",
        f"{REFINEMENT}/products.py",
        "columns = np.lexsort((rank, part))",
        "columns = np.arange(len(part))",
        ("tests/laws/test_products.py",),
    ),
    Mutant(
        "a goal that forgets what the loose solve left",
        f"{REFINEMENT}/estimates.py",
        'change = np.einsum("i,i->", load, of.correction) + np.einsum("i,i->", dual, of.left)',
        'change = np.einsum("i,i->", load, of.correction)',
        ("tests/laws/test_estimates.py::test_what_a_loose_solve_leaves_counts_by_the_dual",),
    ),
    Mutant(
        "a dual of the solution's degree that is as loose as the others",
        f"{REFINEMENT}/raised.py",
        "np.where(self.held, 0.0, load), TIGHT)",
        "np.where(self.held, 0.0, load), LOOSE)",
        ("tests/laws/test_products.py",),
    ),
    Mutant(
        "prescribed functions that are not taken anew in the higher degree",
        f"{REFINEMENT}/raised.py",
        "start = np.where(known.mask, known.values, written)",
        "start = np.where(known.mask, written, written)",
        ("tests/laws/test_estimates.py::test_a_known_displacement",),
    ),
    Mutant(
        "a mixed product with the pressure's work of the wrong sign",
        f"{REFINEMENT}/products.py",
        "T += (lam * trace - p)",
        "T += (lam * trace + p)",
        ("tests/laws/test_products.py",),
    ),
    Mutant(
        "a patch that reaches over to what it does not touch",
        f"{REFINEMENT}/means.py",
        "rows[part == part[np.flatnonzero(inside == own)[0]]]",
        "rows",
        ("tests/laws/test_goals.py::test_a_patch_is_one_piece",),
    ),
    Mutant(
        "a jump between supports that goes unsaid",
        f"{REFINEMENT}/singular.py",
        "return jump if jump > SAME * size else 0.0",
        "return 0.0",
        ("tests/laws/test_estimates.py::test_what_has_no_finite_energy_is_said",),
    ),
    Mutant(
        "children of planar tets never flagged",
        f"{REFINEMENT}/bisection.py",
        "self.flagged = _replaced(self.flagged, rows, planar & ~flagged, planar & ~flagged)",
        "self.flagged = _replaced(self.flagged, rows, planar & False, planar & False)",
        BISECTION,
    ),
    Mutant(
        "a face cut beside its newest vertex",
        f"{REFINEMENT}/bisection.py",
        "_OPENED = np.array([(0, 1, 2), (0, 2, 1), (1, 2, 0)])",
        "_OPENED = np.array([(0, 1, 2), (0, 2, 1), (2, 0, 1)])",
        BISECTION,
    ),
    Mutant(
        "only the tets at new vertices of the last cut looked at, not all with two ends",
        f"{REFINEMENT}/bisection.py",
        "near = np.flatnonzero(ends[self.corners].sum(axis=1) > 1)",
        "near = np.flatnonzero(ends[self.corners].sum(axis=1) > 2)",
        BISECTION,
    ),
    Mutant(
        "corners of a half not in the ascending order of its tet",
        f"{REFINEMENT}/bisection.py",
        "within = np.take_along_axis(work.within, order[:, :, None], axis=1)",
        "within = work.within",
        BISECTION,
    ),
    Mutant(
        "one tet too few for the bulk",
        f"{REFINEMENT}/marking.py",
        "(1 - 1e-12))) + 1",
        "(1 - 1e-12)))",
        ("src/bezsoma/refinement/marking.py", "tests/laws/test_refined.py"),
    ),
    Mutant(
        "a tolerance that any of several places may meet",
        f"{REFINEMENT}/levels.py",
        "return max((each.error for each in self.at), default=0.0)",
        "return min((each.error for each in self.at), default=0.0)",
        ("tests/laws/test_refined.py",),
    ),
    Mutant(
        "a start that loosens the residual it is judged by",
        f"{SOLVERS}/saddle.py",
        "part = 1.0 if against is None else",
        "part = 1.0 if against is not None else",
        STARTS,
    ),
    Mutant(
        "Newton started from rest although it has a start",
        f"{SOLVERS}/load_steps.py",
        "begin = np.where(system.held, system.given(1.0), start)",
        "begin = np.where(system.held, system.given(1.0), x)",
        STARTS,
    ),
)
