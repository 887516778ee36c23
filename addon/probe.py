# SPDX-License-Identifier: GPL-3.0-or-later
"""A few pixels of the open scene on both sides, taken apart."""

from __future__ import annotations

import bpy

from ..lib.comparison.parts import asked_parts
from ..lib.effects.light_sources import has_one_light
from ..lib.errors import EtalonError
from ..lib.lights.units import light_units
from ..lib.probe.measure import probe
from ..lib.probe.result import ProbeResult
from ..lib.progress import Progress
from ..lib.settings.comparison import Settings
from ..lib.settings.probe import ProbeOptions
from ..lib.settings.reference import Options
from ..lib.wavefront.render import ReferenceRenderer
from .cycles.renderer import CyclesRenderer, neutral
from .job import export

# Bounces that are told apart where the user does not say.
BOUNCES = 4


def probe_here(name: str, scene: bpy.types.Scene, options: ProbeOptions, progress: Progress) -> ProbeResult:
    """Read pixels of `scene` in this process, and list its lights.

    `name` is the scene's name. The scene's own settings are restored afterwards. Raises Refused or EtalonError.
    """
    progress.begin("reading the scene")
    exported = export(scene)
    column, row = options.pixel
    camera = exported.camera
    box = column, row, column + options.block - 1, row + options.block - 1
    if box[2] >= camera.width or box[3] >= camera.height:
        raise EtalonError(
            f"--pixel {column} {row}: the image has {camera.width} x {camera.height} pixels, "
            f"and {options.block} x {options.block} are to be read; give a pixel inside"
        )
    bounces = options.bounces or (0, min(BOUNCES, exported.transport.max_bounces))
    reference = ReferenceRenderer(exported, options.part(Options))
    parts = asked_parts(reference, Settings(passes="all", bounces=bounces, lights=options.lights))
    state = {"threads": options.threads, "one_light": has_one_light(exported)}
    with neutral(scene, **state):
        cycles = CyclesRenderer(scene, seed=options.seed, **state)
        progress.begin("rendering")
        found = probe((reference, cycles), (camera.height, camera.width), box, parts, options.time, progress)
    return ProbeResult(name, found, tuple(light_units(light) for light in exported.lights))
