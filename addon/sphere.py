# SPDX-License-Identifier: GPL-3.0-or-later
"""A sphere that Cycles renders, as observations of a fit."""

from __future__ import annotations

import bpy

from ..lib.effects.light_sources import has_one_light
from ..lib.film.moments import Moments
from ..lib.fit.observations import Observations
from ..lib.fit.sphere import observe_image, require_sphere
from ..lib.progress import Progress
from ..lib.settings.fit import FitSettings
from ..lib.textures.fold import fold_scene
from .cycles.renderer import CyclesRenderer, neutral
from .host.quiet import quiet
from .job import export


def observe_sphere(scene: bpy.types.Scene, settings: FitSettings, progress: Progress, source: str) -> Observations:
    """Render the sphere of `scene` with Cycles in independent replicates, and observe it.

    The scene's own settings are restored afterwards. Raises EtalonError where the scene is not one sphere under one
    sun, or Refused.
    """
    progress.begin("reading the scene")
    exported = fold_scene(export(scene))
    sun, _ = require_sphere(exported, settings.object)
    camera = exported.camera
    moments = Moments.empty((camera.height, camera.width))
    state = {"threads": settings.threads, "one_light": has_one_light(exported)}
    with neutral(scene, **state), quiet():
        cycles = CyclesRenderer(scene, seed=settings.seed, **state)
        progress.begin("rendering")
        for number in range(settings.replicates):
            progress.check()
            moments.add(cycles.render(number, settings.samples).radiance.mean(axis=2))
            progress.report((number + 1) / settings.replicates)
    return observe_image(exported, sun, moments, settings.noise, source)
