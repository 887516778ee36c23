# SPDX-License-Identifier: GPL-3.0-or-later
"""A Lambertian plane under a rectangular light, where every pixel has a closed form.

The irradiance that a uniform polygon gives is Lambert's: L / 2 times the sum over its edges of the angle an edge subtends times
the cosine between the surface's normal and that of the plane through the edge (J. H. Lambert, Photometria, 1760; in these terms in J. Arvo,
"Analytic Methods for Simulated Light Transport", 1995, eq. 2.33). Radiance is albedo / pi times irradiance. One scattering; the plane
cannot see itself. The regions' numbers are that formula averaged over their pixels.
"""

from __future__ import annotations

from . import building
from .expectation import Expectation

WIDTH = HEIGHT = 256
MAX_BOUNCES = 0
ALBEDO = (0.80, 0.62, 0.40)
LIGHT = (12.0, 12.0, 12.0)
LIGHT_CENTER = (0.30, 0.20, 1.0)
LIGHT_SIZE = (1.2, 0.5)
ACROSS = 4.0

EXPECTATIONS: tuple[Expectation, ...] = ()


def build() -> None:
    """Make this the open scene: seen from above by an orthographic camera, 4 m across."""
    building.start("lambert_analytic", WIDTH, HEIGHT, MAX_BOUNCES)
    building.world((0.0, 0.0, 0.0))
    paper = building.diffuse("Paper", ALBEDO)
    building.rectangle("Paper", paper, (0.37, 0.21, 0.0), (12.0, 0.0, 0.0), (0.0, 12.0, 0.0))
    x, y, _ = LIGHT_CENTER
    building.area_light("Lamp", LIGHT_CENTER, (x, y, 0.0), LIGHT_SIZE, LIGHT)
    building.camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), ortho_scale=ACROSS)
