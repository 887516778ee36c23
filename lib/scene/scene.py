# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole scene."""

from __future__ import annotations

from dataclasses import dataclass

from ..blender_versions import Release
from .camera import Camera
from .findings import Finding
from .images import Image
from .lights import Light
from .materials import Material
from .mesh import Mesh
from .motion import Motion
from .world import World


@dataclass(frozen=True)
class Transport:
    """How far light is followed, counted as Cycles counts.

    With `max_bounces` n a path has up to n + 1 scatterings, and emission after the last is included. `transparent_max_bounces`
    t: a ray passes max(t, 1) transparent surfaces; the next contributes its emission only; shadow rays pass t.
    With `volume_bounces` v a path has up to v + 1 scatterings in volumes, and the last of them is its last.
    """

    max_bounces: int = 12
    transparent_max_bounces: int = 64
    volume_bounces: int = 1024


@dataclass(frozen=True)
class Scene:
    """Everything the reference needs.

    It is written by the exporter, checked by `checks.validate`, and never changed.
    `blender` is the release that exported it, by which departures are chosen; None for a scene that no Blender made.
    `findings` are what only the exporter could see; scene_check has the others.
    `motion` is what moves while the shutter is open; None where all stands still. The rest is the scene in the middle of that time.
    """

    name: str
    mesh: Mesh
    materials: tuple[Material, ...]
    lights: tuple[Light, ...]
    world: World
    camera: Camera
    transport: Transport = Transport()
    images: tuple[Image, ...] = ()
    blender: Release | None = None
    findings: tuple[Finding, ...] = ()
    motion: Motion | None = None
