# SPDX-License-Identifier: GPL-3.0-or-later
"""The size of the image to compare.

The accuracy of a region's mean depends on its samples, not on its pixels. In little time a large image gets a few
samples in each pixel, which costs whole renders before there is any answer. The same time on an image a few times
narrower and lower, in which every region means the same, gives as many samples to each region, in more replicates. The
size is decided from short renders of a small image, before anything that counts.
"""

from __future__ import annotations

import math

from ..sampling.streams import FIRST_CALLS
from ..scene.camera import Camera
from ..verdict.allocation import fit_cost
from ..verdict.boundaries import FIRST_LOOK
from .departures import Alternatives
from .meter import ASIDE_AT_MOST
from .pilot import CALLS_BEFORE
from .run import TimedRun
from .sides import Renderer

# An image is made no smaller than this for REPLICATES, and no smaller than TINY for FIRST_LOOK, of one sample a pixel each.
SMALL, TINY = 1 << 17, 1 << 13
# The first are to fit into this share of the time. The others, with the calls before them, are to fit into this share of what is left,
# since the search for causes may take the rest.
REPLICATES, SHARE, FIRST_SHARE = 24, 0.5, 0.75
# Where the scene has what makes Cycles differ, so many pairs of images of each departure are to fit into the time for causes.
LEAST_PAIRS = 3
# Samples of the two timed renders of each side, whose images have about so many pixels.
FEW, MORE, PROBED = 1, 4, 1 << 14


def images_of_search(among: Alternatives) -> int:
    """How many images of the reference the search for causes needs, where a difference is to be expected.

    That is where rounding decides how much of a departure acts, as with faces in one plane; 0 elsewhere.
    """
    expected = any(departure.by_rounding for departure in among.departures)
    return LEAST_PAIRS * (len(among.departures) + 1) if expected else 0


def choose_divisor(renderers: tuple[Renderer, Renderer], camera: Camera, run: TimedRun, searched: int = 0) -> int:
    """How many times narrower and lower the image is to be, 1 for as it is; raises Cancelled.

    It divides width and height, so that the smaller camera sees exactly the same. The search for causes needs `searched` images
    of the first renderer. Where there is no limit on time, or 1 is
    the only such divisor, the image stays as it is.
    """
    pixels = camera.width * camera.height
    divisors = [d for d in range(1, camera.width + 1) if camera.width % d == camera.height % d == 0]
    if run.budget is None or pixels <= TINY or len(divisors) == 1:
        return 1
    small = min(divisors, key=lambda d: abs(math.log(pixels / d**2 / PROBED)))
    probes = [renderer.at_size(camera.width // small, camera.height // small) for renderer in renderers]

    def seconds(samples: int, number: int) -> list[float]:
        return [run.render(probe, FIRST_CALLS.number(3 * k + number), samples)[1] for k, probe in enumerate(probes)]

    def fit_at_full_size(few: list[float]) -> bool:
        # Even if all of a call's time went by pixels.
        fit_all = first * sum(few) * small**2 <= FIRST_SHARE * run.left
        return pixels <= SMALL and fit_all and searched * few[0] * small**2 <= ASIDE_AT_MOST * run.left

    first = FIRST_LOOK + CALLS_BEFORE
    # The first calls set things up too.
    if fit_at_full_size(seconds(FEW, 0)) or fit_at_full_size(few := seconds(FEW, 1)):
        return 1
    costs = [fit_cost([FEW, MORE], list(pair)) for pair in zip(few, seconds(MORE, 2), strict=True)]
    fixed, per_sample = sum(cost.fixed for cost in costs), sum(cost.per_sample for cost in costs) * small**2

    left, aside = FIRST_SHARE * run.left, ASIDE_AT_MOST * run.left

    def is_searched(divisor: int) -> bool:
        of_pixels = costs[0].per_sample * (small / divisor) ** 2
        small_enough = pixels / divisor**2 <= TINY or of_pixels <= costs[0].fixed
        return small_enough or searched * (costs[0].fixed + of_pixels) <= aside

    def fits(divisor: int, replicates: int, time: float, least: int) -> bool:
        of_pixels = per_sample / divisor**2
        # Where a call's fixed part is more than its pixels', fewer pixels gain little.
        small_enough = pixels / divisor**2 <= least or (least == TINY and of_pixels <= fixed)
        return small_enough or replicates * (fixed + of_pixels) <= time

    enough = next((d for d in divisors if fits(d, REPLICATES, run.share(SHARE), SMALL)), divisors[-1])
    chosen = (d for d in divisors if d >= enough and fits(d, first, left, TINY) and is_searched(d))
    return next(chosen, divisors[-1])
