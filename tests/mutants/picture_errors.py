# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors in what comes from pictures and goes into them: CT, tets, views."""

from __future__ import annotations

from mutants.mutant import Mutant

MESH = "src/bezsoma/mesh"
FACE_MESH = "tests/laws/test_face_mesh.py"
LATTICE = "tests/laws/test_lattice.py"
IMAGING = "src/bezsoma/imaging"
EXPERIMENTS = "src/bezsoma/experiments"
READING = ("tests/laws/test_imaging_reading.py",)
LABELS = ("tests/laws/test_imaging_labels.py::test_labels_meet_the_truth[touching, noisy]",)
PARTED = "tests/laws/test_imaging_labels.py::test_coarse_voxels_are_parted_where_bone_is_looked_for"
LEVELS = ("tests/laws/test_levels.py",)
SHOTS = ("tests/laws/test_shots.py",)

PICTURES = (
    Mutant(
        "a slice of a moved body taken where its points came from",
        f"{MESH}/levels.py",
        "plane.heights(net.points + magnified * displacement.controls)",
        "plane.heights(net.points + 0.0 * displacement.controls)",
        LEVELS,
    ),
    Mutant(
        "corners of a contour put where the chord has the level",
        f"{MESH}/marching.py",
        "        if (np.abs(here) <= _NOTHING * scale).all():",
        "        if len(here) or (np.abs(here) <= _NOTHING * scale).all():",
        LEVELS,
    ),
    Mutant(
        "a bound on how far a level strays that is three times too small",
        f"{MESH}/marching.py",
        "return np.asarray(degree * (degree - 1) * total / (8 * parts**2))",
        "return np.asarray(degree * (degree - 1) * total / (24 * parts**2))",
        LEVELS,
    ),
    Mutant(
        "lattice points of neighbouring tets that do not know of each other",
        f"{MESH}/marching.py",
        "vertex = np.where(weight > 0, simplices[:, order[rim, 1:]] + 1, 0)",
        "vertex = simplices[:, order[rim, 1:]] + 1",
        LEVELS,
    ),
    Mutant(
        "a line integral that is half of what it is",
        f"{MESH}/lines.py",
        "weights, each))",
        "weights / 2, each))",
        LEVELS,
    ),
    Mutant(
        "a picture that is off by many pixels where its facets bend",
        "src/bezsoma/view/subject.py",
        "near, side = NEAR / scale, SIDE / scale",
        "near, side = 40 * NEAR / scale, 40 * SIDE / scale",
        ("tests/laws/test_pictures.py::test_the_silhouette_of_a_sphere_is_within_half_a_pixel",),
    ),
    Mutant(
        "points on a smooth edge that have a normal on each side",
        "src/bezsoma/view/surfaces.py",
        "mine[:, rim] = np.where(shared, corners + group.points[:, rim], mine[:, rim])",
        "mine[:, rim] = np.where(shared & False, corners + group.points[:, rim], mine[:, rim])",
        ("tests/laws/test_pictures.py::test_a_block_keeps_its_edges_and_a_ball_loses_them",),
    ),
    Mutant(
        "sides of triangles held against the wrong edges",
        "src/bezsoma/view/tessellation.py",
        "wanted = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2) / longest",
        "wanted = np.linalg.norm(ends[:, ::-1, 1] - ends[:, ::-1, 0], axis=2) / longest",
        ("tests/laws/test_tessellation.py::test_sides_are_no_longer_than_asked_for",),
    ),
    Mutant(
        "an MP4 that plays a second for each frame that should last one of its parts",
        "src/bezsoma/view/movie.py",
        "rate = 1 / Fraction(seconds)",
        "rate = Fraction(seconds)",
        (f"{SHOTS[0]}::test_an_mp4_shows_the_frames_it_was_given",),
    ),
    Mutant(
        "the half of a body that stands before the plane kept",
        "src/bezsoma/view/sections.py",
        "        if facing < 0:",
        "        if facing > 0:",
        SHOTS,
    ),
    Mutant(
        "the viewer walks the other way around",
        "src/bezsoma/view/camera.py",
        "cos * frame + sin * np.cross(axis, frame)",
        "cos * frame - sin * np.cross(axis, frame)",
        ("src/bezsoma/view/camera.py",),
    ),
    Mutant(
        "a face of a cut that moved along, with the normal it had before",
        "src/bezsoma/view/sections.py",
        "F = np.eye(3) + cut.gradient(displacement, inner)",
        "F = np.eye(3) + 0 * cut.gradient(displacement, inner)",
        SHOTS,
    ),
    Mutant(
        "stress yz shown for zx",
        "src/bezsoma/case/fields.py",
        '"yz": 5, "zx": 2',
        '"yz": 2, "zx": 5',
        ("tests/faults/test_looking.py",),
    ),
    Mutant(
        "a net that joins controls two steps apart",
        f"{EXPERIMENTS}/nets_drawn.py",
        "apart == 2",
        "apart == 4",
        (f"{EXPERIMENTS}/nets_drawn.py",),
    ),
    Mutant(
        "a force spread over a quarter of its square",
        f"{EXPERIMENTS}/blocks.py",
        "force / (2 * HALF) ** 2",
        "force / HALF**2",
        ("tests/paper/test_experiments.py::test_a_figure_gives_its_numbers[figure_6]",),
    ),
    Mutant(
        "a tet cut in eight along two diagonals at once",
        f"{EXPERIMENTS}/faces.py",
        "inner = [(ab, ac, ad, bd), (ab, ac, bc, bd)",
        "inner = [(ab, ac, ad, bd), (ab, ac, bc, cd)",
        ("tests/paper/test_experiments.py::test_a_face_in_eighths_is_the_same_body",),
    ),
    Mutant(
        "a page that prints another number than its file",
        f"{EXPERIMENTS}/report.py",
        "{value:.4g}",
        "{value:.3g}",
        ("tests/paper/test_experiments.py::test_a_page_prints_what_its_files_hold",),
    ),
    Mutant(
        "VTK's inner points of a triangle's third edge the wrong way round",
        "src/bezsoma/view/lagrange.py",
        "_TRIANGLE_EDGES = ((0, 1), (1, 2), (2, 0))",
        "_TRIANGLE_EDGES = ((0, 1), (1, 2), (0, 2))",
        ("tests/laws/test_vtk_triangles.py",),
    ),
    Mutant(
        "slices of a tilted gantry moved the wrong way",
        f"{IMAGING}/dicom.py",
        "ndimage.shift(wide, move[::-1]",
        "ndimage.shift(wide, -move[::-1]",
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
        "the densest voxel nearby taken for bone where cortex fills none",
        f"{IMAGING}/bone.py",
        "np.float32(settings.fuller) * dense",
        "np.float32(1) * dense",
        (f"{IMAGING}/bone.py",),
    ),
    Mutant(
        "coarse voxels parted, the values between taken from the wrong end",
        f"{IMAGING}/volume.py",
        "np.float32(k / n) * step",
        "np.float32(1 - k / n) * step",
        (f"{IMAGING}/volume.py",),
    ),
    Mutant(
        "bone of coarse voxels looked for on them as they are",
        f"{IMAGING}/labelling.py",
        "parts = np.ceil(spacing / settings.coarse - 1e-6).astype(int)",
        "parts = np.ones(3, int)",
        (PARTED,),
    ),
    Mutant(
        "a number of tets sought beyond the nearer of two trials, not the farther",
        f"{IMAGING}/tetrahedra.py",
        "part = tried[small] / (tried[small] - tried[large])",
        "part = tried[large] / (tried[large] - tried[small])",
        (f"{IMAGING}/tetrahedra.py",),
    ),
    Mutant(
        "a model whose prediction says nothing of its error",
        "src/bezsoma/model/case_text.py",
        "estimate = true",
        "estimate = false",
        ("tests/faults/test_model.py::test_the_command_says_what_it_made",),
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
    Mutant(
        "lattice tets over an edge that a smaller cell cuts, left whole",
        "src/bezsoma/mesh/graded.py",
        "cut |= (there >= 0) & (there < level)",
        "cut |= (there >= 0) & (there < level - 1)",
        (LATTICE,),
    ),
    Mutant(
        "half pyramids parted along the other diagonal",
        "src/bezsoma/mesh/graded.py",
        "leaves[:, first] % 2 == leaves[:, second] % 2",
        "leaves[:, first] % 2 != leaves[:, second] % 2",
        (LATTICE,),
    ),
    Mutant(
        "vertices moved off the cut",
        "src/bezsoma/mesh/stuffing.py",
        "place = np.where(on_side[vertex], points[vertex], place)",
        "place = np.where(on_side[vertex] & False, points[vertex], place)",
        (LATTICE,),
    ),
    Mutant(
        "a prism parted from its shallowest corner in one of its tets",
        "src/bezsoma/mesh/stuffing.py",
        "((0,), (1,), (1, 3), (2, 3)),",
        "((0,), (2,), (1, 3), (2, 3)),",
        (LATTICE,),
    ),
    Mutant(
        "tets held at all corners kept",
        f"{IMAGING}/tetrahedra.py",
        "np.flatnonzero(held[filled.tets].all(axis=1))",
        "np.flatnonzero(held[filled.tets].all(axis=1) & False)",
        (FACE_MESH,),
    ),
    Mutant(
        "a stage kept though it was made with other settings",
        "src/bezsoma/model/folder.py",
        'if whole and known["key"] == key:',
        "if whole:",
        ("tests/faults/test_model.py::test_what_stands_there_is_not_lost",),
    ),
    Mutant(
        "two runs let into one folder",
        "src/bezsoma/model/lock.py",
        "fcntl.LOCK_EX | fcntl.LOCK_NB",
        "fcntl.LOCK_SH | fcntl.LOCK_NB",
        ("tests/faults/test_model.py::test_one_run_at_a_time_works_in_a_folder",),
    ),
    Mutant(
        "the case of an old mesh left beside a new one",
        "src/bezsoma/model/folder.py",
        '"gone": list(later) * stale',
        '"gone": []',
        ("tests/faults/test_model.py::test_a_run_that_is_killed_amid_a_swap_is_made_good",),
    ),
)
