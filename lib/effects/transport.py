# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions about light transport.

What emits light, what is sampled, what can be hidden, and how far paths go.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..scene.expressions import Constant, EnvironmentTexture
from ..scene.materials import Emission
from ..scene.rays import SCATTERED, STEADY_FLAGS
from ..scene.sky import Sky
from ..textures.fold import walk
from .facts import Facts
from .geometry import Answer
from .masks import reads_flags
from .surface import Question, named

# Roulette may end paths at this scattering, counted from 0, and after it.
ROULETTE_AFTER = 2


def light(kind: type | tuple[type, ...], test: Callable[..., bool] = lambda _: True) -> Question:
    """Whether a light object of `kind` that passes the test sends out anything."""
    return lambda facts: named(
        [x.name for x in facts.lights if isinstance(x, kind) and test(x)], "light", "no such light shines"
    )


def lens(facts: Facts) -> Answer:
    """Whether the camera's rays come from a lens rather than a point."""
    aperture = facts.scene.camera.aperture
    if aperture is None or aperture.radius == 0.0:
        return False, "the camera has no depth of field"
    return True, f"the camera's lens has a radius of {aperture.radius:.4g} m"


def motion(facts: Facts) -> Answer:
    """Whether anything moves while the shutter is open."""
    keys = facts.scene.motion
    if keys is None:
        return False, "no motion is simulated"
    moving = sorted({*keys.objects, *keys.positions})
    names = [facts.scene.mesh.objects[k].name for k in moving] + ["the camera"] * (keys.camera is not None)
    return named(names, "while the shutter is open, these move:", "nothing moves while the shutter is open")


def transparency(facts: Facts) -> Answer:
    """Whether light passes faces."""
    return named(facts.transparent, "material", "no material that is seen has such a lobe")


def emission(facts: Facts) -> Answer:
    """Whether faces emit light."""
    return named(facts.named(Emission), "material", "no material emits light")


def constant_world(facts: Facts) -> Answer:
    """Whether the same light comes from everywhere."""
    world = facts.world
    if not isinstance(world, Constant):
        return False, "the world's colour depends on the direction"
    if not facts.world_shines:
        return False, "the world is black"
    value = np.round(np.broadcast_to(world.value, (3,)), 4).tolist()
    return True, f"the world's radiance is {value} everywhere"


def environment_world(facts: Facts) -> Answer:
    """Whether the world must be asked for each direction."""
    if not facts.world_varies:
        return False, "the world's colour is the same in every direction"
    nodes = list(walk(facts.world))
    skies = [node for node in nodes if isinstance(node, Sky)]
    if skies:
        disc = ", its sun's disc apart" if any(sky.sun for sky in skies) else ""
        return True, f"the world is lit by a sky, as Blender renders it{disc}"
    textured = any(isinstance(node, EnvironmentTexture) for node in nodes)
    return True, f"the world {'is lit by an environment texture' if textured else 'depends on the direction'}"


def environment_table(facts: Facts) -> Answer:
    """Whether directions are chosen by where the world is bright."""
    needed, fact = environment_world(facts)
    if needed and reads_flags(facts.scene.world, *STEADY_FLAGS):
        return False, "the world depends on the kind of ray"
    if needed and not facts.rough:
        return False, _only_smooth(facts)
    return needed, fact


def mesh_lights(facts: Facts) -> Answer:
    """Whether emissive faces are sampled as lights."""
    needed, fact = emission(facts)
    again, why = facts.meets_again
    if needed and not again:
        return False, f"what faces emit lights no other: {why}"
    if needed and not facts.rough:
        return False, _only_smooth(facts)
    return needed, fact


def _only_smooth(facts: Facts) -> str:
    return "mirrors and smooth glass find light by themselves" if facts.scattering else "no material scatters light"


def _sampled(facts: Facts) -> int:
    """How many lights light sampling can choose from."""
    return len(facts.lights) + environment_table(facts)[0] + _mesh_samplers(facts)


def _mesh_samplers(facts: Facts) -> int:
    """Return how many samplers emissive faces have.

    There is one for faces that the same rays see and that are linked alike.
    """
    kinds = {(thing.rays, thing.links) for thing in facts.shining if thing.rays & SCATTERED}
    return len(kinds) if mesh_lights(facts)[0] else 0


