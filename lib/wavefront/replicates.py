# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference alone: replicates of one scene gathered on a film."""

from __future__ import annotations

from collections.abc import Callable

from ..errors import Cancelled
from ..film.film import Film
from ..scene.scene import Scene
from ..settings.reference import Options, RenderOptions
from .render import ReferenceRenderer


def render_film(
    scene: Scene,
    options: RenderOptions,
    progress: Callable[[float], None] = lambda fraction: None,
    cancelled: Callable[[], bool] = lambda: False,
) -> Film:
    """Render `options.replicates` independent replicates; cancelling keeps those that are done, which may be none."""
    film = Film.empty(scene.camera.height, scene.camera.width, options.samples)
    renderer = ReferenceRenderer(scene, options.part(Options))
    for replicate in range(options.replicates):

        def spent(fraction: float, done: int = replicate) -> None:
            progress((done + fraction) / options.replicates)

        try:
            film.add(renderer.render(replicate, options.samples, spent, cancelled))
        except Cancelled:
            break
    return film
