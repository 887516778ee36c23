# SPDX-License-Identifier: GPL-3.0-or-later
"""How many light sources a scene has in all, as far as Cycles' settings depend on it."""

from __future__ import annotations

from ..scene.scene import Scene
from .facts import Facts


def has_one_light(scene: Scene) -> bool:
    """Whether one light object is all that can shine.

    There is no other one, the world is black, no face and no volume emits, and no material is unsupported.
    """
    facts = Facts(scene)
    return len(scene.lights) == 1 and not (facts.world_shines or facts.shining or facts.glowing or facts.unknown)
