# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes at the edge of what numbers hold.

Each has the radiance that all of its image should show. edge_case.py defines such a scene; every other module holds one
kind of edge and its `CASES`.
"""

from __future__ import annotations

from . import (
    bad_faces,
    closed_body,
    grazing,
    hot_texel,
    index_one,
    narrow_lobe,
    odd_lights,
    place_and_size,
    tangent_pole,
)
from .edge_case import EdgeCase

CASES: tuple[EdgeCase, ...] = (
    *place_and_size.CASES,
    *narrow_lobe.CASES,
    *grazing.CASES,
    *closed_body.CASES,
    *bad_faces.CASES,
    *hot_texel.CASES,
    *odd_lights.CASES,
    *index_one.CASES,
    *tangent_pole.CASES,
)
