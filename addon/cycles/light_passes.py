# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' light passes: switching them on in a view layer, and reading them.

They are read from the multilayer file that Blender writes. Cycles divides the light of each family of lobes by the
colour of its surfaces (kernel/film/read.h), pixel by pixel, and writes that colour as a pass of its own. Their product
is the light again, as in Blender's manual: direct times colour, and indirect times colour. Where a pixel's colour is
black there is nothing to multiply by: the product is 0, and light that the lobes did send is in no pass. A difference
to the reference's pass shows it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import bpy
import numpy as np

from ...lib.errors import EtalonError
from ...lib.film.light_passes import Family, LightPass
from .neutral import Changes

# The view layer's property, and the name in the file: until Blender 4.5, and from 5.0 on.
_PROPERTIES = {
    LightPass.DIFFUSE_DIRECT: ("use_pass_diffuse_direct", "DiffDir", "Diffuse Direct"),
    LightPass.DIFFUSE_INDIRECT: ("use_pass_diffuse_indirect", "DiffInd", "Diffuse Indirect"),
    LightPass.GLOSSY_DIRECT: ("use_pass_glossy_direct", "GlossDir", "Glossy Direct"),
    LightPass.GLOSSY_INDIRECT: ("use_pass_glossy_indirect", "GlossInd", "Glossy Indirect"),
    LightPass.TRANSMISSION_DIRECT: ("use_pass_transmission_direct", "TransDir", "Transmission Direct"),
    LightPass.TRANSMISSION_INDIRECT: ("use_pass_transmission_indirect", "TransInd", "Transmission Indirect"),
    LightPass.VOLUME_DIRECT: ("cycles.use_pass_volume_direct", "VolumeDir", "Volume Direct"),
    LightPass.VOLUME_INDIRECT: ("cycles.use_pass_volume_indirect", "VolumeInd", "Volume Indirect"),
    LightPass.EMISSION: ("use_pass_emit", "Emit", "Emission"),
    LightPass.ENVIRONMENT: ("use_pass_environment", "Env", "Environment"),
}
_COLORS = {
    Family.DIFFUSE: ("use_pass_diffuse_color", "DiffCol", "Diffuse Color"),
    Family.GLOSSY: ("use_pass_glossy_color", "GlossCol", "Glossy Color"),
    Family.TRANSMISSION: ("use_pass_transmission_color", "TransCol", "Transmission Color"),
}
# In this order, as in neutral.py.
_MULTILAYER = {
    "media_type": "MULTI_LAYER_IMAGE",
    "file_format": "OPEN_EXR_MULTILAYER",
    "color_depth": "32",
    "exr_codec": "NONE",
}


def ask_for_passes(changes: Changes, scene: bpy.types.Scene, layer: str, passes: Sequence[LightPass]) -> None:
    """Have the view layer called `layer` write `passes` into a file of several layers.

    Passes of its own stay on: Blender cuts a compositor node off from a pass that is switched off, even if it returns.
    """
    wanted = {*passes, *filter(None, map(_family, passes))}
    for one, (name, *_) in (_PROPERTIES | _COLORS).items():
        if one in wanted:
            *inner, own = name.split(".")
            changes.set(reduce(getattr, inner, scene.view_layers[layer]), own, True)
    settings = scene.render.image_settings
    changes.remember(settings, reversed(_MULTILAYER))
    for name, value in _MULTILAYER.items():
        changes.set(settings, name, value)


def combined(channels: dict[str, np.ndarray]) -> np.ndarray:
    """The image itself, (height, width, 3) float32, of the channels of a multilayer file."""
    return read_layer(channels, "Combined")


def read_pass(channels: dict[str, np.ndarray], name: LightPass) -> np.ndarray:
    """The light of one pass, (height, width, 3), with its colour multiplied in again.

    `channels` are those of a multilayer file.
    """
    light = read_layer(channels, *_PROPERTIES[name][1:]).astype(float)
    family = _family(name)
    return light if family is None else light * read_layer(channels, *_COLORS[family][1:])


def _family(name: LightPass) -> Family | None:
    """The family whose colour Cycles divides a pass by; volumes have none."""
    return next((family for family in _COLORS if name.startswith(family)), None)


def read_layer(channels: dict[str, np.ndarray], *names: str) -> np.ndarray:
    """The colour of the layer that is called one of `names`, (height, width, 3)."""
    for name in names:
        found = [value for color in "RGB" for key, value in channels.items() if key.endswith(f".{name}.{color}")]
        if len(found) == 3:
            return np.stack(found, axis=2)
    raise EtalonError(f"Cycles wrote no pass '{names[-1]}'; compare without --passes and --lights")
