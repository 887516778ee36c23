# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference renderer: replicates of an image, tile by tile over a pool of threads."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from copy import copy
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from ..effects.names import Effect
from ..effects.plan import Plan, make_plan
from ..film.light_passes import LightPass
from ..film.parts import BounceLimit, EmitterLight, Part
from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import NO_PROGRESS, Progress
from ..sampling.sobol import RandomSampler, RandomTile, SobolSampler, SobolTile
from ..scene.camera import smaller_camera
from ..scene.scene import Scene
from ..settings.reference import Options
from ..surfaces.models import with_other_model
from .kernel import Kernel
from .moments import render_moments
from .part_sums import BounceSums, EmitterSums
from .pass_sums import PassSums
from .sums import PixelSums, StageClock
from .trace import Tracer
from .tuning import give_back_memory

# Below this many paths the interpreter's share of a tile outweighs what a second thread saves: each bounce costs a few milliseconds for
# each material, however few paths meet it, and threads take turns at that.
SMALLEST_TILE = 32768
# Where each thread can have so many paths at once, it has no smaller tiles: 15 materials in tiles of 32,768 paths need half as much
# processor time again.
AMPLE_TILE = 65536


@dataclass(frozen=True)
class Tile:
    """Numbers `first` to `last` in the list of pixels, samples `start` to `stop` of each."""

    first: int
    last: int
    start: int
    stop: int


