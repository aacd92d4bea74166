# SPDX-License-Identifier: BSD-3-Clause
"""Neo-Hooke as scikit-fem's forms, in the plane (the stretch across is one) and in space."""

from __future__ import annotations

from typing import Any

import numpy as np
import skfem
from skfem.helpers import ddot, det, grad, identity, inv, mul, transpose


def forms(mu: float, lam: float) -> tuple[Any, Any]:
    """DP : grad v and P : grad v at w["u"], with P = mu (F - F^-T) + lam ln J F^-T."""

    def deformation(w: Any) -> Any:
        return grad(w["u"]) + identity(w["u"].grad)

    @skfem.BilinearForm
    def tangent(du: Any, v: Any, w: Any) -> Any:
        F, dF = deformation(w), grad(du)
        T = transpose(inv(F))
        turned = mul(T, mul(transpose(dF), T))
        dP = mu * (dF + turned) + lam * (ddot(T, dF) * T - np.log(det(F)) * turned)
        return ddot(dP, grad(v))

    @skfem.LinearForm
    def internal(v: Any, w: Any) -> Any:
        F = deformation(w)
        T = transpose(inv(F))
        return ddot(mu * (F - T) + lam * np.log(det(F)) * T, grad(v))

    return tangent, internal
