# SPDX-License-Identifier: GPL-3.0-or-later
"""A plane of four glossy strips seen at a grazing angle.

It stands against three lights near the horizon. From left to right GGX alpha 0.05 and 0.3, Beckmann alpha 0.05 and 0.3:
long streaks, where masking counts most. A plane cannot see itself, so this is single scattering.
"""

from __future__ import annotations

from . import building
from .expectation import Expectation

WIDTH, HEIGHT = 384, 192
MAX_BOUNCES = 1
STRIPS = (("GGX", 0.05), ("GGX", 0.3), ("BECKMANN", 0.05), ("BECKMANN", 0.3))
WORLD = (0.10, 0.13, 0.18)

EXPECTATIONS: tuple[Expectation, ...] = ()


def build() -> None:
    """Make this the open scene."""
    building.start("grazing_plane", WIDTH, HEIGHT, MAX_BOUNCES)
    building.world(WORLD)
    for i, (distribution, alpha) in enumerate(STRIPS):
        material = building.glossy(f"{distribution} {alpha}", distribution, alpha, (0.9, 0.9, 0.9))
        x = 2.0 * (i - 1.5)
        building.rectangle(material.name, material, (x, 4.0, 0.0), (2.0, 0.0, 0.0), (0.0, 16.0, 0.0))
    for i, radiance in enumerate(((9.0, 3.2, 1.6), (8.0, 7.0, 4.5), (2.0, 4.5, 9.0), (6.0, 6.0, 6.0))):
        x = 2.0 * (i - 1.5)
        building.area_light(f"Lamp {i + 1}", (x, 13.5, 1.3), (x, 0.0, 0.4), (0.9, 0.9), radiance)
    building.camera((0.07, -7.0, 1.05), (0.0, 4.0, 0.0), lens=38.0)
