# SPDX-License-Identifier: GPL-3.0-or-later
"""Three glossy spheres on a glossy plane under an area light, for benchmarks.

The spheres have flat triangles. The large one has 160,000, GGX, alpha 0.25; beside it GGX alpha 0.09 and Beckmann alpha
0.49; the plane is Beckmann, alpha 0.36. Five scatterings. No closed form: the expectation is Cycles' own, measured.
"""

from __future__ import annotations

from . import building
from .expectation import Expectation

WIDTH = HEIGHT = 256
MAX_BOUNCES = 4

EXPECTATIONS: tuple[Expectation, ...] = ()


def build() -> None:
    """Make this the open scene."""
    building.start("glossy_spheres", WIDTH, HEIGHT, MAX_BOUNCES)
    building.world((0.62, 0.68, 0.78))
    ground = building.glossy("Ground", "BECKMANN", 0.36, (0.62, 0.60, 0.57))
    building.rectangle("Ground", ground, (0.0, 0.0, 0.0), (40.0, 0.0, 0.0), (0.0, 40.0, 0.0))
    silver = building.glossy("Silver", "GGX", 0.25, (0.86, 0.86, 0.84))
    copper = building.glossy("Copper", "GGX", 0.16, (0.89, 0.55, 0.38))
    lapis = building.glossy("Lapis", "BECKMANN", 0.49, (0.28, 0.44, 0.80))
    building.sphere("Silver", silver, (0.0, 0.25, 1.0), 1.0, 400, 201)
    building.sphere("Copper", copper, (-1.35, -0.75, 0.6), 0.6, 256, 129)
    building.sphere("Lapis", lapis, (1.30, -0.70, 0.5), 0.5, 256, 129)
    building.area_light("Lamp", (3.0, -2.6, 5.2), (0.0, 0.0, 0.6), (4.0, 4.0), (2.8, 2.65, 2.4))
    building.camera((0.55, -7.2, 2.7), (0.0, 0.0, 0.72), lens=60.0)
