# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of shadows: settings for which Cycles' image depends on how it samples lights."""

from __future__ import annotations

from ..effects.facts import Facts
from ..effects.masks import light_bounces, lights_without_shadows, linked_shadows, shadows_apart
from ..effects.transport import multiple_importance_sampling
from ..scene.findings import Finding
from ..scene.scene import Scene


def find_shadows_apart(scene: Scene) -> Finding | None:
    """Find lights whose light depends on how it is sampled.

    They have a size, and light samples and the rays that lobes choose do not find the same light.
    """
    facts = Facts(scene)
    answers = [question(facts) for question in (shadows_apart, lights_without_shadows, linked_shadows, light_bounces)]
    causes = [fact for needed, fact in answers if needed]
    if not causes or not multiple_importance_sampling(facts)[0]:
        return None
    return Finding(
        "shadows apart",
        f"Direct light depends on how it is found: {'; '.join(causes)}.",
        "The reference asks shadow rays; Cycles mixes both answers, the more the broader a light is, and the renderers differ by that.",
        "Hide the object from shadow rays and all scattered rays alike, or from none; or make the lights small.",
    )