def light_sampling(facts: Facts) -> Answer:
    """Whether directions towards lights are sampled."""
    count = _sampled(facts)
    if count and not facts.rough:
        return False, _only_smooth(facts)
    return count > 0, f"{count} light{'s' * (count > 1)} to sample" if count else "no light but what rays run into"


def light_selection(facts: Facts) -> Answer:
    """Whether there is a choice of lights."""
    if not light_sampling(facts)[0]:
        return False, "no light is sampled"
    count = _sampled(facts)
    return count > 1, f"{count} lights to choose from" if count > 1 else "one light: nothing to choose"


def multiple_importance_sampling(facts: Facts) -> Answer:
    """Whether light can be found both by sampling lights and by sampling lobes."""
    if not light_sampling(facts)[0]:
        return False, "no light is sampled"
    broad = [x.name for x in facts.broad_lights]
    broad += ["world"] * environment_table(facts)[0] + ["emitting faces"] * mesh_lights(facts)[0]
    return named(broad, "both light and lobe sampling find", "lights without size are found by light sampling alone")


def shadow_rays(facts: Facts) -> Answer:
    """Whether a sampled light can be hidden."""
    if not light_sampling(facts)[0]:
        return False, "no light is sampled"
    again, why = facts.meets_again
    if not again:
        return False, f"nothing hides a light: {why}"
    return True, f"faces can hide {'a light' if _sampled(facts) == 1 else 'lights'}: {why}"


def _met_by_rays(facts: Facts) -> list[str]:
    """The sources that a scattered ray can run into."""
    met = [x.name for x in facts.broad_lights] + ["world"] * facts.world_shines + facts.glowing
    if facts.meets_again[0]:
        met += ["emitting faces"] * emission(facts)[0] + facts.unknown
    return met


def scattered_rays(facts: Facts) -> Answer:
    """Whether directions are sampled in which paths go on."""
    if not facts.scattering:
        return False, "no material scatters light"
    met = _met_by_rays(facts)
    if met:
        return named(met, "scattered rays can run into", "")
    if facts.scene.transport.max_bounces and facts.meets_again[0] and light_sampling(facts)[0]:
        return True, "faces light each other"
    return False, "a scattered ray can run into no light, nor into a face that is lit"


def last_rays(facts: Facts) -> Answer:
    """Whether the ray after the last scattering can still find light."""
    met = _met_by_rays(facts) if facts.scattering else []
    return named(met, "the last ray can run into", "the last ray of a path can run into no light")


def last_hits(facts: Facts) -> Answer:
    """Whether it matters where the last ray ends, and not only that it ends."""
    needed, fact = last_rays(facts)
    again, why = facts.meets_again
    if not needed or not again:
        return False, why if needed else fact
    if facts.transparent:
        return True, "transparent faces let paths end at different steps"
    met = [x.name for x in facts.broad_lights] + ["emitting faces"] * emission(facts)[0]
    return named(met, "the last ray can run into", "all that matters of the last ray is whether it leaves the scene")


def second_hits(facts: Facts) -> Answer:
    """Return whether scattered rays, and those through transparent faces, are intersected."""
    again, why = facts.meets_again
    if again and not scattered_rays(facts)[0] and not facts.transparent:
        return False, "no ray goes on from the first face"
    return again, why


def indirect_light(facts: Facts) -> Answer:
    """Whether paths scatter more than once."""
    bounces = facts.scene.transport.max_bounces
    if not bounces:
        return False, "bounces are set to 0"
    if not scattered_rays(facts)[0]:
        return False, scattered_rays(facts)[1]
    again, why = facts.meets_again
    return again, f"up to {bounces} bounces after the first hit" if again else f"no path meets a second face: {why}"


def roulette(facts: Facts) -> Answer:
    """Whether paths get so long that some may be ended at random."""
    bounces = facts.scene.transport.max_bounces
    if not scattered_rays(facts)[0] or not facts.meets_again[0]:
        return False, "no path meets a second face"
    if bounces >= ROULETTE_AFTER:
        return True, f"paths of up to {bounces} bounces"
    if facts.transparent:
        return True, "transparent faces count as steps of a path"
    return False, f"no path scatters more than {bounces + 1} time{'s' * (bounces > 0)}"
