# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' light groups: one for each emitter while it is rendered, and the user's own back afterwards."""

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
    """Have each of `emitters` in a light group of its own in the view layer called `layer`; its own groups stay, but nothing is in them.

    Raises EtalonError where a linked file does not let an object be put into a group.
    """
    groups = scene.view_layers[layer].lightgroups
    own = [group.name for group in groups]
    owners = {thing.name: thing for thing in scene.objects}
    try:
        # Cycles writes a pass for every group of the layer.
        for name in own:
            groups.remove(groups[name])
        for number, emitter in enumerate(emitters):
            groups.add(name=_group(number))
            owner = scene.world if emitter == WORLD else owners.get(emitter.name) or bpy.data.objects.get(emitter.name)
            if owner is None:
                raise EtalonError(
                    f"{emitter.name}: no object has this name, so its light cannot be told apart; compare without --lights"
                )
            changes.set(owner, "lightgroup", _group(number))
            if owner.lightgroup != _group(number):
                raise EtalonError(
                    f"{emitter.name}: it is linked from another file and takes no light group; compare without --lights"
                )
        yield
    finally:
        for group in list(groups):
            groups.remove(group)
        for name in own:
            groups.add(name=name)


def read_emitter(channels: dict[str, np.ndarray], number: int) -> np.ndarray:
    """The light of emitter number `number`, (height, width, 3), of the channels of a multilayer file."""
    return read_layer(channels, f"Combined_{_group(number)}").astype(float)
