# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with no size or no power, and the narrowest and widest spots, over a plane.

The spots are the narrowest and widest that Blender allows, the plane is Lambert's. A spot of radius 0 and power W gives
the intensity W / (4 pi) within its cone, and the point below it W / (4 pi h^2). The lights without size or power add
nothing; nor does the narrowest spot, which shines beside what the camera sees. An area light of no area has a radiance
that is no number, and lights nothing in either renderer.
"""

from __future__ import annotations

import math

from .. import building
from .edge_case import EdgeCase, light, look, start

ALBEDO, POWER, HEIGHT = 0.5, 100.0, 2.0


def _plane() -> None:
    white = building.diffuse("White", (ALBEDO,) * 3)
    building.rectangle("Plane", white, (0.0, 0.0, 0.0), (9.0, 0.0, 0.0), (0.0, 9.0, 0.0))
    look((0.0, 0.0, 0.0), (0.1, 0.2, 1.0), 4.0, 0.002)


def _build_spots() -> None:
    start("spots")
    _plane()
    wide = {"energy": POWER, "shadow_soft_size": 0.0, "spot_size": math.pi, "spot_blend": 0.0}
    light("Wide", "SPOT", (0.0, 0.0, HEIGHT), **wide)
    light("Narrow", "SPOT", (1.0, 0.0, HEIGHT), **{**wide, "spot_size": 0.0})


def _build_nothing() -> None:
    start("nothing")
    _plane()
    light("No size", "AREA", (0.3, 0.0, HEIGHT), energy=POWER, size=0.0)
    light("No power", "POINT", (0.0, 0.3, HEIGHT), energy=0.0, shadow_soft_size=0.1)
    light("No power, spot", "SPOT", (0.0, -0.3, HEIGHT), energy=0.0)
    light("No power, sun", "SUN", (0.0, 0.0, HEIGHT), energy=0.0)


CASES = (
    EdgeCase(
        "spots of 180 degrees and of the least angle",
        _build_spots,
        ALBEDO / math.pi * POWER / (4.0 * math.pi * HEIGHT**2),
        5e-4,
        64,
        "albedo / pi x intensity / height^2; the choice between two lights leaves some noise",
    ),
    EdgeCase("lights without size or power", _build_nothing, 0.0, 0.0, 16, "no light"),
)
