# SPDX-License-Identifier: GPL-3.0-or-later
"""A closed room with glossy walls: most of its light has been scattered more than once.

A Cornell box after C. M. Goral et al., "Modeling the Interaction of Light Between Diffuse Surfaces" (1984), with the camera inside and the
front closed, its walls Beckmann, a tall box GGX and a sphere GGX. No closed form: the expectation is Cycles' own, measured.
"""

from __future__ import annotations

from . import building
from .expectation import Expectation

WIDTH = HEIGHT = 256
MAX_BOUNCES = 8

EXPECTATIONS: tuple[Expectation, ...] = ()


def build() -> None:
    """Make this the open scene: a room of 2 x 5 x 2 m."""
    building.start("cornell_glossy", WIDTH, HEIGHT, MAX_BOUNCES)
    building.world((0.0, 0.0, 0.0))
    white = building.glossy("White", "BECKMANN", 0.64, (0.76, 0.75, 0.72))
    red = building.glossy("Red", "BECKMANN", 0.49, (0.66, 0.10, 0.08))
    green = building.glossy("Green", "BECKMANN", 0.49, (0.14, 0.48, 0.12))
    building.rectangle("Floor", white, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 5.0, 0.0))
    building.rectangle("Ceiling", white, (0.0, 0.0, 2.0), (0.0, 5.0, 0.0), (2.0, 0.0, 0.0))
    building.rectangle("Back", white, (0.0, 2.5, 1.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    building.rectangle("Front", white, (0.0, -2.5, 1.0), (0.0, 0.0, 2.0), (2.0, 0.0, 0.0))
    building.rectangle("Left", red, (-1.0, 0.0, 1.0), (0.0, 5.0, 0.0), (0.0, 0.0, 2.0))
    building.rectangle("Right", green, (1.0, 0.0, 1.0), (0.0, 0.0, 2.0), (0.0, 5.0, 0.0))
    steel = building.glossy("Steel", "GGX", 0.16, (0.80, 0.80, 0.83))
    gold = building.glossy("Gold", "GGX", 0.06, (0.95, 0.75, 0.35))
    building.box("Tall box", steel, (-0.37, 1.75, 0.6), (0.56, 0.56, 1.2))
    building.sphere("Gold", gold, (0.42, 1.15, 0.36), 0.36, 200, 101)
    building.area_light("Lamp", (0.0, 1.4, 1.985), (0.0, 1.4, 0.0), (0.7, 0.7), (11.0, 10.0, 8.2))
    building.camera((0.02, -2.40, 1.0), (0.0, 1.0, 0.97), lens=35.0)
