# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur by replicates.

They average the scene over the time in which the shutter is open.

A replicate renders the scene at several moments. The shutter interval is cut into as many strata of equal weight, and
each moment is uniform in its stratum, so that the mean over replicates is the integral over time without bias. All
samples of a moment share its time, so samples of one replicate are correlated; replicates have moments of their own,
so their variance says how far the image is off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from time import perf_counter

import numpy as np

from ..film.rendering import Rendering
from ..progress import Progress
from ..sampling.sobol import stream_key
from ..sampling.streams import SHUTTER
from ..scene.interpolation import shutter_times
from ..scene.moment import scene_at
from ..scene.scene import Scene

Render = Callable[[Scene, int, int, Progress], Rendering]
"""Renders a scene that stands still: scene, seed, samples per pixel, progress."""

SHUTTER_ENDS = "shutter ends"
"""The departure that leaves out the first and the last moments of the shutter's time."""

MOMENTS = 16
"""Moments of a replicate, at most: each builds what rays are traced against anew."""


def count_moments(samples: int) -> int:
    """The most moments, up to MOMENTS, that share `samples` evenly."""
    return max(count for count in range(1, MOMENTS + 1) if samples % count == 0)


def table_times(u: np.ndarray) -> np.ndarray:
    """Shutter times (n,) of uniforms (n,), as Cycles draws them for a flat curve: a departure.

    Its table of 256 entries has 255 / 256 of the time for the middle of each, and is read from the middle of the first entry to that of
    the last. See docs/findings/shutter_ends.md.
    """
    last, entries = 255.0, 256.0
    return last * (last * u + 0.5) / entries**2


def draw_moments(
    shutter: np.ndarray | None, seed: int, replicate: int, count: int, departures: Set[str] = frozenset()
) -> np.ndarray:
    """(count,) shutter times of a replicate, one in each of `count` strata of equal weight."""
    jitter = np.random.default_rng(int(stream_key(seed, replicate, SHUTTER))).random(count)
    u = (np.arange(count) + jitter) / count
    return table_times(u) if SHUTTER_ENDS in departures else shutter_times(shutter, u)


def render_moments(
    scene: Scene,
    seed: int,
    replicate: int,
    samples: int,
    progress: Progress,
    render: Render,
    departures: Set[str] = frozenset(),
) -> Rendering:
    """Return the mean of what `render` returns at the moments of a replicate.

    `samples` are per pixel in all. Of the `departures` one is about the moments.

    Each moment has a seed of its own: the same points at all of them would not average out.
    """
    begin, count = perf_counter(), count_moments(samples)
    shutter = None if scene.motion is None else scene.motion.shutter
    done = []
    for k, time in enumerate(draw_moments(shutter, seed, replicate, count, departures)):
        own = int(stream_key(seed, replicate, SHUTTER, k))
        part = progress.within(k / count, (k + 1) / count)
        done.append(render(scene_at(scene, time), own, samples // count, part))
    return _average(done, perf_counter() - begin)


def _average(done: Sequence[Rendering], seconds: float) -> Rendering:
    """The mean of images with equally many samples; what is counted is added up."""
    first = done[0]
    unknown = [one.unknown for one in done if one.unknown is not None]
    return Rendering(
        radiance=np.mean([one.radiance for one in done], axis=0),
        nonfinite=np.sum([one.nonfinite for one in done], axis=0, dtype=np.int32),
        seconds=seconds,
        stages={name: sum(one.stages.get(name, 0.0) for one in done) for name in first.stages},
        camera_samples=sum(one.camera_samples for one in done),
        rays=sum(one.rays for one in done),
        windows=first.windows,
        unknown=np.sum(unknown, axis=0, dtype=np.int32) if unknown else None,
        moments=len(done),
        passes={name: np.mean([one.passes[name] for one in done], axis=0) for name in first.passes},
    )
