# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors in the rest of the core: multigrid, iterations, matrices, meshes, threads."""

from __future__ import annotations

from mutants.mutant import Mutant, errors_in

CORE = "src/core"
MULTIGRID = ("tests/laws/test_multigrid.py",)
MIXED_FREE = ("tests/laws/test_mixed_free.py",)
ELEMENT = ("tests/laws/test_element.py",)
ASSEMBLED = ("tests/laws/test_assembled.py",)
CHOLESKY = ("tests/laws/test_cholesky.py",)
MESHES = (
    "tests/laws/test_mesh_tets.py",
    "tests/laws/test_mesh_shape.py",
    "tests/faults/test_meshes.py",
)
NETS = ("tests/laws/test_control_net.py",)
TEAM = ("tests/faults/test_core.py",)

BLOCKS = (
    *errors_in(
        f"{CORE}/block_kernel.hpp",
        MULTIGRID,
        (
            "controls that pull at the first vertex of their entity alone",
            "moments[3 * v + k] += vertex_weights<n, dim>.of[a][v] * x[3 * a + k];",
            "moments[3 * v + k] += vertex_weights<n, dim>.of[a][0] * x[3 * a + k];",
        ),
        (
            "controls that follow the first vertex of their entity alone",
            "vertex_weights<n, dim>.of[a][v] * corner[taken * v + k]",
            "vertex_weights<n, dim>.of[a][v] * corner[k]",
        ),
        (
            "directions that keep all of those before",
            "to[row] = beta * to[row] + step[row][l];",
            "to[row] = to[row] + step[row][l];",
        ),
        (
            "r.z of the last row alone",
            "dot += wide[row] * __builtin_convertvector(y[row], Lanes<double, lanes>);",
            "dot = wide[row] * __builtin_convertvector(y[row], Lanes<double, lanes>);",
        ),
    ),
    *errors_in(
        f"{CORE}/entity_blocks.cpp",
        MULTIGRID,
        (
            "couplings with one binomial for another",
            "product *= combinations(x[v] + y[v], x[v]);",
            "product *= combinations(x[v] + y[v], 1);",
        ),
        (
            "blocks with the factor n in place of n^2",
            "square = tets.degree * tets.degree;",
            "square = tets.degree;",
        ),
        (
            "blocks from which held components are not taken out",
            "if (fixed[i] || fixed[j])",
            "if (fixed[i] && fixed[j])",
        ),
        (
            "an inverse with a transposed index",
            "s -= a(i, k) * a(k, j);",
            "s -= a(i, k) * a(j, k);",
        ),
    ),
    *errors_in(
        f"{CORE}/entities.cpp",
        MULTIGRID,
        (
            "blocks of the first tet's entities alone",
            "found.around[to] = static_cast<std::int32_t>(i / per_tet);",
            "found.around[to] = 0;",
        ),
        (
            "entities all of whose vertices are the first",
            "entity.vertices[++entity.dim] = corners[v];",
            "entity.vertices[++entity.dim] = corners[0];",
        ),
    ),
    *errors_in(
        f"{CORE}/preconditioner.cpp",
        MULTIGRID,
        (
            "moments in x for all directions",
            "sum[k] += moments_[at + k * lanes];",
            "sum[k] += moments_[at];",
        ),
        (
            "r.z with the norm in place of its square",
            "of_vertices(coarse) * norm * norm;",
            "of_vertices(coarse) * norm;",
        ),
    ),
)

