# SPDX-License-Identifier: GPL-3.0-or-later
"""Replicates of an image by Metropolis light transport.

Groups of chains run over a pool of threads.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter

import numpy as np

from ..effects.plan import Plan
from ..errors import EtalonError, Refusal, Refused
from ..film.rendering import Rendering
from ..lights.light import luminance
from ..progress import NO_PROGRESS, Progress
from ..sampling.sobol import stream_key
from ..sampling.streams import METROPOLIS, METROPOLIS_PILOT
from ..scene.scene import Scene
from ..settings.reference import SAMPLERS, Options
from ..wavefront.render import ReferenceRenderer
from ..wavefront.sums import PixelSums, StageClock
from ..wavefront.trace import Tracer
from .chains import LARGE, ChainUniforms

# Paths of a group of chains, which is an estimator by itself; they share one thread. Chains of fewer are too short to get
# away from the few bright samples that they start at.
GROUP_PATHS = 1 << 20
# Chains of a group that run side by side: with fewer, the interpreter takes more of the time.
CHAINS = 1024
# One path in so many is an independent sample: of their mean brightness, and for the chains to start from.
SHARE = 4
# Independent samples that are traced at once.
BLOCK = 1 << 15
# Samples whose mean brightness balances independent samples and chains.
PILOT = 1 << 13


@dataclass(frozen=True)
class _Balance:
    """Weights of independent samples and of the steps of chains, by the balance heuristic (Kelemen et al. 2002).

    A path of brightness I is expected `independent` times among independent samples, and `steps` I / b times in chains, per
    unit of its density, where b is the mean brightness. `level` stands for b. Any level that does not depend on the
    samples leaves the image unbiased; with 0 the chains give the image alone.
    """

    independent: float
    steps: int
    level: float

    def over(self, brightness: np.ndarray) -> np.ndarray:
        """One over the sum of both, over `level`, (n,)."""
        return 1.0 / np.maximum(self.independent * self.level + self.steps * brightness, 1e-300)


@dataclass(frozen=True)
class _Values:
    """What paths contribute.

    It has the radiance (3, n), its luminance (n,), the pixel (n,) of the image, and which of them are not finite,
    (n,) bool.
    """

    radiance: np.ndarray
    brightness: np.ndarray
    pixel: np.ndarray
    bad: np.ndarray

    def take(self, index: np.ndarray) -> _Values:
        """Those at `index`."""
        return _Values(*(np.take(array, index, axis=-1) for array in vars(self).values()))

    def put(self, index: np.ndarray, other: _Values) -> None:
        """Write the `other` ones at `index`."""
        for old, new in zip(vars(self).values(), vars(other).values(), strict=True):
            old[..., index] = new

    def replaced(self, other: _Values, where: np.ndarray) -> _Values:
        """These, with the `other` ones where (n,) bool says so."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return _Values(*(np.where(where, new, old) for old, new in pairs))


