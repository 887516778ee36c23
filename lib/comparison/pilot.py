# SPDX-License-Identifier: GPL-3.0-or-later
"""The pilot: what a sample costs on either side and how noisy it is, and from that the samples of a replicate."""

from __future__ import annotations

import numpy as np

from ..film.regions import RegionMoments, image_regions
from ..settings.comparison import CompareOptions
from ..verdict.allocation import Cost, allocate, fit_cost, relative_noise
from .meter import Meter
from .sides import Renderer

# Replicates of the pilot are numbered from here, so that the verdict's own start at 0 whatever the pilot needed.
PILOT = 1 << 20
# What the pilot may take of the time, for each side, and where it ends.
PILOT_SHARE = 0.02
PILOT_SAMPLES = 64


def pilot(reference: Renderer, candidate: Renderer, options: CompareOptions, meter: Meter) -> tuple[int, int]:
    """Samples per replicate for both sides, from what they cost and how noisy they are; 1 each where it is cancelled."""
    measured = [_measure(r, PILOT_SHARE * options.time, meter) for r in (reference, candidate)]
    if None in measured:
        return 1, 1
    costs, noises = zip(*measured, strict=True)
    return allocate(options.time - meter.elapsed, costs, noises)


def _measure(renderer: Renderer, share: float, meter: Meter) -> tuple[Cost, float] | None:
    """Cost and relative noise of one side, in about `share` seconds beyond the first call, which also sets things up."""
    samples, seconds, begin = [1], [], None
    while True:
        before = meter.elapsed
        rendering = meter.pilot(renderer, PILOT + len(seconds), samples[-1])
        if rendering is None:
            return None
        begin = begin or meter.elapsed
        seconds.append(meter.elapsed - before)
        enough = meter.elapsed - begin + 16 * seconds[-1] > share or samples[-1] >= PILOT_SAMPLES
        if enough and len(samples) > 1:  # one timing cannot tell what a call costs from what a sample costs
            break
        samples.append(8 * samples[-1])
    again = meter.pilot(renderer, PILOT + len(seconds), samples[-1])
    if again is None:
        return None
    grid = image_regions(*rendering.radiance.shape[:2], {})
    means = [RegionMoments(grid).means(np.nan_to_num(r.radiance)) for r in (rendering, again)]
    return fit_cost(samples, seconds), relative_noise(*means, samples[-1])
