# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: one emitter for each path, and the ray that leaves it."""

from __future__ import annotations

import numpy as np

from ..lights.light import Ball, Emitted, LightSample, LightSampler, Pair, emit_distant, luminance
from ..sampling.tables import Distribution1D
from ..sampling.warps import uniform_sphere
from ..wavefront.kernel import Kernel


class ConstantSky:
    """A world of one radiance (3, 1); every direction is as likely."""

    def __init__(self, radiance: np.ndarray, ball: Ball) -> None:
        self._radiance = radiance
        self.power = 4.0 * np.pi**2 * ball.radius**2 * float(luminance(radiance)[0])

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Through the ball, from everywhere."""
        wi = uniform_sphere(*heading)
        density = np.full(wi.shape[1], 1.0 / (4.0 * np.pi))
        radiance = np.broadcast_to(self._radiance, wi.shape)
        return emit_distant(LightSample(wi, np.full(wi.shape[1], np.inf), radiance, density), ball, place)


class Emitters:
    """All that shines on a `ball`, chosen by power; `any` is False where nothing does. `with_sky`: a constant world is among it."""

    def __init__(self, kernel: Kernel, ball: Ball, with_sky: bool) -> None:
        self._ball = ball
        self._emitters: list[LightSampler | ConstantSky] = list(kernel.lights)
        if with_sky and kernel.sky is not None:
            self._emitters.append(ConstantSky(kernel.sky, ball))
        power = np.array([emitter.power for emitter in self._emitters])
        self.any = bool(power.any())
        self._choice = Distribution1D(power) if self.any else None

    def emit(self, choice: np.ndarray, place: Pair, heading: Pair) -> Emitted:
        """The ray (n,) of each path; `choice` (n,) picks the emitter, whose chance divides the weight."""
        index = self._choice.index(choice)
        count = choice.size
        whole = Emitted(np.empty((3, count)), np.empty((3, count)), np.empty((3, count)), np.empty(count))
        for k in np.unique(index):
            at = np.flatnonzero(index == k)
            emitted = self._emitters[k].emit(self._ball, *((u[at], v[at]) for u, v in (place, heading)))
            for array, part in zip(whole, emitted, strict=True):
                array[..., at] = part
            whole.weight[:, at] /= self._choice.probability[k]
        return whole


def bounding_ball(vertices: np.ndarray) -> Ball:
    """The ball about the middle of the bounds that holds all vertices (3, v), a millionth larger; rays from afar begin at its edge."""
    if vertices.shape[1] == 0:
        return Ball(np.zeros((3, 1)), 0.0, 0.0)
    center = 0.5 * (vertices.min(axis=1) + vertices.max(axis=1))[:, None]
    radius = (1.0 + 1e-6) * float(np.sqrt(np.square(vertices - center).sum(axis=0).max()))
    return Ball(center, radius, radius)
