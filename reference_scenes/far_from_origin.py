# SPDX-License-Identifier: GPL-3.0-or-later
"""Glossy spheres ten kilometres from the origin.

Neighbouring float32 numbers lie a millimetre apart there. The content is that of `glossy_spheres`, ten times as large
and of coarser triangles, so that what a millimetre does to a triangle's normal stays below a thousandth. No closed
form: moving a scene changes nothing but rounding, so the expectation is the image of the same content at the origin.
"""

from __future__ import annotations

import mathutils

from . import building
from .expectation import Expectation

WIDTH = HEIGHT = 256
MAX_BOUNCES = 4
OFFSET = (6000.0, -8000.0, 0.0)

EXPECTATIONS: tuple[Expectation, ...] = ()


def build(offset: tuple[float, float, float] = OFFSET) -> None:
    """Make this the open scene, with everything moved by `offset`."""

    def at(x: float, y: float, z: float) -> tuple[float, float, float]:
        return tuple(mathutils.Vector((x, y, z)) + mathutils.Vector(offset))

    building.start("far_from_origin", WIDTH, HEIGHT, MAX_BOUNCES)
    building.world((0.62, 0.68, 0.78))
    ground = building.glossy("Ground", "BECKMANN", 0.36, (0.62, 0.60, 0.57))
    building.rectangle("Ground", ground, at(0.0, 0.0, 0.0), (400.0, 0.0, 0.0), (0.0, 400.0, 0.0))
    silver = building.glossy("Silver", "GGX", 0.25, (0.86, 0.86, 0.84))
    copper = building.glossy("Copper", "GGX", 0.16, (0.89, 0.55, 0.38))
    lapis = building.glossy("Lapis", "BECKMANN", 0.49, (0.28, 0.44, 0.80))
    building.sphere("Silver", silver, at(0.0, 2.5, 10.0), 10.0, 96, 49)
    building.sphere("Copper", copper, at(-13.5, -7.5, 6.0), 6.0, 64, 33)
    building.sphere("Lapis", lapis, at(13.0, -7.0, 5.0), 5.0, 64, 33)
    building.area_light("Lamp", at(30.0, -26.0, 52.0), at(0.0, 0.0, 6.0), (40.0, 40.0), (2.8, 2.65, 2.4))
    building.camera(at(5.5, -72.0, 27.0), at(0.0, 0.0, 7.2), lens=60.0).data.clip_end = 1000.0
