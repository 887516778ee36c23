# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside a closed black body in a bright world.

Rays through shared edges and corners must not leave it. Radiance 0, exactly. 10240 samples a pixel are 10 million rays.
"""

from __future__ import annotations

import bpy

from .. import building
from .edge_case import EdgeCase, start

OUTSIDE = 1e6


def _build() -> None:
    start("closed body", max_bounces=4)
    building.world((OUTSIDE,) * 3)
    building.sphere("Body", building.diffuse("Black", (0.0, 0.0, 0.0)), (0.0, 0.0, 0.0), 1.0, 48, 24)
    # From a point of no symmetry; the lens takes in most of the body.
    building.camera((0.11, -0.23, 0.07), (0.4, 0.7, -0.2), lens=12.0)
    bpy.context.scene.camera.data.clip_start = 1e-6


CASES = (EdgeCase("inside a closed body", _build, 0.0, 0.0, 10240, "no light enters a closed body"),)
