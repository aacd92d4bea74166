# SPDX-License-Identifier: BSD-3-Clause
"""The algebra of one simplex: Bernstein polynomials of degree 0 to 20 in 0 to 3 dimensions.

To be read in this order: `indices` (where a control stands), `basis` (what it multiplies),
`nets` (what can be done with controls), `subdivision` (the same on smaller simplices), `bounds`
(least and largest values), `integrals` (closed forms), `quadrature` (where there is none);
`rationals` keeps them exact.  The theory on two pages: docs/theory/bernstein.md.

    p(L) = sum_alpha b_alpha B_alpha(L) :    a polynomial is its controls

>>> import numpy as np
>>> controls = np.array([0.0, 0.0, 3.0])                    # 3 t^2 on an edge
>>> point = np.array([0.75, 0.25])                          # t = 1/4
>>> float(values(2, point) @ controls), float(de_casteljau(controls, 2, point))
(0.1875, 0.1875)
>>> float(integral(2, 1) * controls.sum())                  # its mean is that of its controls
1.0
"""

from __future__ import annotations

from bezsoma.bernstein.basis import derivatives, interpolation, values
from bezsoma.bernstein.bounds import bounds
from bezsoma.bernstein.indices import (
    count,
    domain_points,
    indices,
    multinomials,
    parents,
    position,
    shifts,
)
from bezsoma.bernstein.integrals import (
    face_mass,
    gradient_moments,
    gradient_products,
    integral,
    ladder,
    mass,
    moments,
    monomial,
)
from bezsoma.bernstein.nets import (
    blossom,
    de_casteljau,
    de_casteljau_levels,
    derivative,
    elevated,
    elevation,
    product,
    restriction,
    trace,
)
from bezsoma.bernstein.quadrature import simplex
from bezsoma.bernstein.subdivision import (
    bisection_children,
    graph_distance,
    restricted,
    split_children,
    uniform_children,
    uniform_nets,
)

__all__ = [
    "bisection_children",
    "blossom",
    "bounds",
    "count",
    "de_casteljau",
    "de_casteljau_levels",
    "derivative",
    "derivatives",
    "domain_points",
    "elevated",
    "elevation",
    "face_mass",
    "gradient_moments",
    "gradient_products",
    "graph_distance",
    "indices",
    "integral",
    "interpolation",
    "ladder",
    "mass",
    "moments",
    "monomial",
    "multinomials",
    "parents",
    "position",
    "product",
    "restricted",
    "restriction",
    "shifts",
    "simplex",
    "split_children",
    "trace",
    "uniform_children",
    "uniform_nets",
    "values",
]
