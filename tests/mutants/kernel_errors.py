# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors in the kernels of the core: the operators, the ladder, the laws, the rule."""

from __future__ import annotations

from mutants.mutant import errors_in

CORE = "src/core"
LAWS = ("tests/laws/test_laws_core.py",)
MATRIX_FREE = ("tests/laws/test_matrix_free.py",)
MIXED_FREE = ("tests/laws/test_mixed_free.py",)
POINTWISE = ("tests/laws/test_pointwise_free.py",)

OPERATOR = (
    *errors_in(
        f"{CORE}/elastic_kernel.hpp",
        MATRIX_FREE,
        (
            "a change of volume without its last part",
            "lambda * (h[0][0] + h[1][1] + h[2][2]) * top",
            "lambda * (h[0][0] + h[1][1]) * top",
        ),
        (
            "a shear of two different planes",
            "stress[4][p] = shear * (h[1][2] + h[2][1]);",
            "stress[4][p] = shear * (h[1][2] + h[2][0]);",
        ),
        (
            "the force at the first vertex without what balances the last",
            "g0[l] = -(tet.g[0][l] + tet.g[1][l] + tet.g[2][l]);",
            "g0[l] = -(tet.g[0][l] + tet.g[1][l]);",
        ),
        (
            "a stress that leaves the scaled basis unscaled",
            "const R y = stress[voigt[k][1]][p] * top;",
            "const R y = stress[voigt[k][1]][p];",
        ),
        (
            "a difference of controls from the wrong corner",
            "const R d2 = u[3 * p2 + k] - u[3 * p + k];",
            "const R d2 = u[3 * p2 + k] - u[3 * p1 + k];",
        ),
        (
            "numbers of a square that all go to its first row",
            "u[order[r]] = block[r];",
            "u[order[0]] = block[r];",
        ),
        (
            "eight lanes of which one takes what is another's",
            "halves(5, 7);",
            "halves(5, 6);",
        ),
        (
            "a row left over that is scattered as the first of its run",
            "scatter_square<left, spare, T, lanes>(to, begin, order + begin, f);",
            "scatter_square<left, spare, T, lanes>(to, begin, order, f);",
        ),
        (
            "forces in whole registers that replace those of the tets before",
            "store<T, lanes>(to, load<T, lanes>(to) + v);",
            "store<T, lanes>(to, v);",
        ),
        (
            "later squares of lanes added to the places of the first",
            "(to[lane + l] + begin, block[l]);",
            "(to[l] + begin, block[l]);",
        ),
        (
            "work with one shear's sign turned",
            "(h[2][0] + h[0][2]) * stress[5][p]",
            "(h[2][0] - h[0][2]) * stress[5][p]",
        ),
        (
            "an elevation that takes one neighbour for another",
            "sum += lower[below[1]];",
            "sum += lower[below[0]];",
        ),
        (
            "shear with the factor n in place of n^2",
            "mu = tet.mu * scale;",
            "mu = tet.mu * (scale / n);",
        ),
    ),
    *errors_in(
        f"{CORE}/kernels_isa.cpp",
        MATRIX_FREE,
        (
            "several sides whose forces replace those of the tets before",
            "store<T, beside>(to, load<T, beside>(to) + v);",
            "store<T, beside>(to, 0 * load<T, beside>(to) + v);",
        ),
        (
            "several sides that each tet takes a group too few of",
            "side < end; side += beside",
            "side + beside < end; side += beside",
        ),
        ("the work of the first lane taken for all", "all += sum[l];", "all += sum[0];"),
    ),
    *errors_in(
        f"{CORE}/lanes.hpp",
        MATRIX_FREE,
        (
            "a group of sides that is not full, without its last one",
            "half<T, lanes, true>(v), many - part);",
            "half<T, lanes, true>(v), many - part - 1);",
        ),
    ),
    *errors_in(
        f"{CORE}/elastic_operator.cpp",
        MATRIX_FREE,
        (
            "forces on shared controls kept from the call before",
            "std::fill_n(f_foreign, row * foreign, T{});",
            ";",
        ),
        (
            "a last own control whose forces stay in the area",
            "forces_of_area(b.area, chunk.owned, b.f, sides);",
            "forces_of_area(b.area, chunk.owned - 1, b.f, sides);",
        ),
        (
            "sides left over that all take the numbers of the first of them",
            "forces_of_side(c, u + side, f + side, f_foreign + side, sides, alone, scratch);",
            "forces_of_side(c, u + beside, f + side, f_foreign + side, sides, alone, scratch);",
        ),
        (
            "sides left over in an area that all take the own numbers of the first side",
            "own[i] = b.u[i * sides];",
            "own[i] = b.u[i * sides / 3 * 3];",
        ),
        (
            "forces that one side found for other chunks kept for the next",
            "std::fill_n(found, foreign, T{});",
            ";",
        ),
        (
            "foreign controls whose forces an area keeps from the chunk before",
            "b.area[forces_in_row + k] = T{};",
            ";",
        ),
        ("tets of twice their volume", "std::abs(det) / 6", "std::abs(det) / 3"),
        (
            "a last stretch of batches walked as if it were whole",
            "place % lanes * stretch + batch - begin;",
            "place % lanes * apart + batch - begin;",
        ),
    ),
    *errors_in(
        f"{CORE}/foreign.hpp",
        MATRIX_FREE,
        (
            "one thread that adds the first number that a chunk found for others everywhere",
            "to[k * apart] += next[k];",
            "to[k * apart] += next[0];",
        ),
        (
            "what other chunks add to a chunk's controls is dropped",
            "x[wide * one.control + k] += from[wide * one.from + k];",
            "x[wide * one.control + k] += 0 * from[wide * one.from + k];",
        ),
        (
            "shared controls read with their first component for all",
            "*to++ = x[(wide * control + k) * apart];",
            "*to++ = x[wide * control * apart];",
        ),
    ),
    *errors_in(
        f"{CORE}/chunks.cpp",
        MATRIX_FREE,
        (
            "what other chunks add looked for in the wrong place",
            "owner->added.push_back({control, from++});",
            "owner->added.push_back({control, from});",
        ),
        (
            "runs of shared controls that are their first control over and over",
            "controls.push_back(run.control + i);",
            "controls.push_back(run.control);",
        ),
    ),
)

