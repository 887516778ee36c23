# SPDX-License-Identifier: GPL-3.0-or-later
"""How large an image to compare: what a region's mean is known to depends on its samples, not on its pixels.

In little time a large image gets a few samples in each pixel, which costs whole renders before there is any answer. The same time on an
image a few times narrower and lower, in which every region means the same, gives as many samples to each region, in more
replicates. The size is decided from short renders of a small image, before anything that counts.
"""

from __future__ import annotations

import math

from ..sampling.streams import FIRST_CALLS
from ..scene.camera import Camera
from ..verdict.allocation import fit_cost
from .run import TimedRun
from .sides import Renderer

# Images of up to so many pixels are always compared as they are.
SMALL = 1 << 17
# So many replicates of one sample a pixel are to fit into this share of the time.
REPLICATES, SHARE = 24, 0.5
# Samples of the two timed renders of each side, whose images have about so many pixels.
FEW, MORE, PROBED = 1, 4, 1 << 14


def choose_divisor(renderers: tuple[Renderer, Renderer], camera: Camera, run: TimedRun) -> int:
    """How many times narrower and lower the image is to be, 1 for as it is; raises Cancelled.

    It divides width and height, so that the smaller camera sees exactly the same. Where there is no limit on time, or no such
    divisor but 1, the image stays as it is.
    """
    pixels = camera.width * camera.height
    divisors = [d for d in range(1, camera.width + 1) if camera.width % d == camera.height % d == 0]
    if run.budget is None or pixels <= SMALL or len(divisors) == 1:
        return 1
    small = min(divisors, key=lambda d: abs(math.log(pixels / d**2 / PROBED)))
    seconds = 0.0
    for side, renderer in enumerate(renderers):
        probe, timings = renderer.at_size(camera.width // small, camera.height // small), []
        for k, samples in enumerate((FEW, FEW, MORE)):
            _, spent = run.render(probe, FIRST_CALLS.number(3 * side + k), samples)
            timings.append(spent)
        # The first call sets things up.
        seconds += fit_cost([FEW, MORE], timings[1:]).per_sample * small**2
    affordable = SHARE * run.budget / (REPLICATES * max(seconds, 1e-9))
    return next((d for d in divisors if d**2 * affordable >= 1.0 or pixels / d**2 <= SMALL), divisors[-1])