COARSE = (
    *errors_in(
        f"{CORE}/aggregates.cpp",
        MULTIGRID,
        (
            "what is left over joins whichever neighbour comes last",
            "first[j] >= 0 && s > most",
            "first[j] >= 0 && s > 0",
        ),
    ),
    *errors_in(
        f"{CORE}/aggregation.cpp",
        MULTIGRID,
        ("a smoothing step three times too long", "4 / (3 * largest)", "4 / (1 * largest)"),
        (
            "a cycle that forgets what the coarse levels found",
            "        add_prolonged(level, z);",
            "",
        ),
        (
            "the coarsest level solved half",
            "x[k] -= factor_[i * n + k] * x[i];",
            "x[k] -= 0 * factor_[i * n + k] * x[i];",
        ),
        (
            "coarse levels given what the sweep has already done",
            "restrict_to_coarse(level, level.residual.data());",
            "restrict_to_coarse(level, r);",
        ),
        (
            "a dense factor without its corrections",
            "li[j] = (li[j] - dot(li, lj, j)) / lj[j];",
            "li[j] = li[j] / lj[j];",
        ),
    ),
    *errors_in(
        f"{CORE}/galerkin.cpp",
        MULTIGRID,
        (
            "a lower half that is the upper one untransposed",
            "to[k * motions + l] = from[l * motions + k];",
            "to[k * motions + l] = from[k * motions + l];",
        ),
    ),
    *errors_in(
        f"{CORE}/prolongation.cpp",
        MULTIGRID,
        (
            "a smoothing step the wrong way",
            "row -= omega * inverse[l * n + k] * sums[(at - begin) * n + size_of(l)];",
            "row += omega * inverse[l * n + k] * sums[(at - begin) * n + size_of(l)];",
        ),
        (
            "a rotation that is a shear",
            "{1, 0, 0, 0, x[2], -x[1]}",
            "{1, 0, 0, 0, x[2], x[1]}",
        ),
    ),
    Mutant(
        "motions that are not made orthogonal",
        f"{CORE}/prolongation.cpp",
        "x[i * motions + k] -= along * x[i * motions + l];",
        "x[i * motions + k] -= 0 * along * x[i * motions + l];",
        MULTIGRID,
        argued="another basis of the same motions, whose blocks of six are inverted whole: 14 "
        "steps against 15 on a cube of 20, as many on five other bodies",
    ),
    Mutant(
        "held components that move rigidly",
        f"{CORE}/prolongation.cpp",
        "if (!fixed[3 * v + k])",
        "if (v + 1 > 0)",
        MULTIGRID,
        argued="what is prolonged to held components is cleared: as many steps on eight bodies, "
        "one more where planes of symmetry hold",
    ),
    *errors_in(
        f"{CORE}/rows_isa.cpp",
        MULTIGRID,
        (
            "A P with the blocks of A transposed",
            "sum += block[l * n + k] * y[l];",
            "sum += block[k * n + l] * y[l];",
        ),
        (
            "P^T A P with one row of P for all",
            "sum += x[k] * row[8 * k + m];",
            "sum += x[0] * row[8 * k + m];",
        ),
        (
            "a residual that counts the diagonal again",
            "sum.add(a, diagonal[i] + 1, a.start[i + 1], z);\n        sum.total(total);",
            "sum.add(a, diagonal[i], a.start[i + 1], z);\n        sum.total(total);",
        ),
        ("a restriction of x alone", "+= row * from[k];", "+= row * from[0];"),
        ("a motion that is not prolonged", "(sum[k][4] + sum[k][5])", "(sum[k][4])"),
        (
            "a step that measures the largest eigenvalue without the diagonal",
            "times<n>(inverse + i * n * n, total, y + i * n);",
            "write_exactly<n>(y + i * n, total);",
        ),
    ),
    Mutant(
        "an inverse with a sign turned",
        f"{CORE}/sweeps.cpp",
        "a[size_of(i * n + k)] = -factor;",
        "a[size_of(i * n + k)] = factor;",
        MULTIGRID,
    ),
    *errors_in(
        f"{CORE}/vertex_matrix.cpp",
        MULTIGRID,
        ("a matrix of degree 1 without mu g.h", "block[4 * l] += dot;", "block[4 * l] += 0 * dot;"),
        (
            "held components that still pull at others",
            "mine != other && (fixed[mine] || fixed[other])",
            "mine != other && (fixed[mine] && fixed[other])",
        ),
    ),
)

ITERATIONS = (
    *errors_in(
        f"{CORE}/conjugate_gradients.cpp",
        MULTIGRID,
        (
            "steepest descent for conjugate gradients",
            "before > 0 ? rz / before : 0.0",
            "before > 0 ? 0 * rz / before : 0.0",
        ),
        (
            "directions of degree 1 of another length than those before",
            "p[i] = beta * p[i] + norm * double{z_[i]};",
            "p[i] = beta * p[i] + double{z_[i]};",
        ),
        (
            "forces at held components that count",
            "fixed[j] ? 0.0 : r[j] - alpha * q[j]",
            "fixed[j] ? 0.0 * r[j] - alpha * q[j] : r[j] - alpha * q[j]",
        ),
        (
            "a residual at the start that forgets where it starts",
            "fixed[i] ? 0.0 : f[i] - q[i]",
            "fixed[i] ? 0.0 : f[i]",
        ),
    ),
    *errors_in(
        f"{CORE}/pieces.hpp",
        (*MULTIGRID, *MIXED_FREE),
        (
            "a sum without the numbers that fill no eight",
            "part[0] += term(i);",
            "part[0] += 0 * term(i);",
        ),
    ),
    *errors_in(
        f"{CORE}/saddle.cpp",
        MIXED_FREE,
        ("all pressures weighed alike", "        d = 1 / d;", "        d = 1;"),
        (
            "Chebyshev's recursion with half its middle",
            "1 / (2 * middle / reach - rho)",
            "1 / (1 * middle / reach - rho)",
        ),
        ("the pressure's sign in the preconditioner", "z[i] = -z[i];", "z[i] = +z[i];"),
        ("beta upside down", "rho / before * (alpha / omega)", "rho / before * (omega / alpha)"),
        (
            "directions without what the second half-step changed",
            "beta * (it.direction[j] - omega * it.v[j])",
            "beta * (it.direction[j])",
        ),
        (
            "a residual that lags behind the solution",
            "it.r[j] -= omega * it.t[j];",
            "it.r[j] -= 0.5 * omega * it.t[j];",
        ),
    ),
    Mutant(
        "levels that stay in the pressure",
        f"{CORE}/saddle.cpp",
        "p[i] -= part * level[i];",
        "p[i] -= 0 * part * level[i];",
        MIXED_FREE,
        argued="what is given and the answer are freed of levels outside of the iteration; in it "
        "only rounding brings them in",
    ),
)

