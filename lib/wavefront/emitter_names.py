# SPDX-License-Identifier: GPL-3.0-or-later
"""The names of a scene's emitters, by the light samplers and faces of a kernel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..effects.names import Effect
from ..effects.plan import Plan
from ..errors import EtalonError
from ..film.parts import WORLD, EmitterLight
from ..scene.lights import Light
from ..scene.mesh import Mesh

MOST = 64
"""So many emitters can be told apart: each has an image of its own on both sides."""


@dataclass(frozen=True)
class EmitterNames:
    """The `names` of the emitters, and which of them each light, object and the world is.

    The lights (l,), the objects (o,) and the world have the index of their name, -1 for none.
    Lamps and objects of one name, such as instances, are one emitter.
    """

    names: tuple[EmitterLight, ...]
    of_lights: np.ndarray
    of_objects: np.ndarray
    world: int


def name_emitters(
    lights: Sequence[Light], mesh: Mesh, emits: np.ndarray, sampled: Sequence[np.ndarray], plan: Plan
) -> EmitterNames:
    """Name the emitters of a kernel: its light objects, the world, and emissive objects.

    `emits` (t,) bool tells which faces emit. `sampled` are the faces of each of its samplers; each sampler is of one
    emitter. Raises EtalonError where there are more than MOST.
    """
    has_world = plan.needs(Effect.CONSTANT_WORLD) or plan.needs(Effect.ENVIRONMENT_WORLD)
    objects = [mesh.objects[k].name for k in np.unique(mesh.object_index[emits])]
    wanted = [light.name for light in lights] + [""] * has_world + objects
    names = tuple(dict.fromkeys(wanted))
    if len(names) > MOST:
        raise EtalonError(
            f"{len(names)} lamps and emitting objects cannot be told apart, {MOST} can; leave --lights out (probe: --no-lights)"
        )
    place = {name: k for k, name in enumerate(names)}
    of_lights = [place[light.name] for light in lights]
    if plan.needs(Effect.ENVIRONMENT_TABLE):
        of_lights.append(place[""])
    of_lights += [place[mesh.objects[mesh.object_index[faces[0]]].name] for faces in sampled]
    return EmitterNames(
        tuple(EmitterLight(name) if name else WORLD for name in names),
        np.array(of_lights, np.intp),
        np.array([place.get(one.name, -1) for one in mesh.objects] or [-1], np.intp),
        place.get("", -1),
    )