def tiles(pixels: int, samples: int, paths: int) -> Iterator[Tile]:
    """Cover all samples of all pixels with tiles of at most `paths` paths."""
    depth = min(samples, paths)
    wide = max(paths // depth, 1)
    for first in range(0, pixels, wide):
        for start in range(0, samples, depth):
            yield Tile(first, min(first + wide, pixels), start, min(start + depth, samples))


def interleave(index: np.ndarray, width: int, parts: int) -> np.ndarray:
    """Pixels in another order, so that each of `parts` equal parts has every `parts`-th of their strips.

    Strips have `width` pixels. Parts of one image then cost about as much as each other, whatever it shows where.
    """
    strip = np.arange(index.size) // width % parts
    return index[np.argsort(strip.astype(np.uint16), kind="stable")]


_Done = tuple[Tile, PixelSums, StageClock, int]


class ReferenceRenderer:
    """Renders a scene by the reference model.

    One object renders any number of replicates; each has a scrambling of its own.
    `passes` are the light passes and other parts that its images come with; without any, nothing is done for them.
    """

    name = "reference"

    def __init__(
        self,
        scene: Scene,
        options: Options = Options(),  # noqa: B008
        plan: Plan | None = None,
        like: Kernel | None = None,
        passes: Sequence[Part] = (),
    ) -> None:
        scene = with_other_model(scene, options)
        self.scene, self.options, self.passes = scene, options, tuple(passes)
        self.plan = make_plan(scene) if plan is None else plan
        self.kernel = Kernel(scene, self.plan, options, like, _asks_emitters(passes))

    def under(self, options: Options) -> ReferenceRenderer:
        """The same scene under other options; the acceleration structure is shared."""
        return ReferenceRenderer(self.scene, options, self.plan, self.kernel, self.passes)

    def at_size(self, width: int, height: int) -> ReferenceRenderer:
        """The same scene and view, on a raster of fewer pixels.

        `width` and `height` divide its own.
        """
        scene = replace(self.scene, camera=smaller_camera(self.scene.camera, width, height))
        return ReferenceRenderer(scene, self.options, self.plan, self.kernel, self.passes)

    def with_passes(self, passes: Sequence[Part]) -> ReferenceRenderer:
        """The same, whose images come with light passes and other parts."""
        if _asks_emitters(passes) != self.kernel.apart:
            return ReferenceRenderer(self.scene, self.options, self.plan, self.kernel, passes)
        more = copy(self)
        more.passes = tuple(passes)
        return more

    @property
    def settings(self) -> dict[str, object]:
        """What a report says about this side."""
        return {
            **vars(self.options),
            "departures": sorted(self.options.departures),
            "max_bounces": self.scene.transport.max_bounces,
        }

    def render(
        self,
        replicate: int,
        samples: int,
        progress: Progress = NO_PROGRESS,
        windows: Windows | None = None,
    ) -> Rendering:
        """One independent replicate of `samples` samples per pixel.

        With `windows`, only their pixels are rendered. Raises Cancelled when asked to stop.
        """
        if not self.plan.needs(Effect.MOTION_BLUR) or self.scene.motion is None:
            return self._render_still(replicate, samples, progress, windows)

        def render(scene: Scene, seed: int, count: int, part: Progress) -> Rendering:
            options = replace(self.options, seed=seed)
            still = ReferenceRenderer(scene, options, like=self.kernel, passes=self.passes)
            return still.render(replicate, count, part, windows)

        return render_moments(
            self.scene, self.options.seed, replicate, samples, progress, render, self.options.departures
        )

    def _render_still(self, replicate: int, samples: int, progress: Progress, windows: Windows | None) -> Rendering:
        """A replicate of a scene in which nothing moves."""
        begin = perf_counter()
        camera = self.scene.camera
        shape = (camera.height, camera.width)
        index = np.arange(shape[0] * shape[1], dtype=np.int32) if windows is None else np.flatnonzero(windows.mask)
        make = SobolSampler if self.options.sampler == "sobol" else RandomSampler
        sampler = make(self.options.seed, replicate, samples)
        radiance, nonfinite = np.zeros((*shape, 3)), np.zeros(shape, np.int32)
        unknown = np.zeros(shape, np.int32) if self.kernel.has_unknown else None
        passes = {name: np.zeros((*shape, 3)) for name in self.passes}
        total, bad = radiance.reshape(-1, 3), nonfinite.reshape(-1)
        stages: dict[str, float] = {}
        rays = 0
        work = list(tiles(index.size, samples, self._tile_paths(index.size * samples)))
        if 1 < len(work) < 4 * self.options.threads:  # too few for threads to wait for none
            index = interleave(index, shape[1], len(work))

        def run(tile: Tile) -> _Done:
            return tile, *self._run(index[tile.first : tile.last], tile, sampler)

        for tile, sums, clock, traced in self._in_threads(run, work, progress):
            part = index[tile.first : tile.last]
            total[part] += sums.radiance.T
            bad[part] += sums.nonfinite
            for name, image in passes.items():
                image.reshape(-1, 3)[part] += sums.part_radiance(name).T
            if unknown is not None:
                unknown.reshape(-1)[part] += sums.unknown
            rays += traced
            for stage, seconds in clock.seconds.items():
                stages[stage] = stages.get(stage, 0.0) + seconds
        if windows is None:
            give_back_memory()
        for image in (radiance, *passes.values()):
            image /= samples
        seconds = perf_counter() - begin
        return Rendering(radiance, nonfinite, seconds, stages, index.size * samples, rays, windows, unknown, passes)

    def _in_threads(self, run: Callable[[Tile], _Done], work: Sequence[Tile], progress: Progress) -> Iterator[_Done]:
        """The result of `run` for each tile, as soon as it is ready.

        Raises Cancelled when asked to stop.
        """
        with ThreadPoolExecutor(self.options.threads) as pool:
            pending: set[Future] = set()
            queue, done = iter(work), 0
            try:
                while True:
                    for tile in queue:
                        pending.add(pool.submit(run, tile))
                        if len(pending) >= 2 * self.options.threads:
                            break
                    if not pending:
                        break
                    finished, pending = wait(pending, return_when=FIRST_COMPLETED)
                    for future in finished:
                        yield future.result()
                        done += 1
                    progress.report(done / len(work))
                    progress.check()
            finally:
                for future in pending:
                    future.cancel()

    def tracer(self, uniforms: SobolTile | RandomTile, sums: PixelSums, clock: StageClock) -> Tracer:
        """What traces one tile."""
        return Tracer(self.kernel, uniforms, sums, clock)

    def _tile_paths(self, paths: int) -> int:
        """Paths in a tile: as in the options, or fewer.

        Every thread has several tiles, or one where these would be small.
        """
        several, one = paths // (4 * self.options.threads), -(-paths // self.options.threads)
        return min(self.options.tile_paths, max(several, min(one, AMPLE_TILE), SMALLEST_TILE))

    def _run(
        self, index: np.ndarray, tile: Tile, sampler: SobolSampler | RandomSampler
    ) -> tuple[PixelSums, StageClock, int]:
        row, column = np.divmod(index, self.scene.camera.width)
        depth = tile.stop - tile.start
        sums, clock = self._sums(index.size, tile), StageClock()
        tracer = self.tracer(sampler.tile(index), sums, clock)
        pixel = np.repeat(np.arange(index.size), depth)
        sample = np.tile(np.arange(tile.start, tile.stop), index.size)
        with np.errstate(invalid="ignore"):  # what is not finite is counted by the sums; a warning would say less
            tracer.trace(column, row, pixel, sample)
        return sums, clock, tracer.rays

    def _sums(self, pixels: int, tile: Tile) -> PixelSums:
        """What a tile adds up: the image, and the parts that are asked for."""
        passes = bounces = emitters = None
        if any(isinstance(part, LightPass) for part in self.passes):
            passes = PassSums(self.kernel.families, pixels, tile.start, tile.stop - tile.start)
        limits = [part.bounces for part in self.passes if isinstance(part, BounceLimit)]
        if limits:
            bounces = BounceSums(max(limits), pixels)
        if self.kernel.apart:
            emitters = EmitterSums(self.kernel.emitters.names, pixels)
        return PixelSums(pixels, passes, bounces, emitters)


def _asks_emitters(parts: Sequence[Part]) -> bool:
    return any(isinstance(part, EmitterLight) for part in parts)
