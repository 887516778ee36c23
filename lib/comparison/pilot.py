# SPDX-License-Identifier: GPL-3.0-or-later
"""The pilot: what a sample costs on either side and how noisy it is, and from that the samples of a replicate."""

from __future__ import annotations

import numpy as np

from ..film.regions import RegionMoments, image_regions
from ..sampling.streams import FIRST_CALLS
from ..verdict.allocation import Cost, allocate, fit_cost, relative_noise
from .run import TimedRun
from .sides import Renderer

# What the pilot may take of the time, for each side, and where it ends.
PILOT_SHARE = 0.02
PILOT_SAMPLES = 64


def choose_samples(reference: Renderer, candidate: Renderer, run: TimedRun) -> tuple[int, int]:
    """Samples per replicate for both sides, from what they cost and how noisy they are; raises Cancelled."""
    costs, noises = zip(*(_measure(r, PILOT_SHARE * run.budget, run) for r in (reference, candidate)), strict=True)
    return allocate(run.left, costs, noises)


def _measure(renderer: Renderer, share: float, run: TimedRun) -> tuple[Cost, float]:
    """Cost and relative noise of one side, in about `share` seconds beyond the first call, which also sets things up."""
    samples, seconds, begin = [1], [], None
    while True:
        rendering, spent = run.render(renderer, FIRST_CALLS.number(len(seconds)), samples[-1])
        begin = begin or run.elapsed
        seconds.append(spent)
        enough = run.elapsed - begin + 16 * seconds[-1] > share or samples[-1] >= PILOT_SAMPLES
        if enough and len(samples) > 1:  # one timing cannot tell what a call costs from what a sample costs
            break
        samples.append(8 * samples[-1])
    again, _ = run.render(renderer, FIRST_CALLS.number(len(seconds)), samples[-1])
    height, width = rendering.radiance.shape[:2]
    grid = image_regions(height, width, {})
    first, second = (RegionMoments(grid).means(np.nan_to_num(r.radiance)) for r in (rendering, again))
    return fit_cost(samples, seconds), relative_noise(first, second, samples[-1])