MIXED = (
    *errors_in(
        f"{CORE}/elastic_kernel.hpp",
        MIXED_FREE,
        (
            "the lowest rung of the inverse ladder counted twice",
            "y[0] *= static_cast<T>(scales.level[0]);",
            "y[0] *= static_cast<T>(2 * scales.level[0]);",
        ),
    ),
    *errors_in(
        f"{CORE}/mixed_kernel.hpp",
        MIXED_FREE,
        (
            "changes of volume that replace those of the tets before",
            "to[first[e * lanes + l] + i] += found[l];",
            "to[first[e * lanes + l] + i] = found[l];",
        ),
        ("a pressure that is read unscaled", "p[row] = found * multinomial;", "p[row] = found;"),
        (
            "the compressibility with its sign turned",
            "swelling * top + compressibility * pressure",
            "swelling * top - compressibility * pressure",
        ),
        ("roots of volumes half as large", "return det * 6.0;", "return det * 3.0;"),
        (
            "the pressure's force at the first vertex without a part",
            "f[3 * at + k] -= f1 + f2 + f3;",
            "f[3 * at + k] -= f1 + f2;",
        ),
        (
            "the diagonal of the pressure's mass unscaled",
            "weight * (diagonal[at] * top[at])",
            "weight * (diagonal[at])",
        ),
        (
            "an elevation of the pressure towards one vertex twice",
            "p[p2] += lower[at];",
            "p[p3] += lower[at];",
        ),
    ),
    *errors_in(
        f"{CORE}/mixed_operator.cpp",
        MIXED_FREE,
        (
            "the weight of the first region for all",
            "moduli[2 * r] = weight[r];",
            "moduli[2 * r] = weight[0];",
        ),
        (
            "changes of volume that chunks share, without those of others",
            "u_.add_foreign(part, f);\n        p_.add_foreign(part, g);",
            "u_.add_foreign(part, f);",
        ),
    ),
    *errors_in(
        f"{CORE}/foreign.hpp",
        MIXED_FREE,
        (
            "what other chunks found that replaces a chunk's own",
            "x[wide * one.control + k] += from[wide * one.from + k];",
            "x[wide * one.control + k] = from[wide * one.from + k];",
        ),
    ),
)

AT_POINTS = (
    *errors_in(
        f"{CORE}/pointwise_kernel.hpp",
        POINTWISE,
        (
            "shears of small strain by half",
            "c < 3 ? h[k][k] : h[k][l] + h[l][k];",
            "c < 3 ? h[k][k] : h[k][l];",
        ),
        ("a force at the wrong vertex", "f[3 * p2 + k] += f2;", "f[3 * p2 + k] += f1;"),
        (
            "forces without the factor n",
            "load<T, lanes>(geometry + 9 * lanes) * static_cast<T>(n)",
            "load<T, lanes>(geometry + 9 * lanes)",
        ),
        (
            "the least J of a batch placed in its first tet",
            "all.least_J = {watch[l], i * lanes + l,",
            "all.least_J = {watch[l], i * lanes,",
        ),
        (
            "an energy with the weight of the first point for all",
            "rule.weights[q + r]",
            "rule.weights[q]",
        ),
        (
            "a pressure that comes to the points unscaled",
            "p[b] * ladder_scales<n - 1>.top[b]",
            "p[b]",
        ),
    ),
    *errors_in(
        f"{CORE}/product.hpp",
        POINTWISE,
        (
            "a fourth point that is the third",
            "x[3] = a_b - d_e;",
            "x[3] = a_b + d_e;",
        ),
        (
            "moments of later points that replace those before",
            "first > 0 ? load<T, lanes>(at)",
            "first > 1000000 ? load<T, lanes>(at)",
        ),
        (
            "a row of a product with the factors of the first",
            "sum[k][c] += factor[k] * value;",
            "sum[k][c] += factor[0] * value;",
        ),
    ),
    *errors_in(
        f"{CORE}/rule.cpp",
        POINTWISE,
        (
            "sums of controls without the signs of their character",
            "mean += character[k][j] * values[q * controls_ + orbit.control[j]] / 4;",
            "mean += values[q * controls_ + orbit.control[j]] / 4;",
        ),
        (
            "weights in the order in which the rule was given",
            "weights_.push_back(static_cast<T>(weights[q]));",
            "weights_.push_back(static_cast<T>(weights[i]));",
        ),
    ),
    *errors_in(
        f"{CORE}/pointwise_operator.cpp",
        POINTWISE,
        (
            "tets of six times their volume at points",
            "static_cast<T>(shape.volume)",
            "static_cast<T>(shape.volume * 6)",
        ),
        (
            "the place of the least J counted from the chunk's group",
            "all.least_J.place += before;",
            "all.least_J.place += 0 * before;",
        ),
    ),
)

