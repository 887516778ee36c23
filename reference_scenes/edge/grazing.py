# SPDX-License-Identifier: GPL-3.0-or-later
"""Planes seen under 89.99 degrees in a white world: each shows its directional albedo.

Lambert's is its colour. GGX's comes from quadrature (lib/microfacets/albedo.py, itself held to adaptive quadrature by its tests).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import bpy
import numpy as np

from ...lib.microfacets.albedo import integrate_albedo
from .. import building
from .edge_case import EdgeCase, look, start

ALPHA, ALBEDO = 0.3, 0.8
ANGLE = math.radians(89.99)


def _build(name: str, material: Callable[[], bpy.types.Material]) -> None:
    start(name)
    building.world((1.0, 1.0, 1.0))
    building.rectangle("Plane", material(), (0.0, 0.0, 0.0), (400.0, 0.0, 0.0), (0.0, 400.0, 0.0))
    look((0.0, 0.0, 0.0), (math.sin(ANGLE), 0.0, math.cos(ANGLE)), 400.0, 0.01)


def _albedo() -> float:
    return float(integrate_albedo(np.array([math.cos(ANGLE)]), np.array([ALPHA]), 60, 40)[0])


CASES = (
    EdgeCase(
        "89.99 degrees, Lambert",
        lambda: _build("grazing Lambert", lambda: building.diffuse("White", (ALBEDO,) * 3)),
        ALBEDO,
        1e-5,
        16,
        "the albedo",
    ),
    EdgeCase(
        "89.99 degrees, GGX",
        lambda: _build("grazing GGX", lambda: building.glossy("Glossy", "GGX", ALPHA, (1.0, 1.0, 1.0))),
        _albedo(),
        3e-3,
        1024,
        "directional albedo by quadrature",
    ),
)
