# SPDX-License-Identifier: GPL-3.0-or-later
"""Replicates of an image by light tracing.

Tiles of paths are traced by a pool of threads, and added up in order.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from itertools import islice
from time import perf_counter

import numpy as np

from ..effects.plan import Plan
from ..film.rendering import Rendering
from ..lights.light import bounding_ball
from ..progress import NO_PROGRESS, Progress
from ..sampling.sobol import RandomSampler, SobolSampler
from ..scene.scene import Scene
from ..settings.reference import Options
from ..wavefront.kernel import Kernel
from ..wavefront.render import Tile, tiles
from ..wavefront.sums import PixelSums
from .emitters import Emitters, gather_emitters
from .refuse import refuse_unsupported
from .remainder import RemainderRenderer
from .select import Everything, Selection
from .splats import Splats
from .trace import LightTracer

# Below this many paths the interpreter's share of a tile outweighs what a second thread saves.
TILE_PATHS = 32768


class LightTracingRenderer:
    """Renders the scene by light tracing.

    Path tracing renders what no light path reaches (remainder.py).

    Raises Refused for what it does not simulate.
    """

    name = "light tracing"

    def __init__(self, scene: Scene, options: Options, plan: Plan | None = None) -> None:
        self.scene = scene
        self._remainder = RemainderRenderer(scene, options, plan)
        self._kernel = self._remainder.kernel
        refuse_unsupported(self._kernel)
        self._emitters = gather_emitters(self._kernel, bounding_ball(scene.mesh.vertices), with_sky=True)

    def render(self, replicate: int, samples: int, progress: Progress = NO_PROGRESS) -> Rendering:
        """Render one independent replicate; raises Cancelled.

        It has `samples` light paths for every pixel, and as many camera rays.
        """
        begin = perf_counter()
        seen = self._remainder.render(replicate, samples, progress.within(0.0, 0.5))
        camera = self.scene.camera
        paths = camera.width * camera.height * samples
        sums, rays = PixelSums(camera.width * camera.height), 0
        traced = trace_light(self._kernel, self._emitters, Everything(), replicate, paths, progress.within(0.5, 1.0))
        for splats, met in traced:
            sums.add(splats.pixel, splats.value)
            rays += met
        shape = (camera.height, camera.width)
        return replace(
            seen,
            radiance=seen.radiance + sums.radiance.T.reshape(*shape, 3) / paths,
            nonfinite=seen.nonfinite + sums.nonfinite.reshape(shape).astype(np.int32),
            seconds=perf_counter() - begin,
            rays=seen.rays + rays,
        )


def group_depth(paths: int) -> int:
    """The paths of a group, a power of two: of `paths`, about as many as there are groups.

    A point set costs more, the larger it is.
    """
    return 1 << min(paths.bit_length() // 2, 12)


def trace_light(
    kernel: Kernel,
    emitters: Emitters | None,
    selection: Selection,
    replicate: int,
    paths: int,
    progress: Progress = NO_PROGRESS,
    tile_paths: int = TILE_PATHS,
    depth: int | None = None,
) -> Iterator[tuple[Splats, int]]:
    """Return the contributions of `paths` paths from the lights, tile by tile.

    Each tile comes with the number of rays that were traced in it. Groups of `depth` paths share a point set; by default
    as `group_depth` says. Groups are uncorrelated.

    Their order does not depend on the number of threads. Raises Cancelled.
    """
    options = kernel.options
    pixels = kernel.scene.camera.width * kernel.scene.camera.height
    if emitters is None or not any(material.scatters for material in kernel.materials):
        return
    depth = group_depth(paths) if depth is None else depth
    groups = -(-paths // depth)
    make = SobolSampler if options.sampler == "sobol" else RandomSampler
    sampler = make(options.seed, replicate, depth)
    work = list(tiles(groups, depth, tile_paths))

    def run(tile: Tile) -> tuple[Splats, int]:
        # Numbers after the pixels': generators that are seeded by the first of them are then not those of camera paths.
        uniforms = sampler.tile(pixels + np.arange(tile.first, tile.last))
        tracer = LightTracer(kernel, emitters, uniforms, selection)
        group = np.repeat(np.arange(tile.last - tile.first), tile.stop - tile.start)
        sample = np.tile(np.arange(tile.start, tile.stop), tile.last - tile.first)
        kept = (tile.first + group) * depth + sample < paths  # the last group may be larger than what is left
        with np.errstate(invalid="ignore"):  # what is not finite is counted by the sums
            splats = tracer.trace(group[kept], sample[kept])
        return replace(splats, group=splats.group + tile.first), tracer.rays

    with ThreadPoolExecutor(options.threads) as pool:
        pending: deque[Future] = deque()
        queue = iter(work)
        try:
            for done in range(len(work)):
                pending.extend(pool.submit(run, tile) for tile in islice(queue, 2 * options.threads - len(pending)))
                yield pending.popleft().result()
                progress.report((done + 1) / len(work))
                progress.check()
        finally:
            for future in pending:
                future.cancel()
