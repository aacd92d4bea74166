# SPDX-License-Identifier: BSD-3-Clause
"""Which configurations an engine has for a problem: asked by peers.py, not by hand."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import isolated


def ways(request: dict[str, Any]) -> dict[str, Any]:
    """Their names."""
    engine = import_module(f"engines.{request['engine']}_engine")
    return {"ways": engine.configurations(request["degree"], request["unknowns"])}


if __name__ == "__main__":
    isolated.serve(ways)