LAW = (
    *errors_in(
        f"{CORE}/laws/motion.hpp",
        LAWS,
        ("the trace of the linear strain", "trace = tr + square * half();", "trace = tr;"),
        (
            "Green's strain without a row of H",
            "H[1][k] * H[1][l] + H[2][k] * H[2][l]",
            "H[1][k] * H[1][l]",
        ),
        ("F S with H transposed", "H[k][1] * s[of[1][l]]", "H[1][k] * s[of[1][l]]"),
    ),
    *errors_in(
        f"{CORE}/laws/motion.hpp",
        POINTWISE,
        (
            "the place of the greatest J for the least",
            "least_at = J > least_J ? least_at : point;",
            "least_at = J > least_J ? point : least_at;",
        ),
    ),
    *errors_in(
        f"{CORE}/laws/finite_strain.hpp",
        LAWS,
        (
            "both invariants of Mooney and Rivlin with the first number",
            "second_isochoric(x, log) * par[2];",
            "second_isochoric(x, log) * par[1];",
        ),
        (
            "half the second term of Veronda and Westmann in the stress",
            "return -par[1] * par[2] / 2;",
            "return -par[1] * par[2] / 4;",
        ),
        (
            "twice the volume's energy of the neo-Hookean law",
            "((par[0] - 2 * par[1] / 3) / 2)",
            "((par[0] - 2 * par[1] / 3))",
        ),
        ("half the shear", "s[c] = E[c] * (2 * par[1]);", "s[c] = E[c] * (par[1]);"),
        (
            "the compressibility of the mixed form with its sign turned",
            "P[9] = -j - H[9] * (1 / par[0]);",
            "P[9] = -j + H[9] * (1 / par[0]);",
        ),
        (
            "shears counted once in Guccione's exponent",
            "return normal + 2 * shear;",
            "return normal + shear;",
        ),
        (
            "half of what turns with the frame",
            "turned = of.squared * of.squared * (w2 * T(4));",
            "turned = of.squared * of.squared * (w2 * T(2));",
        ),
    ),
    *errors_in(
        f"{CORE}/laws/dual.hpp",
        LAWS,
        (
            "the change of 1/x with one power too few",
            "return {r, -a.d * (r * r)};",
            "return {r, -a.d * r};",
        ),
    ),
    *errors_in(
        f"{CORE}/laws/lane_functions.hpp",
        LAWS,
        (
            "the logarithm of 2 with a third of its digits missing",
            "return log + exponent * I::ln2_low + exponent * I::ln2_high;",
            "return log + exponent * I::ln2_high;",
        ),
    ),
    *errors_in(
        f"{CORE}/laws/small_strain.hpp",
        LAWS,
        (
            "half a difference squared in the deviator, not a third",
            "(a * a + b * b + c * c) * T(1.0 / 3)",
            "(a * a + b * b + c * c) * T(1.0 / 2)",
        ),
        ("shears by half in the mean", "Plain<S>(shear / 9.0)", "Plain<S>(shear / 18.0)"),
        (
            "a strain that keeps its mean in the shear",
            "c < 3 ? (e[c] - third) * T(2) : e[c]",
            "c < 3 ? (e[c]) * T(2) : e[c]",
        ),
    ),
    *errors_in(
        f"{CORE}/laws/ogden.hpp",
        LAWS,
        (
            "half the change of 1/lambda^2",
            "(dm[a][a] - 2 * b[a] * dlog[a])",
            "(dm[a][a] - 1 * b[a] * dlog[a])",
        ),
        (
            "Ogden's energy without its exponent below",
            "(par[1 + 2 * i] / par[2 + 2 * i])",
            "(par[1 + 2 * i])",
        ),
    ),
    *errors_in(
        f"{CORE}/law.cpp",
        LAWS,
        (
            "a stress whose lower half is not written",
            "P[3 * k + l] = P[3 * l + k] = from[c * lanes + lane];",
            "P[3 * k + l] = from[c * lanes + lane];",
        ),
    ),
)

KERNELS = (*OPERATOR, *MIXED, *AT_POINTS, *LAW)
