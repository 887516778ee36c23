# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that camera paths can hardly find.

It says how much of this light each region receives, and how much may have been missed. A diffuse face that a mirror or
a clear glass lights from a small lamp gets that light, in path tracing, from the rare path that happens to be reflected
into the lamp. Light tracing finds it at once, so a short pass of it, before anything that counts, shows where a verdict
of path tracers must not be trusted before they have had the samples to meet it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from ..film.regions import Regions
from ..light_tracing.refuse import masks_not_traced
from ..light_tracing.scouting import Scouted, scout_caustics
from ..progress import Progress
from ..relative import difference_scale
from ..scene.camera import PANORAMAS
from ..verdict.rare import room_for_rare_light
from ..wavefront.coverage import bare_pixels
from ..wavefront.kernel import Kernel
from .run import TimedRun

# Rays from the lights: at least, at most, and where there is no limit on time; and what the pass may take of the time.
LEAST, MOST, UNLIMITED, SHARE = 1 << 16, 1 << 21, 1 << 18, 0.02
# What a region receives is taken to be at most so many standard errors above the estimate, and what so many contributions more of the mean
# size would add: a region that met none may still receive some (with 5.3 in the mean, none comes with a probability of 0.5 %).
STANDARD_ERRORS, UNMET = 3.0, 5.3


@dataclass(frozen=True)
class Caustics:
    """The caustics of K regions, in W m^-2 sr^-1.

    `radiance` (K, 3) is what the regions receive by caustics at most. `brightness` (K,) is the radiance of the
    brightest lamp that arrives so, which is the worth of one sample that meets it. `bare` (K,) marks regions that show
    the world alone.
    """

    radiance: np.ndarray
    brightness: np.ndarray
    bare: np.ndarray

    def share(self, reference: np.ndarray, floor: np.ndarray | float) -> np.ndarray:
        """The part (K,) that caustics have in each region's light of means `reference` (K, 3).

        It is that of the channel where it is largest.
        """
        scale = difference_scale(reference, floor)
        return np.divide(self.radiance, scale, out=np.zeros(scale.shape), where=scale > 0).max(axis=1)

    def room(self, reference: np.ndarray, floor: np.ndarray | float, samples: np.ndarray, level: float) -> np.ndarray:
        """The relative difference (K,) of each region that unmet caustics may explain.

        None of its `samples` (K,) met them. The difference is at most all that arrives so, and at most what samples
        of that worth may hide with probability `level` (verdict/rare.py).
        """
        mean = np.maximum(difference_scale(reference, floor).mean(axis=1), np.finfo(float).tiny)
        missed = room_for_rare_light(self.brightness / mean, samples, level)
        return np.minimum(self.share(reference, floor), missed)


def scout(kernel: Kernel, run: TimedRun) -> Scouted | None:
    """A pass of light tracing in a small share of the time.

    None where the camera is panoramic, which cannot be connected to, where masks of rays decide who sees whom, and where there are volumes.

    Raises Cancelled.
    """
    if kernel.scene.camera.kind in PANORAMAS or masks_not_traced(kernel):
        return None
    silent = Progress(is_cancelled=lambda: run.progress.is_cancelled)
    found = scout_caustics(kernel, UNLIMITED if run.budget is None else LEAST, progress=silent)
    if run.budget is not None:
        paths = int(min(SHARE * run.budget / max(found.seconds, 1e-6) * LEAST, MOST))
        # Also where the first pass met nothing: so few rays are no proof. Where no caustic is possible this costs nothing.
        found = found if paths < 2 * LEAST else scout_caustics(kernel, paths, progress=silent)
    return replace(found, bare=bare_pixels(kernel))


def caustics_in(scouted: Scouted, regions: Regions) -> Caustics:
    """What a scouting pass found, by region.

    Lights without size are left out: no path from a camera, of either renderer, ever meets one by chance. Where no face is seen,
    none can be lit.
    """
    seen = np.isfinite(scouted.brightness)
    pixel, batch = scouted.pixel[seen], scouted.batch[seen]
    pixels = regions.shape[0] * regions.shape[1]
    sizes = np.maximum(regions.sizes, np.finfo(float).tiny)[:, None]
    bare = np.zeros(len(regions), bool)
    if scouted.bare is not None:
        bare = (regions.sizes > 0) & (regions.weights @ (~scouted.bare.ravel()).astype(float) == 0)
    channels = []
    for value in scouted.value[:, seen]:
        each = sparse.csr_array((value, (pixel, batch)), shape=(pixels, scouted.batches))
        # SciPy's types take the product of two sparse arrays for a dense one.
        means = (regions.weights @ each).toarray() / sizes  # pyright: ignore[reportAttributeAccessIssue]
        error = means.std(axis=1, ddof=1) / np.sqrt(scouted.batches)
        unmet = np.where(bare, 0.0, UNMET * (value.mean() if value.size else 0.0) / (sizes[:, 0] * scouted.batches))
        channels.append(means.mean(axis=1) + STANDARD_ERRORS * error + unmet)
    brightest = np.zeros(pixels)
    np.maximum.at(brightest, pixel, scouted.brightness[seen])
    weights = regions.weights
    found = np.maximum.reduceat(np.append(brightest[weights.indices], 0.0), weights.indptr[:-1])
    # What a region may receive without having met it may come from any lamp.
    found = np.where((np.diff(weights.indptr) > 0) & (found > 0.0), found, brightest.max(initial=0.0))
    return Caustics(np.stack(channels, axis=1), found, bare)
