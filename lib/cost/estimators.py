# SPDX-License-Identifier: GPL-3.0-or-later
"""Light tracing, photon mapping and Metropolis as ways to render.

They stand beside path tracing and Cycles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..errors import EtalonError
from ..film.parts import Part
from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import NO_PROGRESS, Progress
from ..rendering.replicates import make_renderer
from ..scene.camera import smaller_camera
from ..scene.scene import Scene
from ..settings.reference import LIGHT_TRACING, METROPOLIS, PHOTON_MAPPING, RenderOptions
from .ways import Bias, Way

_ESTIMATORS = (
    (LIGHT_TRACING, "light tracing", Bias.NONE),
    (PHOTON_MAPPING, "photon mapping", Bias.UNKNOWN),
    (METROPOLIS, "Metropolis", Bias.NONE),
)


class Estimator:
    """An estimator of the image other than path tracing.

    It is one side of a comparison or a way of a measurement. Raises Refused where it does not simulate something of the
    scene.
    """

    def __init__(self, scene: Scene, options: RenderOptions) -> None:
        self.name = options.strategy
        self.settings: dict[str, object] = {**vars(options), "max_bounces": scene.transport.max_bounces}
        self._scene, self._options = scene, options
        self.renderer = make_renderer(scene, options)

    def render(
        self, replicate: int, samples: int, progress: Progress = NO_PROGRESS, windows: Windows | None = None
    ) -> Rendering:
        """One replicate, always of the whole image; of `windows` the others are counted as well."""
        return replace(self.renderer.render(replicate, samples, progress), windows=windows)

    def at_size(self, width: int, height: int) -> Estimator:
        """The same view on a smaller raster."""
        camera = smaller_camera(self._scene.camera, width, height)
        return Estimator(replace(self._scene, camera=camera), self._options)

    def with_passes(self, passes: Sequence[Part]) -> Estimator:
        """The estimator itself; raises EtalonError where light passes are asked for."""
        if passes:
            raise EtalonError(f"{self.name} has no light passes; leave out --passes, or use a strategy of path tracing")
        return self


def estimator_ways(scene: Scene, seed: int, threads: int, opening: float) -> list[Way]:
    """The other estimators of the image.

    Only measuring tells how far photon mapping's bias still falls.
    """
    ways = []
    for strategy, label, bias in _ESTIMATORS:
        options = RenderOptions(seed=seed, threads=threads, strategy=strategy)

        def make(options: RenderOptions = options) -> Estimator:
            return Estimator(scene, options)

        ways.append(Way(strategy, label, "estimators", make, bias, None, opening))
    return ways
