# SPDX-License-Identifier: BSD-3-Clause
"""From pictures of a head to tets: for now the head phantom, which needs no picture."""

from __future__ import annotations

from bezsoma.imaging.phantom import head_phantom, landmarks

__all__ = ["head_phantom", "landmarks"]
