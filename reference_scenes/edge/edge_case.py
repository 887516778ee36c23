# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene at the edge is, and what several of them share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import mathutils
import numpy as np

from .. import building

SIDE = 32


@dataclass(frozen=True)
class EdgeCase:
    """A scene whose image is of one radiance (RGB alike, W m^-2 sr^-1), 32 x 32 pixels.

    `build` makes it the open scene. `tolerance` is relative, of the mean of each quarter of the image, once `samples` per pixel
    have been taken; where `radiance` is 0 it is absolute. `origin` says where the number comes from.
    """

    name: str
    build: Callable[[], None]
    radiance: float
    tolerance: float
    samples: int
    origin: str


def start(name: str, max_bounces: int = 0) -> bpy.types.Scene:
    """An empty scene of the size that all cases have."""
    return building.start(name, SIDE, SIDE, max_bounces)


def look(
    at: building.Point, direction: building.Point, distance: float, width: float, clip_end: float = 1e6
) -> bpy.types.Object:
    """Add an orthographic camera that sees a square of `width` metres about `at`.

    It looks from `direction`.
    """
    back = np.array(direction) / np.linalg.norm(direction)
    camera = building.camera(tuple(np.array(at) + distance * back), at, ortho_scale=width)
    camera.data.clip_start, camera.data.clip_end = 1e-6 * distance, clip_end
    return camera


def sun(direction: building.Point, irradiance: float) -> None:
    """A sun of no width, shining along `direction`."""
    data = bpy.data.lights.new("Sun", "SUN")
    data.angle, data.energy = 0.0, irradiance
    item = bpy.data.objects.new("Sun", data)
    item.rotation_euler = mathutils.Vector(direction).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(item)


def light(name: str, kind: str, location: building.Point, **properties: float | str | bool) -> bpy.types.Light:
    """A light that shines straight down from `location`."""
    data = bpy.data.lights.new(name, kind)
    for key, value in properties.items():
        setattr(data, key, value)
    item = bpy.data.objects.new(name, data)
    item.location = location
    bpy.context.scene.collection.objects.link(item)
    return data
