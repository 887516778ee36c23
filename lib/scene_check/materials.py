# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of colours and textures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..plural import plural
from ..scene.expressions import ColorRamp, Constant, EnvironmentTexture, Expression, ImageTexture, NormalMap
from ..scene.findings import Finding, list_names
from ..scene.materials import Material
from ..scene.scene import Scene
from ..textures.fold import fold, walk

# Sockets of closures that are colours: reflectances, tints and emission.
_COLORS = ("color", "base", "edge", "tint", "reflection", "transmission")


def find_color_normal_maps(scene: Scene) -> Finding | None:
    """Images that feed a Normal Map and are decoded as sRGB colours."""
    found: dict[str, list[str]] = {}
    for material in scene.materials:
        for socket in _sockets(material):
            for node in walk(socket):
                if isinstance(node, NormalMap):
                    for image in _srgb_images(scene, node.color):
                        found.setdefault(image, []).append(material.name)
    if not found:
        return None
    images, users = list(found), list(dict.fromkeys(name for names in found.values() for name in names))
    return Finding(
        "normal map read as a colour",
        f"{plural(len(images), 'image')} with the colour space sRGB {'feeds' if len(images) == 1 else 'feed'} a "
        f"Normal Map: {list_names(images)} (material {list_names(users)}).",
        "Both renderers tilt all normals alike, so the comparison holds, but the surface is not the one that was baked.",
        "Set the image's colour space to Non-Color.",
    )


def find_negative_colors(scene: Scene) -> Finding | None:
    """Find materials with a colour that is below zero.

    It may be a constant, a stop of a ramp, or a texel of an image.
    """
    names = [
        material.name
        for material in scene.materials
        if any(_is_negative(scene, socket) for socket in _sockets(material, _COLORS))
    ]
    if _is_negative(scene, scene.world.radiance):
        names.append("the world")
    if not names:
        return None
    return Finding(
        "negative colours",
        f"A colour is below zero in {list_names(names)}.",
        "Such surfaces take light away; where a renderer cuts it off at zero the two can differ.",
        "Raise the colour to at least zero.",
    )


def _sockets(material: Material, among: tuple[str, ...] = ()) -> Iterator[Expression]:
    for lobe in material.lobes:
        for name, value in vars(lobe.closure).items():
            if isinstance(value, Expression) and (not among or name in among):
                yield value


def _srgb_images(scene: Scene, color: Expression) -> list[str]:
    """The images decoded as sRGB that a colour is made of."""
    nodes = (node for node in walk(color) if isinstance(node, ImageTexture))
    return [scene.images[node.image].name for node in nodes if scene.images[node.image].encoding == "SRGB"]


def _is_negative(scene: Scene, socket: Expression) -> bool:
    socket = fold(socket)
    if isinstance(socket, Constant):
        return bool(np.min(socket.value) < 0.0)
    if isinstance(socket, ColorRamp):
        return any(min(color[:3]) < 0.0 for color in socket.colors)
    if isinstance(socket, ImageTexture | EnvironmentTexture):
        return bool(scene.images[socket.image].pixels[..., :3].min() < 0.0)
    return False
