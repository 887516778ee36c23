# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' light groups: one for each emitter while it is rendered.

The user's own groups are restored afterwards.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy
import numpy as np

from ...lib.errors import EtalonError
from ...lib.film.parts import WORLD, EmitterLight
from .light_passes import read_layer
from .neutral import Changes

_PREFIX = "etalon light"


def _group(number: int) -> str:
    return f"{_PREFIX} {number}"


@contextmanager
def light_groups(
    changes: Changes, scene: bpy.types.Scene, layer: str, emitters: Sequence[EmitterLight]
) -> Iterator[None]:
    """Have each of `emitters` in a light group of its own in the view layer called `layer`.

    The layer's own groups stay, since compositor nodes may use them, but no emitter is in them. Raises EtalonError where an object does
    not let itself be put into a group.
    """
    view_layer = scene.view_layers[layer]
    groups, active = view_layer.lightgroups, view_layer.active_lightgroup_index
    own = {group.name for group in groups}
    owners = {thing.name: thing for thing in scene.objects}
    try:
        for number, emitter in enumerate(emitters):
            if _group(number) not in own:
                groups.add(name=_group(number))
            owner = scene.world if emitter == WORLD else owners.get(emitter.name) or bpy.data.objects.get(emitter.name)
            if owner is None:
                raise EtalonError(
                    f"{emitter.name}: no object has this name, so its light cannot be told apart; leave --lights out (probe: --no-lights)"
                )
            changes.set(owner, "lightgroup", _group(number))
            if owner.lightgroup != _group(number):
                raise EtalonError(
                    f"{emitter.name}: it is linked from another file and takes no light group; leave --lights out (probe: --no-lights)"
                )
        yield
    finally:
        for group in [group for group in groups if group.name not in own]:
            groups.remove(group)
        view_layer.active_lightgroup_index = active


def read_emitter(channels: dict[str, np.ndarray], number: int) -> np.ndarray:
    """The light of emitter number `number`, (height, width, 3).

    `channels` are those of a multilayer file.
    """
    return read_layer(channels, f"Combined_{_group(number)}").astype(float)