MATRICES = (
    *errors_in(
        f"{CORE}/block_csr.cpp",
        ASSEMBLED,
        (
            "neighbours in the order in which they are met",
            "std::sort(neighbours.begin(), neighbours.end());",
            ";",
        ),
        ("a product's y for its z", "y[3 * row + 2] = y2;", "y[3 * row + 2] = y1;"),
    ),
    *errors_in(
        f"{CORE}/cholesky.cpp",
        CHOLESKY,
        (
            "pivots from which nothing is taken",
            "subtract_product(pivot, a.data(), a.data());",
            ";",
        ),
        (
            "a division by the factor with a transposed index",
            "row[1] = x * inverse[3] + y * inverse[4];",
            "row[1] = x * inverse[1] + y * inverse[4];",
        ),
        (
            "a shift added where it should multiply",
            "out[4 * r] * (1 + shift)",
            "out[4 * r] + shift",
        ),
    ),
    *errors_in(
        f"{CORE}/elasticity.cpp",
        ELEMENT,
        (
            "couplings of two vertices exchanged",
            "static_cast<std::uint32_t>(4 * i + j)",
            "static_cast<std::uint32_t>(4 * j + i)",
        ),
        (
            "blocks written transposed",
            "matrix[(3 * a + e / 3) * 3 * m + 3 * b + e % 3] = entry[e];",
            "matrix[(3 * a + e % 3) * 3 * m + 3 * b + e / 3] = entry[e];",
        ),
    ),
)

MESH = (
    *errors_in(
        f"{CORE}/topology.cpp",
        (*MESHES, *NETS),
        (
            "faces that no two tets share",
            "next += i == 0 || here[i].first != here[i - 1].first;",
            "next += 1;",
        ),
        (
            "a row with a vertex twice let through",
            "if (twice < 0 && std::adjacent_find(row, row + width) != row + width)",
            "if (twice < 0 && std::adjacent_find(row, row + width) == row)",
        ),
        (
            "a row found where another one stands",
            "low < there && std::equal(wanted, wanted + width, row(low))",
            "low < there && wanted != nullptr",
        ),
        ("runs of controls all one long", "next += inside[dim];", "next += 1;"),
        (
            "every tet a part of its own",
            "label[t] = least == t ? count++ : label[least];",
            "label[t] = count++;",
        ),
        (
            "sides of faces that ignore their order",
            "i % 2 ? -sign[i / 4] : sign[i / 4]",
            "i % 2 ? sign[i / 4] : sign[i / 4]",
        ),
    ),
    Mutant(
        "the first row with a vertex twice for the one that has it",
        f"{CORE}/topology.cpp",
        "twice = static_cast<std::int64_t>(i);",
        "twice = 0;",
        (*MESHES, *NETS),
        argued="whoever asks looks only whether there is such a row, and finds them all anew for "
        "the message; the number is a hint that nobody takes",
    ),
    *errors_in(
        f"{CORE}/shape.cpp",
        MESHES,
        ("all tets the same way round", "det.value > 0 ? 1 : -1", "det.value > 0 ? 1 : 1"),
        (
            "rounding that is believed to be none",
            "bound += 16 * eps *",
            "bound += 0 * eps *",
        ),
    ),
)

THREADS = (
    *errors_in(
        f"{CORE}/team.cpp",
        TEAM,
        (
            "signals that are never asked for",
            "if (now - polled_ < between_polls)",
            "if (now - polled_ < 100000 * between_polls)",
        ),
    ),
)

SOLVERS = (*BLOCKS, *COARSE, *ITERATIONS, *MATRICES, *MESH, *THREADS)
