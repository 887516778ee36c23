# SPDX-License-Identifier: GPL-3.0-or-later
"""A white furnace: a convex vault of flat tiles in a world of radiance 1.

Each tile shows its directional albedo. Eight columns tilt away from the orthographic viewer, four rows differ in
material. Nothing that leaves a convex body meets it again: each tile is single scattering, and its radiance is E(mu),
the integral of f cos over the hemisphere, for the height-correlated Smith masking that Cycles uses and Beckmann's or
GGX's exact Lambda. For GGX it is `directional_albedo` of lib/microfacets/albedo.py, to which
tests/reference_scenes/test_scenes.py holds Cycles. Cycles weighs Beckmann's samples with a rational fit of Lambda, good
to 0.31 %.
"""

from __future__ import annotations

import math

import numpy as np

from . import building
from .expectation import Expectation

TILE = 32
MAX_BOUNCES = 0
ROWS = (("BECKMANN", 0.1), ("BECKMANN", 0.5), ("GGX", 0.1), ("GGX", 0.5))
TILTS = tuple(math.radians(angle) for angle in (-77.0, -60.0, -40.0, -15.0, 10.0, 33.0, 52.0, 70.0))
WIDTH, HEIGHT = TILE * (len(TILTS) + 2), TILE * (len(ROWS) + 2)

EXPECTATIONS: tuple[Expectation, ...] = ()


def build() -> None:
    """Make this the open scene: one unit of length across a tile as the camera sees it."""
    building.start("furnace", WIDTH, HEIGHT, MAX_BOUNCES)
    building.world((1.0, 1.0, 1.0))
    heights = np.concatenate([[0.0], np.cumsum(-np.tan(TILTS))])
    x = np.arange(len(TILTS) + 1) - len(TILTS) / 2
    y = len(ROWS) / 2 - np.arange(len(ROWS) + 1)
    vertices = np.stack([np.tile(x, len(y)), np.repeat(y, len(x)), np.tile(heights - heights.max(), len(y))], axis=1)
    corner = np.add.outer(np.arange(len(ROWS)) * len(x), np.arange(len(TILTS))).ravel()
    faces = np.stack([corner, corner + len(x), corner + len(x) + 1, corner + 1], axis=1)
    materials = [building.glossy(f"{kind} {alpha}", kind, alpha, (1.0, 1.0, 1.0)) for kind, alpha in ROWS]
    building.mesh("Vault", vertices, faces, materials, material_index=np.repeat(np.arange(len(ROWS)), len(TILTS)))
    building.camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), ortho_scale=WIDTH / TILE)