class MetropolisRenderer:
    """Renders by Metropolis light transport (Kelemen et al. 2002).

    The chains move in the space of the random numbers of the path tracer.

    Each group of chains first traces independent samples. Their mean brightness is the normalisation b, and the
    chains start at some of them, picked by brightness. So the image is unbiased, however short the chains are (Veach
    1997, section 11.3.1). Independent samples, large steps among them, count beside the chains (`_Balance`). Replicates
    share nothing but the level of that balance, which changes their noise alone. Raises Refused for unsupported
    materials and motion, EtalonError for a sampler: the chains have random numbers of their own.
    """

    name = "Metropolis"

    def __init__(self, scene: Scene, options: Options, plan: Plan | None = None) -> None:
        if options.sampler != SAMPLERS[0]:
            raise EtalonError(f"sampler '{options.sampler}': Metropolis has a sampler of its own; leave --sampler out")
        self.scene, self.options = scene, options
        self._kernel = ReferenceRenderer(scene, options, plan).kernel
        if scene.motion is not None:
            refusal = Refusal("the scene", "motion blur by Metropolis light transport", "render with another strategy")
            raise Refused([refusal])
        unknown = [(material.name, material.unknown) for material in scene.materials if material.unknown]
        if unknown:
            remedy = "replace it, or render with another strategy"
            raise Refused([Refusal(f"material '{name}'", what, remedy) for name, what in unknown])

    def render(self, replicate: int, samples: int, progress: Progress = NO_PROGRESS) -> Rendering:
        """Render one independent replicate of `samples` paths for every pixel.

        The paths include those of the normalisation. Raises Cancelled.
        """
        begin = perf_counter()
        camera = self.scene.camera
        shape = (camera.height, camera.width)
        paths = camera.width * camera.height * samples
        groups = -(-paths // GROUP_PATHS)
        image = PixelSums(camera.width * camera.height)
        rays, level = 0, self._level

        def run(group: int) -> tuple[PixelSums, int]:
            key = int(stream_key(self.options.seed, replicate, METROPOLIS, group))
            with np.errstate(invalid="ignore"):  # what is not finite is counted
                return self._run_group(np.random.default_rng(key), -(-paths // groups), level, progress)

        with ThreadPoolExecutor(self.options.threads) as pool:
            for done, (sums, traced) in enumerate(pool.map(run, range(groups))):
                image.radiance += sums.radiance / groups
                image.nonfinite += sums.nonfinite
                rays += traced
                progress.report((done + 1) / groups)
        radiance = image.radiance.T.reshape(*shape, 3)
        nonfinite = image.nonfinite.reshape(shape).astype(np.int32)
        return Rendering(radiance, nonfinite, perf_counter() - begin, {}, paths, rays)

    @cached_property
    def _level(self) -> float:
        """The mean brightness of a few samples of their own."""
        generator = np.random.default_rng(int(stream_key(self.options.seed, 0, METROPOLIS_PILOT)))
        camera = self.scene.camera
        with np.errstate(invalid="ignore"):
            found, _ = self._trace(ChainUniforms(generator, PILOT, camera.width, camera.height), PILOT)
        return float(found.brightness.mean())

    def _run_group(
        self, generator: np.random.Generator, paths: int, level: float, progress: Progress
    ) -> tuple[PixelSums, int]:
        """The image by one group of chains, and its rays."""
        camera = self.scene.camera
        sums = PixelSums(camera.width * camera.height)
        first = max(paths // SHARE, 1)
        count = min(CHAINS, max(paths - first, 1))
        length = max((paths - first) // count, 1)
        balance = _Balance(first + LARGE * count * length, count * length, level)
        chains, now, total, rays = self._start(generator, first, count, balance, sums, progress)
        if total == 0.0:
            return sums, rays
        mean = total / first
        for _ in range(length):
            chains.propose()
            new, traced = self._trace(chains, count)
            rays += traced
            chance = np.minimum(new.brightness / np.maximum(now.brightness, 1e-300), 1.0)
            independent = np.where(chains.large, level, 0.0)
            for values, share in ((new, independent + chance * mean), (now, (1.0 - chance) * mean)):
                sums.add(values.pixel, values.radiance * (share * balance.over(values.brightness)))
            sums.nonfinite += np.bincount(new.pixel[new.bad], minlength=sums.nonfinite.size)
            accepted = generator.random(count) < chance
            chains.accept(accepted)
            now = now.replaced(new, accepted)
            progress.check()
        sums.radiance *= sums.nonfinite.size
        return sums, rays

    def _start(
        self,
        generator: np.random.Generator,
        first: int,
        count: int,
        balance: _Balance,
        sums: PixelSums,
        progress: Progress,
    ) -> tuple[ChainUniforms, _Values, float, int]:
        """Trace `first` independent samples into `sums`, and start `count` chains at some of them.

        Each chain starts at a sample that is picked in proportion to its brightness among all of them, block by block.
        Returned are the chains, what they contribute, the sum of the brightness of all samples, and the rays.
        """
        camera = self.scene.camera
        chains = ChainUniforms(generator, count, camera.width, camera.height)
        now = _Values(np.zeros((3, count)), np.zeros(count), np.zeros(count, np.intp), np.zeros(count, bool))
        total, rays = 0.0, 0
        for begin in range(0, first, BLOCK):
            size = min(BLOCK, first - begin)
            uniforms = ChainUniforms(generator, size, camera.width, camera.height)
            found, traced = self._trace(uniforms, size)
            rays += traced
            sums.nonfinite += np.bincount(found.pixel[found.bad], minlength=sums.nonfinite.size)
            sums.add(found.pixel, found.radiance * (balance.level * balance.over(found.brightness)))
            more = float(found.brightness.sum())
            if more > 0.0:
                total += more
                moved = generator.permutation(count)[: int(count * more / total + generator.random())]
                chosen = _resample(found.brightness, generator.random(), moved.size)
                chains.take_over(moved, uniforms, chosen)
                now.put(moved, found.take(chosen))
            progress.check()
        return chains, now, total, rays

    def _trace(self, uniforms: ChainUniforms, count: int) -> tuple[_Values, int]:
        """Return what the proposals of all chains contribute, and the rays traced.

        What is not finite is 0 here.
        """
        camera = self.scene.camera
        sums, chain = PixelSums(count), np.arange(count)
        tracer = Tracer(self._kernel, uniforms, sums, StageClock())
        corner = np.zeros(count, np.intp)  # the raster's, to which the pair of the pixel is added
        tracer.trace(corner, corner + (camera.height - 1), chain, corner)
        x, y = uniforms.place()
        column = np.minimum(x.astype(np.intp), camera.width - 1)
        row = camera.height - 1 - np.minimum(y.astype(np.intp), camera.height - 1)
        bad = ~np.isfinite(sums.radiance).all(axis=0)
        radiance = np.where(bad, 0.0, sums.radiance)
        return _Values(radiance, luminance(np.abs(radiance)), row * camera.width + column, bad), tracer.rays


def _resample(weight: np.ndarray, uniform: float, count: int) -> np.ndarray:
    """Return indices (count,), each picked in proportion to its weight (n,).

    They are picked by one uniform and even steps.
    """
    edges = np.cumsum(weight)
    return np.searchsorted(edges, (np.arange(count) + uniform) / count * edges[-1], side="right").clip(
        0, weight.size - 1
    )
