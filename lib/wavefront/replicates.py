# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference alone: replicates of one scene gathered on a film."""

from __future__ import annotations

from ..errors import Cancelled
from ..film.film import Film
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import COUNTED
from ..scene.scene import Scene
from ..settings.reference import Options, RenderOptions
from .render import ReferenceRenderer


def render_film(
    scene: Scene,
    options: RenderOptions,
    progress: Progress = NO_PROGRESS,
) -> Film:
    """Render `options.replicates` independent replicates; cancelling keeps those that are done, which may be none."""
    film = Film.empty(scene.camera.height, scene.camera.width, options.samples)
    renderer = ReferenceRenderer(scene, options.part(Options))
    for k in range(options.replicates):
        part = progress.within(k / options.replicates, (k + 1) / options.replicates)
        try:
            film.add(renderer.render(COUNTED.number(k), options.samples, part))
        except Cancelled:
            break
    return film
