# SPDX-License-Identifier: GPL-3.0-or-later
"""Four plates of growing roughness under four lights of growing size.

Sampling the light or the lobe alone fails there. After E. Veach and L. J. Guibas, "Optimally Combining Sampling
Techniques for Monte Carlo Rendering" (1995), figure 2, with lights of equal power. No closed form: the expectation is
Cycles' own, measured.
"""

from __future__ import annotations

import math

import mathutils
import numpy as np

from . import building
from .expectation import Expectation

WIDTH, HEIGHT = 384, 256
MAX_BOUNCES = 4
ALPHAS = (0.005, 0.02, 0.06, 0.16)
RADII = (0.03, 0.1, 0.3, 0.8)
EYE = (0.1, -9.0, 4.4)
LIGHTS_AT = (0.0, 5.5)

EXPECTATIONS: tuple[Expectation, ...] = ()


def build() -> None:
    """Make this the open scene."""
    building.start("veach_plates", WIDTH, HEIGHT, MAX_BOUNCES)
    building.world((0.015, 0.017, 0.022))
    wall = building.diffuse("Wall", (0.35, 0.35, 0.36))
    building.rectangle("Floor", wall, (0.0, 0.0, -0.35), (40.0, 0.0, 0.0), (0.0, 40.0, 0.0))
    building.rectangle("Wall", wall, (0.0, 6.5, 9.0), (40.0, 0.0, 0.0), (0.0, 0.0, 40.0))
    eye, lights = mathutils.Vector(EYE), mathutils.Vector((0.0, *LIGHTS_AT))
    for i, (alpha, y) in enumerate(zip(ALPHAS, (2.6, 1.2, -0.1, -1.3), strict=True)):
        center = mathutils.Vector((0.0, y, 1.55 - 0.55 * i))
        normal = ((eye - center).normalized() + (lights - center).normalized()).normalized()
        along = normal.cross(mathutils.Vector((1.0, 0.0, 0.0))).normalized() * 1.05
        material = building.glossy(f"Plate {alpha}", "GGX", alpha, (0.85, 0.85, 0.85))
        building.rectangle(material.name, material, tuple(center), (6.5, 0.0, 0.0), tuple(along))
    hues = ((1.0, 0.35, 0.25), (1.0, 0.85, 0.3), (0.4, 1.0, 0.45), (0.35, 0.55, 1.0))
    for i, (radius, hue) in enumerate(zip(RADII, hues, strict=True)):
        radiance = 240.0 / (4 * math.pi**2 * radius**2)
        place = (float(np.interp(i, (0, 3), (-2.55, 2.35))), *LIGHTS_AT)
        building.sphere_light(f"Light {radius}", place, radius, tuple(radiance * c for c in hue))
    building.camera(EYE, (0.0, 1.2, 1.45), lens=42.0)
