# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions about who sees whom.

They concern masks of rays, linked lights, and lights without shadows or with few bounces.
"""

from __future__ import annotations

from ..scene.expressions import AfterDiffuse, Expression, RayCount, RayFlag
from ..scene.links import EVERY_SET
from ..scene.materials import Material, Transparent, WeightedClosure
from ..scene.rays import COUNTS, COUNTS_OF_ALL_RAYS, EVERY, SCATTERED, SEEN, has_bits, tells_shadows_apart
from ..scene.world import World
from ..textures.fold import walk
from .facts import Facts
from .geometry import Answer
from .surface import named

AFTER_DIFFUSE = "AFTER_DIFFUSE"


def hidden_objects(facts: Facts) -> Answer:
    """Whether some rays pass through objects that others meet."""
    hidden = [item.name for item in facts.scene.mesh.objects if item.rays != EVERY]
    return named(hidden, "some rays do not meet object", "every ray meets every object")


def shadow_catchers(facts: Facts) -> Answer:
    """Whether there are shadow catchers, whose shown pixels are not compared."""
    catchers = [item.name for item in facts.scene.mesh.objects if item.catches_shadows]
    return named(catchers, "shown pixels are set aside: shadow catcher", "no object is a shadow catcher")


def ray_kinds(facts: Facts) -> Answer:
    """Whether it matters what kind of lobe scattered a ray."""
    hidden = [item.name for item in facts.scene.mesh.objects if not has_bits(item.rays, SCATTERED)]
    hidden += [light.name for light in facts.lights if not has_bits(light.rays, SCATTERED)]
    hidden += flagged(facts)
    hidden += ["world"] * (facts.world_shines and not has_bits(facts.scene.world.rays, SEEN))
    return named(hidden, "not all rays that surfaces scatter see", "what is seen does not depend on the kind of ray")


def ray_flags(facts: Facts) -> Answer:
    """Whether shaders ask of what kind a ray is."""
    return named(flagged(facts), "the kind of ray is asked for by", "no shader asks for the kind of ray")


def ray_counts(facts: Facts) -> Answer:
    """Whether shaders ask how often a path has scattered, or how long its last ray is."""
    asking = [m.name for m in facts.materials if flags_in(m) & {*COUNTS, AFTER_DIFFUSE}]
    return named(
        asking, "the depth or length of rays is asked for by", "no shader asks for the depth or length of a ray"
    )


def flagged(facts: Facts) -> list[str]:
    """Names of the materials, and of the world, that ask of what kind a ray is."""
    return [m.name for m in facts.materials if reads_flags(m)] + ["world"] * reads_flags(facts.scene.world)


def reads_flags(owner: Material | World, *others: str) -> bool:
    """Whether a material or world asks of what kind a ray is, except for the flags `others`."""
    return bool(flags_in(owner) - set(others))


def flags_in(owner: Material | World | WeightedClosure) -> set[str]:
    """Return the ray flags and counts that a material, a part of it or a world reads, by name.

    AFTER_DIFFUSE stands for the question whether a diffuse lobe came before, which only subsurface scattering asks.
    """
    if isinstance(owner, Material):
        return set().union(*map(flags_in, owner.lobes))
    sockets = [owner.radiance] if isinstance(owner, World) else [owner.weight, *vars(owner.closure).values()]
    nodes = [n for v in sockets if isinstance(v, Expression) for n in walk(v)]
    found = {n.flag for n in nodes if isinstance(n, RayFlag)} | {n.count for n in nodes if isinstance(n, RayCount)}
    return found | {AFTER_DIFFUSE for n in nodes if isinstance(n, AfterDiffuse)}


def shadows_apart(facts: Facts) -> Answer:
    """Whether shadow rays meet other faces than the rays that lobes choose."""
    things = [item.name for item in facts.scene.mesh.objects if tells_shadows_apart(item.rays)]
    things += [m.name for m in facts.materials if shades_transparently(m)]
    return named(things, "shadow rays and scattered rays differ on", "shadow rays meet what scattered rays meet")


def shades_transparently(material: Material) -> bool:
    """Whether shadow rays pass a material otherwise than scattered rays do."""
    clear = [lobe for lobe in material.lobes if isinstance(lobe.closure, Transparent)]
    same = {"CAMERA", *COUNTS_OF_ALL_RAYS}
    return any(not material.transparent_shadows or flags_in(lobe) - same for lobe in clear)


def lights_without_shadows(facts: Facts) -> Answer:
    """Whether a light shines through faces."""
    lights = [light.name for light in facts.lights if not light.casts_shadow]
    return named(lights, "faces do not hide light", "faces hide all lights")


def light_bounces(facts: Facts) -> Answer:
    """Whether a light lights fewer points of a path than there are."""
    bounces = facts.scene.transport.max_bounces
    lights = [light.name for light in facts.lights if light.max_bounces < bounces]
    return named(lights, "fewer bounces than paths have reaches light", "all lights reach as far as paths")


def linked_lights(facts: Facts) -> Answer:
    """Whether an emitter lights some objects only."""
    linked = [one.name for one in (*facts.lights, *facts.shining) if one.links.receivers != EVERY_SET]
    return named(linked, "some objects are not lit by", "every light reaches every object")


def linked_shadows(facts: Facts) -> Answer:
    """Whether some objects do not hide an emitter."""
    linked = [one.name for one in (*facts.lights, *facts.shining) if one.links.blockers != EVERY_SET]
    return named(linked, "some objects do not hide", "every object hides every light")
