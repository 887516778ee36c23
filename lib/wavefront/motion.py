# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur: replicates that average the scene over the time in which the shutter is open.

A replicate renders the scene at several moments. The shutter interval is cut into as many strata of equal weight, and each moment is
uniform in its stratum, so that the mean over replicates is the integral over time without bias. All samples of a moment share its time, so
samples of one replicate are correlated; replicates have moments of their own, so their variance says how far the image is off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np

from ..film.parts import Part
from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import NO_PROGRESS, Progress
from ..sampling.sobol import stream_key
from ..sampling.streams import SHUTTER
from ..scene.motion import Motion, scene_at, shutter_times
from ..scene.scene import Scene
from ..settings.reference import Options
from .render import ReferenceRenderer

MOMENTS = 16
"""Moments of a replicate, at most: each builds what rays are traced against anew."""


def count_moments(samples: int) -> int:
    """The most moments, up to MOMENTS, that share `samples` evenly."""
    return max(count for count in range(1, MOMENTS + 1) if samples % count == 0)


def draw_moments(motion: Motion, seed: int, replicate: int, count: int) -> np.ndarray:
    """(count,) shutter times of a replicate, one in each of `count` strata of equal weight."""
    jitter = np.random.default_rng(int(stream_key(seed, replicate, SHUTTER))).random(count)
    return shutter_times(motion.shutter, (np.arange(count) + jitter) / count)


class MotionRenderer:
    """The scene with `motion` while the shutter is open."""

    name = "reference"

    def __init__(
        self,
        scene: Scene,
        motion: Motion,
        options: Options = Options(),  # noqa: B008
        passes: Sequence[Part] = (),
    ) -> None:
        self.scene, self.motion, self.options, self.passes = scene, motion, options, tuple(passes)

    def render(
        self,
        replicate: int,
        samples: int,
        progress: Progress = NO_PROGRESS,
        windows: Windows | None = None,
    ) -> Rendering:
        """One independent replicate of `samples` samples per pixel; raises Cancelled when asked to stop."""
        begin, count = perf_counter(), count_moments(samples)
        done = []
        for k, time in enumerate(draw_moments(self.motion, self.options.seed, replicate, count)):
            # A seed for each moment: the same points at all moments would not average out.
            options = replace(self.options, seed=int(stream_key(self.options.seed, replicate, SHUTTER, k)))
            renderer = ReferenceRenderer(scene_at(self.scene, self.motion, time), options, passes=self.passes)
            part = progress.within(k / count, (k + 1) / count)
            done.append(renderer.render(replicate, samples // count, part, windows))
        return _average(done, perf_counter() - begin)


def _average(done: Sequence[Rendering], seconds: float) -> Rendering:
    """The mean of images with equally many samples; what is counted is added up."""
    first = done[0]
    return Rendering(
        radiance=np.mean([one.radiance for one in done], axis=0),
        nonfinite=np.sum([one.nonfinite for one in done], axis=0, dtype=np.int32),
        seconds=seconds,
        stages={name: sum(one.stages.get(name, 0.0) for one in done) for name in first.stages},
        camera_samples=sum(one.camera_samples for one in done),
        rays=sum(one.rays for one in done),
        windows=first.windows,
        unknown=None if first.unknown is None else np.sum([one.unknown for one in done], axis=0, dtype=np.int32),
        passes={name: np.mean([one.passes[name] for one in done], axis=0) for name in first.passes},
    )
