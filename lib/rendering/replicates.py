# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference alone: replicates of one scene gathered on a film."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..errors import Cancelled
from ..film.film import Film
from ..film.parts import Part
from ..light_tracing.render import LightTracingRenderer
from ..metropolis.render import MetropolisRenderer
from ..photon_mapping.render import PhotonMappingRenderer
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import COUNTED
from ..scene.scene import Scene
from ..settings.reference import LIGHT_TRACING, METROPOLIS, PHOTON_MAPPING, STRATEGIES, Options, RenderOptions
from ..wavefront.render import ReferenceRenderer

Estimator = ReferenceRenderer | LightTracingRenderer | PhotonMappingRenderer | MetropolisRenderer


def render_film(
    scene: Scene,
    options: RenderOptions,
    progress: Progress = NO_PROGRESS,
) -> Film:
    """Render `options.replicates` independent replicates on this machine.

    Cancelling keeps those that are done, which may be none.
    """
    film = Film.empty(scene.camera.height, scene.camera.width, options.samples)
    renderer = make_renderer(scene, options)
    for k in range(options.replicates):
        part = progress.within(k / options.replicates, (k + 1) / options.replicates)
        try:
            film.add(renderer.render(COUNTED.number(k), options.samples, part))
        except Cancelled:
            break
    if isinstance(renderer, PhotonMappingRenderer) and film.moments.n:
        film.remarks = (str(renderer.bias),)
    return film


def make_renderer(scene: Scene, options: Options, passes: Sequence[Part] = ()) -> Estimator:
    """The estimator that the strategy names; only path tracing renders the `passes`."""
    others = {
        LIGHT_TRACING: LightTracingRenderer,
        PHOTON_MAPPING: PhotonMappingRenderer,
        METROPOLIS: MetropolisRenderer,
    }
    if options.strategy in others:
        return others[options.strategy](scene, replace(options, strategy=STRATEGIES[0]).part(Options))
    return ReferenceRenderer(scene, options.part(Options), passes=passes)
