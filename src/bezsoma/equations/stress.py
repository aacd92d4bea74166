# SPDX-License-Identifier: BSD-3-Clause
"""Strain and stress of a displacement in closed form, and what is made of them pointwise.

The gradient of a displacement of degree n is a polynomial of degree n - 1 in each tet, and so is
a stress that is linear in it: their controls follow from those of the displacement without any
evaluation. Principal values and the von Mises stress are roots and no polynomials.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.equations.volume import change_of_volume
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.laws import Law, MixedLaw, folds
from bezsoma.mechanics.materials import LinearElastic, Material
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.evaluation import gradient_controls, tet_portions
from bezsoma.mesh.field import Field


def strain(displacement: Field) -> BrokenField:
    """The small strain (t, m, 3, 3), (H + H^T)/2 with H = grad u (paper, eqs. 2, 3 and 30).

    Off the diagonal it has half the engineering shears that the paper writes.
    """
    H = gradient_controls(displacement, slice(None))
    return BrokenField(displacement.mesh, displacement.degree - 1, _symmetric(H))


def stress(body: Body, displacement: Field) -> BrokenField:
    """The Cauchy stress (t, m, 3, 3) MPa, by the law of each tet's region (paper, eqs. 4, 5).

    It is taken control by control, which is exact where the law is linear: the stress of a
    Bernstein polynomial with controls H_b is the one with controls stress(H_b). Of other laws it
    is interpolated in the domain points of degree n - 1: tets have no stress, but numbers that are
    none, where tissue is turned inside out at one of these (`Solution.advice` tells).
    """
    H = BrokenField(
        body.mesh, displacement.degree - 1, gradient_controls(displacement, slice(None))
    )
    if all(law.linear for law in body.material_of_region):
        return BrokenField(body.mesh, H.degree, _stress(body, H.controls, body.mesh.region))
    return interpolated(H, lambda H: _stress(body, H, body.mesh.region))


def mixed_stress(body: Body, displacement: Field, pressure: Field | BrokenField) -> BrokenField:
    """The Cauchy stress (t, m, 3, 3) MPa of the mixed form: 2 G eps' - p I (paper, eqs. 15 and 16).

    By the law of each tet's region; its mean is minus the pressure, to rounding, where the law is
    linear. Of other laws it is interpolated in the domain points of degree n - 1.
    """
    degree = displacement.degree - 1
    H = gradient_controls(displacement, slice(None))
    raised = bernstein.elevation(pressure.degree, 3, degree - pressure.degree)
    p = np.einsum("ab,tb->ta", raised, pressure.of_tet)
    region = body.mesh.region
    if all(law.linear for law in body.material_of_region):
        return BrokenField(body.mesh, degree, _beside_pressure(body, H, p, region))
    joint = np.concatenate([H, np.broadcast_to(p[..., None, None], (*p.shape, 3, 1))], axis=-1)
    both = BrokenField(body.mesh, degree, joint)
    return interpolated(both, lambda x: _beside_pressure(body, x[..., :3], x[..., 0, 3], region))


def _beside_pressure(body: Body, H: Floats, p: Floats, region: Ints) -> Floats:
    found = np.empty_like(H)
    for number, law in enumerate(body.material_of_region):
        here = region == number
        if isinstance(law, LinearElastic):
            found[here] = law.deviatoric_stress(H[here]) - p[here][..., None, None] * np.eye(3)
        else:
            assert isinstance(law, MixedLaw)  # Body refuses other laws beside a pressure
            found[here] = _cauchy(law, H[here], _at_pressure(law, p[here]))
    return found


def _at_pressure(law: MixedLaw, p: Floats) -> Callable[[Floats], Floats]:
    return lambda H: law.mixed_stress(H, p)[0]


def volume_change(displacement: Field) -> float:
    """int div u [mm3], as the flux of u through the boundary (Gauss), which is exact and cheap.

    The mean of the controls of a facet is the mean of u on it. The mean over all facets is taken
    off first: a body that is carried along changes no volume, and should lose no digits by it.

    >>> from bezsoma.mesh import ControlNet
    >>> from bezsoma.mesh.solids import block
    >>> swelling = Field.interpolating(ControlNet(block(), 2), lambda x: 0.01 * x + 1000)
    >>> bool(abs(volume_change(swelling) - 0.03) < 1e-12)
    True
    """
    mesh, net = displacement.mesh, displacement.net
    means = displacement.controls[net.of_facets(mesh.boundary)].mean(axis=1)
    means -= means.mean(axis=0)
    flux = np.einsum("fk,fk->f", means, mesh.normals(mesh.boundary))
    return float(np.einsum("f,f->", mesh.areas(mesh.boundary), flux))


def principal(tensors: Floats) -> Floats:
    """The principal values (..., 3) of symmetric tensors (..., 3, 3), largest first.

    >>> principal(np.array([[0.0, 2, 0], [2, 0, 0], [0, 0, 1]])).round(12).tolist()
    [2.0, 1.0, -2.0]
    """
    return np.asarray(np.linalg.eigvalsh(tensors)[..., ::-1])


def von_mises(stresses: Floats) -> Floats:
    """The von Mises stress (...), sqrt(3/2 s:s) with s the deviator of stresses (..., 3, 3).

    It is the size of a uniaxial stress, sqrt(3) times a pure shear, and no pressure shows in it:

    >>> shear = np.array([[7.0, 1, 0], [1, 7, 0], [0, 0, 7]])
    >>> bool(np.isclose(von_mises(np.diag([0, -3.0, 0])), 3))
    True
    >>> bool(np.isclose(von_mises(shear), 3**0.5))
    True
    """
    mean = np.trace(stresses, axis1=-2, axis2=-1)[..., None, None] / 3
    deviator = stresses - mean * np.eye(3)
    return np.asarray(np.sqrt(1.5 * (deviator**2).sum(axis=(-2, -1))))


def interpolated(field: BrokenField, function: Callable[[Floats], Floats]) -> BrokenField:
    """The polynomials that take function(values) at the domain points of each tet.

    For what is not polynomial, such as a von Mises stress: exact in the domain points of the
    field's degree, an interpolation between them.
    """
    n = field.degree
    values = function(field.tabulated(bernstein.domain_points(n, 3)))
    controls = np.moveaxis(np.tensordot(bernstein.interpolation(n, 3), values, (1, 1)), 0, 1)
    return BrokenField(field.mesh, n, controls)


def swelling(body: Body, displacement: Field) -> float:
    """The change of volume [mm3]: int (J - 1) where strains are finite, int div u where small.

    J = det(I + grad u) is a polynomial of degree 3 (n - 1): the quadrature is exact.

    >>> from bezsoma.mechanics import FunctionLaw
    >>> from bezsoma.mesh import ControlNet
    >>> from bezsoma.mesh.solids import block
    >>> law = FunctionLaw(lambda H: H)
    >>> doubled = Field.interpolating(ControlNet(block(), 2), lambda x: x)
    >>> round(swelling(Body(block(), 2, law, []), doubled), 12)
    7.0
    """
    finite = [isinstance(law, Law) and law.finite for law in body.material_of_region]
    if not any(finite):
        return volume_change(displacement)
    bary, weights = bernstein.simplex(3 * (displacement.degree - 1), 3)
    values = bernstein.values(displacement.degree - 1, bary)
    total, mesh = 0.0, body.mesh
    for part in tet_portions(displacement, 64 * len(bary)):  # few: solving needs no more
        H = np.einsum("qm,tmkl->tqkl", values, gradient_controls(displacement, part))
        trace = np.trace(H, axis1=-2, axis2=-1)
        large = np.array(finite)[mesh.region[part], None]
        chosen = np.where(large, change_of_volume(H), trace)
        total += float(np.einsum("tq,q,t->", chosen, weights, mesh.volumes[part]))
    return total


def _symmetric(H: Floats) -> Floats:
    return (H + np.swapaxes(H, -1, -2)) / 2


def _stress(body: Body, H: Floats, region: Ints) -> Floats:
    laws = body.material_of_region
    if len(laws) == 1:
        return _cauchy(laws[0], H, laws[0].stress)
    found = np.empty_like(H)
    for number, law in enumerate(laws):
        found[region == number] = _cauchy(law, H[region == number], law.stress)
    return found


def _cauchy(law: Material, H: Floats, stress: Callable[[Floats], Floats]) -> Floats:
    """Cauchy's stress at H (..., 3, 3) from that of a law: of finite laws P F^T / J.

    No number where tissue is turned inside out.
    """
    if not (isinstance(law, Law) and law.finite):
        return stress(H)
    folded = folds(law, H)[..., None, None]
    sound = np.where(folded, 0.0, H)
    F, P = np.eye(3) + sound, stress(sound)
    found = np.asarray(P @ np.swapaxes(F, -1, -2) / np.linalg.det(F)[..., None, None])
    return np.where(folded, np.nan, found)
