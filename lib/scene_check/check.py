# SPDX-License-Identifier: GPL-3.0-or-later
"""All checks of a scene, in the order in which they are shown."""

from __future__ import annotations

from collections.abc import Callable

from ..scene.findings import Finding
from ..scene.scene import Scene
from .geometry import find_mirrored, find_overlapping_faces, find_turned_normals
from .lights import find_overlapping_lights
from .materials import find_color_normal_maps, find_negative_colors
from .shadows import find_shadows_apart

CHECKS: tuple[Callable[[Scene], Finding | None], ...] = (
    find_overlapping_faces,
    find_overlapping_lights,
    find_color_normal_maps,
    find_turned_normals,
    find_negative_colors,
    find_mirrored,
    find_shadows_apart,
)


def check_scene(scene: Scene) -> tuple[Finding, ...]:
    """The findings about `scene`: those of its data, then those of the export."""
    found = [finding for check in CHECKS if (finding := check(scene)) is not None]
    return (*found, *scene.findings)
