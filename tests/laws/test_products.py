# SPDX-License-Identifier: BSD-3-Clause
"""What estimates are made of: products tet by tet, and duals."""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma.equations.mixed_free import MixedFree
from bezsoma.mechanics import Body, Fixed, LinearElastic
from bezsoma.mesh import ControlNet, block
from bezsoma.refinement.products import displacement_product, linear_product
from bezsoma.refinement.raised import raised
from bezsoma.solvers.solve import solve
from tolerances import ROUNDING

G, SOFT = 0.4, 0.3


@pytest.mark.parametrize("soft", [0.0, SOFT])
def test_the_tets_of_a_mixed_product_add_up_to_the_operator(soft: float) -> None:
    mesh = block(cells=2, irregular=0.3)
    net, pressures = ControlNet(mesh, 3), ControlNet(mesh, 1)
    rng = np.random.default_rng(5)
    a, b = rng.standard_normal((2, 3 * net.count + pressures.count))
    product = linear_product(net, pressures, np.array([[-2 / 3 * G, G, soft]]))
    f, g = MixedFree(net, pressures, np.array([[G, soft]])).apply(
        a[: 3 * net.count].reshape(-1, 3), a[3 * net.count :]
    )
    whole = np.concatenate([f.ravel(), g]) * b
    assert abs(product(a, b).sum() - whole.sum()) < ROUNDING * np.abs(whole).sum()


@pytest.mark.parametrize("degree", [2, 5])
def test_the_operator_gives_each_tet_what_gradients_give(degree: int) -> None:
    mesh = block(cells=2, irregular=0.3)
    net, pressures = ControlNet(mesh, degree), ControlNet(mesh, 1)
    a, b = np.random.default_rng(7).standard_normal((2, 3 * net.count))
    none = np.zeros(pressures.count)
    lam = 0.6
    gradients = linear_product(net, pressures, np.array([[lam, G, 0.0]]))
    wanted = gradients(np.concatenate([a, none]), np.concatenate([b, none]))
    found = displacement_product(net, np.array([[lam, G]]))(a, b)
    assert abs(found - wanted).max() < ROUNDING * np.abs(wanted).max()


def test_a_dual_of_the_solutions_own_degree_is_not_loose() -> None:
    body = Body(block(cells=2), 2, LinearElastic(E=1.0, nu=0.3), [Fixed("bottom")], [])
    same = raised(solve(body), 0)
    load = np.random.default_rng(6).standard_normal(same.held.size)
    left = np.where(same.held, 0.0, load - same.adjoint.product(same.dual(load)))
    assert np.linalg.norm(left) < 1e-7 * np.linalg.norm(load)
