# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of lights."""

from __future__ import annotations

from ..scene.findings import OVERLAPPING_LIGHTS, Finding
from ..scene.light_overlaps import find_light_overlaps
from ..scene.scene import Scene

_MOST_PAIRS = 3


def find_overlapping_lights(scene: Scene) -> Finding | None:
    """Find area lights that overlap in one plane; the largest area is first."""
    found = sorted(find_light_overlaps(scene.lights), key=lambda one: -one[2])
    if not found:
        return None
    shown = "; ".join(
        f"'{scene.lights[a].name}' and '{scene.lights[b].name}' ({area:.3g} m²)" for a, b, area in found[:_MOST_PAIRS]
    )
    more = f"; and {len(found) - _MOST_PAIRS} more pairs" if len(found) > _MOST_PAIRS else ""
    return Finding(
        OVERLAPPING_LIGHTS,
        f"Area lights share a plane and an area of it: {shown}{more}.",
        "Rays that Cycles scatters meet only one of them, so that the scene is too dark; the reference adds up both.",
        "Move one of each pair by a millimetre, or delete it.",
    )
