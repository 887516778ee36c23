# SPDX-License-Identifier: GPL-3.0-or-later
"""A tilted Lambert plane under the sun, far from the origin, tiny, and huge.

It has small triangles. Radiance = albedo / pi x irradiance x cos(theta), wherever it stands and however large it is:
every deviation is an error of a position or of a normal. Self-shadowing would show as black, for the sun stands low
over the plane.
"""

from __future__ import annotations

import math

import numpy as np

from .. import building
from .edge_case import EdgeCase, look, start, sun

ALBEDO, IRRADIANCE = 0.5, 2.0
TILT = (0.31, -0.17, 0.4)
COSINE = 0.2
CELLS = 24


def _normal() -> np.ndarray:
    """The plane's z axis after Blender's XYZ Euler rotation by TILT."""
    x, y, z = TILT
    turned = np.array([math.sin(y) * math.cos(x), -math.sin(x), math.cos(y) * math.cos(x)])
    return np.array(
        [
            math.cos(z) * turned[0] - math.sin(z) * turned[1],
            math.sin(z) * turned[0] + math.cos(z) * turned[1],
            turned[2],
        ]
    )


def _build(name: str, offset: tuple[float, float, float], size: float) -> None:
    start(name, max_bounces=2)
    step = np.linspace(-2.0 * size, 2.0 * size, CELLS + 1)
    x, y = (grid.ravel() for grid in np.meshgrid(step, step))
    vertices = np.stack([x, y, np.zeros_like(x)], axis=1)
    corner = np.add.outer(np.arange(CELLS) * (CELLS + 1), np.arange(CELLS)).ravel()
    faces = np.stack([corner, corner + 1, corner + CELLS + 2, corner + CELLS + 1], axis=1)
    plane = building.mesh("Plane", vertices, faces, [building.diffuse("White", (ALBEDO,) * 3)], offset)
    plane.rotation_euler = TILT
    normal = _normal()
    across = np.cross(normal, (0.0, 1.0, 0.0))
    across /= np.linalg.norm(across)
    sun(tuple(-(COSINE * normal + math.sqrt(1.0 - COSINE**2) * across)), IRRADIANCE)
    look(offset, tuple(normal + 0.3 * across), 4.0 * size, 1.7 * size)


def _case(name: str, offset: tuple[float, float, float], size: float, tolerance: float) -> EdgeCase:
    radiance = ALBEDO / math.pi * IRRADIANCE * COSINE
    return EdgeCase(
        name, lambda: _build(name, offset, size), radiance, tolerance, 16, "albedo / pi x irradiance x cosine"
    )


CASES = (
    _case("1 m from the origin", (0.6, -0.64, 0.48), 1.0, 1e-4),
    _case("100 m from the origin", (60.0, -64.0, 48.0), 1.0, 1e-4),
    _case("10 km from the origin", (6e3, -6.4e3, 4.8e3), 1.0, 1e-3),
    _case("100 km from the origin", (6e4, -6.4e4, 4.8e4), 1.0, 1e-3),
    _case("a millimetre across", (0.0, 0.0, 0.0), 1e-3, 1e-4),
    _case("10 km across", (0.0, 0.0, 0.0), 1e4, 1e-4),
)
