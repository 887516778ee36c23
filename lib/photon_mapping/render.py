# SPDX-License-Identifier: GPL-3.0-or-later
"""Replicates of an image by progressive photon mapping, and the bias to expect of them."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from time import perf_counter

import numpy as np

from ..effects.plan import Plan
from ..errors import EtalonError
from ..film.rendering import Rendering
from ..light_tracing.emitters import gather_emitters
from ..light_tracing.refuse import refuse_unsupported
from ..lights.light import bounding_ball
from ..progress import NO_PROGRESS, Progress
from ..sampling.sobol import RandomSampler, SobolSampler
from ..sampling.streams import FIRST_CALLS
from ..scene.scene import Scene
from ..settings.reference import Options
from ..wavefront.render import ReferenceRenderer
from ..wavefront.sums import PixelSums
from .gather import INNER, GatherTracer
from .photons import DEPTH, trace_photons

# Light paths in a pass: one for each pixel, but not fewer than this. The radius follows from it.
LEAST_PATHS = 1 << 14
# The first radius reaches so many neighbours of the median photon.
NEIGHBOURS = 4
# How much of what new photons allow goes into less noise; the rest shrinks the disc (Hachisuka et al. 2008).
ALPHA = 2.0 / 3.0
# Camera rays whose photons are gathered at once.
GATHERED = 8192


@dataclass(frozen=True)
class Bias:
    """The relative error of the image's mean that discs of these radii leave.

    The fields are the first and the last radius in metres, and the bias.
    """

    first: float
    last: float
    relative: float

    def __str__(self) -> str:
        return f"photon radius {self.first:.3g} m down to {self.last:.3g} m, expected bias {self.relative:+.2%} of the mean"


class PhotonMappingRenderer:
    """Renders by probabilistic progressive photon mapping (Knaus and Zwicker 2011).

    Each sample is a pass with a photon map of its own.

    Passes are independent, and their radius follows from their number, so replicates are independent and share one
    bias. Raises Refused for what paths from the lights do not simulate.
    """

    name = "photon mapping"

    def __init__(self, scene: Scene, options: Options, plan: Plan | None = None) -> None:
        self.scene, self.options = scene, options
        self._kernel = ReferenceRenderer(scene, options, plan).kernel
        refuse_unsupported(self._kernel)
        emitters = gather_emitters(self._kernel, bounding_ball(scene.mesh.vertices), with_sky=True)
        if emitters is None:
            raise EtalonError(f"{scene.name}: there is no light to send out photons; render with --strategy visible")
        self._emitters = emitters
        self._paths = max(scene.camera.width * scene.camera.height, LEAST_PATHS)
        self._radius = self._first_radius()
        self._mean, self._excess, self._passes = 0.0, 0.0, 0

    def _sampler(self, replicate: int, depth: int) -> SobolSampler | RandomSampler:
        make = SobolSampler if self.options.sampler == "sobol" else RandomSampler
        return make(self.options.seed, replicate, depth)

    def _first_radius(self) -> float:
        """Return the median distance of a photon from its NEIGHBOURS-th neighbour.

        It is measured in a photon map that is not used for the image.
        """
        sampler = self._sampler(FIRST_CALLS.number(0), DEPTH)
        photons = trace_photons(self._kernel, self._emitters, sampler, 0, LEAST_PATHS)
        if len(photons.tree.data) <= NEIGHBOURS:
            raise EtalonError(f"{self.scene.name}: no photons meet the scene; render with --strategy visible")
        distance, _ = photons.tree.query(photons.position.T[::16], k=[NEIGHBOURS + 1])  # the first is the photon itself
        return float(np.median(distance)) * float(np.sqrt(LEAST_PATHS / self._paths))

    def radii(self, passes: int) -> np.ndarray:
        """Return the radius of each pass, in metres.

        r_(i+1)^2 = r_i^2 (i + alpha) / (i + 1) (Knaus and Zwicker 2011, eq. 16).
        """
        i = np.arange(1, passes)
        return self._radius * np.sqrt(np.concatenate([[1.0], np.cumprod((i + ALPHA) / (i + 1.0))]))

    @property
    def bias(self) -> Bias:
        """The bias to expect of what has been rendered.

        Discs that reach beyond an edge make an error that is proportional to their radius. So the image by discs of half the area,
        which the same photons give, has 1 / sqrt(2) of it. Errors that fall faster are overstated.
        """
        radii = self.radii(max(self._passes, 1))
        excess = self._excess / (1.0 - float(np.sqrt(INNER)))
        truth = self._mean - excess
        return Bias(float(radii[0]), float(radii[-1]), excess / truth if truth else 0.0)

    def render(self, replicate: int, samples: int, progress: Progress = NO_PROGRESS) -> Rendering:
        """One independent replicate of `samples` passes; raises Cancelled."""
        begin = perf_counter()
        camera = self.scene.camera
        eye, light = self._sampler(replicate, samples), self._sampler(replicate, DEPTH)
        radii = self.radii(samples)
        whole, excess, rays = PixelSums(camera.width * camera.height), np.zeros(3), 0

        def run(number: int) -> tuple[PixelSums, np.ndarray, int]:
            with np.errstate(invalid="ignore"):  # what is not finite is counted by the sums
                return self._pass(eye, light, number, float(radii[number]))

        with ThreadPoolExecutor(self.options.threads) as pool:
            pending: deque[Future] = deque()
            queue = iter(range(samples))
            try:
                for done in range(samples):
                    pending.extend(pool.submit(run, k) for k in islice(queue, self.options.threads - len(pending)))
                    sums, more, traced = pending.popleft().result()
                    whole.radiance += sums.radiance
                    whole.nonfinite += sums.nonfinite
                    excess += more
                    rays += traced
                    progress.report((done + 1) / samples)
                    progress.check()
            finally:
                for future in pending:
                    future.cancel()
        self._passes = samples
        self._mean += float(np.nansum(whole.radiance))
        self._excess += float(excess.sum())
        shape = (camera.height, camera.width)
        radiance = whole.radiance.T.reshape(*shape, 3) / samples
        nonfinite = whole.nonfinite.reshape(shape).astype(np.int32)
        seconds = perf_counter() - begin
        return Rendering(radiance, nonfinite, seconds, {}, whole.nonfinite.size * samples, rays)

    def _pass(
        self, eye: SobolSampler | RandomSampler, light: SobolSampler | RandomSampler, number: int, radius: float
    ) -> tuple[PixelSums, np.ndarray, int]:
        """Return the sums of one pass, its excess (3,), and its rays.

        The excess is that of its image over the image from discs of half the area.
        """
        photons = trace_photons(self._kernel, self._emitters, light, number, self._paths)
        width, pixels = self.scene.camera.width, self.scene.camera.width * self.scene.camera.height
        whole, excess, rays = PixelSums(pixels), np.zeros(3), photons.rays
        for first in range(0, pixels, GATHERED):
            index = np.arange(first, min(first + GATHERED, pixels), dtype=np.int32)
            row, column = np.divmod(index, width)
            sums = PixelSums(index.size)
            tracer = GatherTracer(self._kernel, eye.tile(index), sums, photons, radius)
            pixel = np.arange(index.size)
            tracer.trace(column, row, pixel, np.full(index.size, number))
            whole.radiance[:, index] = sums.radiance
            whole.nonfinite[index] = sums.nonfinite
            excess += np.nansum(tracer.excess.radiance, axis=1)
            rays += tracer.rays
        return whole, excess, rays
