# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of lights."""

from __future__ import annotations

from ..scene.findings import OVERLAPPING_LIGHTS, Finding, list_areas
from ..scene.light_overlaps import find_light_overlaps
from ..scene.scene import Scene


def find_overlapping_lights(scene: Scene) -> Finding | None:
    """Find area lights that overlap in one plane; the largest area is first."""
    found = find_light_overlaps(scene.lights)
    if not found:
        return None
    pairs = [(f"'{scene.lights[a].name}' and '{scene.lights[b].name}'", area) for a, b, area in found]
    return Finding(
        OVERLAPPING_LIGHTS,
        f"Area lights share a plane and an area of it: {list_areas(pairs, 'pair', 'pairs')}.",
        "Rays that Cycles scatters meet only one of them, so that the scene is too dark; the reference adds up both.",
        "Move one of each pair by a millimetre, or delete it.",
    )
