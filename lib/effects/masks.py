# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions about who sees whom: masks of rays, lights without shadows, lights that shine only so many bounces far."""

from __future__ import annotations

from ..scene.materials import Material, Transparent
from ..scene.rays import EVERY, SCATTERED, SEEN, has_bits, tells_shadows_apart
from .facts import Facts
from .geometry import Answer
from .surface import named


def hidden_objects(facts: Facts) -> Answer:
    """Whether some rays pass through objects that others meet."""
    hidden = [item.name for item in facts.scene.mesh.objects if item.rays != EVERY]
    return named(hidden, "some rays do not meet object", "every ray meets every object")


def ray_kinds(facts: Facts) -> Answer:
    """Whether it matters what kind of lobe scattered a ray."""
    hidden = [item.name for item in facts.scene.mesh.objects if not has_bits(item.rays, SCATTERED)]
    hidden += [light.name for light in facts.lights if not has_bits(light.rays, SCATTERED)]
    hidden += ["world"] * (facts.world_shines and not has_bits(facts.scene.world.rays, SEEN))
    return named(hidden, "not all rays that surfaces scatter see", "what is seen does not depend on the kind of ray")


def shadows_apart(facts: Facts) -> Answer:
    """Whether shadow rays meet other faces than the rays that lobes choose."""
    things = [item.name for item in facts.scene.mesh.objects if tells_shadows_apart(item.rays)]
    things += [m.name for m in facts.materials if shades_transparently(m)]
    return named(things, "shadow rays and scattered rays differ on", "shadow rays meet what scattered rays meet")


def shades_transparently(material: Material) -> bool:
    """Whether shadow rays take for opaque what scattered rays pass."""
    passes = any(isinstance(lobe.closure, Transparent) for lobe in material.lobes)
    return passes and not material.transparent_shadows


def lights_without_shadows(facts: Facts) -> Answer:
    """Whether a light shines through faces."""
    lights = [light.name for light in facts.lights if not light.casts_shadow]
    return named(lights, "faces do not hide light", "faces hide all lights")


def light_bounces(facts: Facts) -> Answer:
    """Whether a light lights fewer points of a path than there are."""
    bounces = facts.scene.transport.max_bounces
    lights = [light.name for light in facts.lights if light.max_bounces < bounces]
    return named(lights, "fewer bounces than paths have reaches light", "all lights reach as far as paths")
