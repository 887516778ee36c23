# SPDX-License-Identifier: GPL-3.0-or-later
"""Which light passes of a scene can hold any light."""

from __future__ import annotations

import numpy as np

from ..film.light_passes import Family, LightPass, direct, indirect
from ..scene.materials import Emission, Transparent
from ..scene.rays import CAMERA, has_bits
from ..scene.scene import Scene
from .facts import Facts
from .names import Effect
from .plan import Plan


def light_passes(scene: Scene, plan: Plan) -> tuple[LightPass, ...]:
    """Return the passes that may hold light, in their order.

    They follow from the lobes of the materials that are seen, the lights and the world. Beside shadow catchers two are
    left out: Cycles' environment pass shows the world behind them, and its emission pass what they emit or let through.
    """
    facts = Facts(scene)
    closures = [type(lobe.closure) for material in facts.materials for lobe in material.lobes]
    families = {family for closure in closures for family in closure.families}
    if facts.turbid:
        families.add(Family.VOLUME)
    found = set()
    for family in families:
        found.add(direct(family))
        if plan.needs(Effect.INDIRECT_LIGHT):
            found.add(indirect(family))
    if (
        plan.needs(Effect.EMISSION)
        or facts.glowing
        or any(has_bits(light.rays, CAMERA) for light in facts.broad_lights)
    ):
        found.add(LightPass.EMISSION)
    if plan.needs(Effect.CONSTANT_WORLD) or plan.needs(Effect.ENVIRONMENT_WORLD):
        found.add(LightPass.ENVIRONMENT)
    return tuple(name for name in LightPass if name in found - _seen_through_catchers(scene, plan))


def _seen_through_catchers(scene: Scene, plan: Plan) -> set[LightPass]:
    """The passes to which Cycles adds light that camera rays find on shadow catchers and behind them."""
    if not plan.needs(Effect.SHADOW_CATCHERS):
        return set()
    mesh = scene.mesh
    catches = np.array([thing.catches_shadows for thing in mesh.objects])[mesh.object_index]
    materials = [scene.materials[k] for k in np.unique(mesh.material_index[catches])]
    shows = any(m.unknown or any(isinstance(x.closure, Emission | Transparent) for x in m.lobes) for m in materials)
    return {LightPass.ENVIRONMENT, LightPass.EMISSION} if shows else {LightPass.ENVIRONMENT}
