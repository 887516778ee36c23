# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: sampled light that arrives; shadow rays ask whether it does."""

from __future__ import annotations

import numpy as np

from ..effects.names import Stage
from ..vectors import gather
from .flow import Flow
from .kernel import Kernel
from .light_choice import LightChoice
from .origins import SurfaceOrigins, VolumeOrigins
from .paths import Paths
from .sums import PixelSums, StageClock
from .visibility import transmittance, transmittance_to


class DirectLight:
    """Adds sampled light to pixel sums; `rays` counts shadow rays."""

    def __init__(self, kernel: Kernel, flow: Flow, sums: PixelSums, clock: StageClock) -> None:
        self._kernel, self._flow, self._sums, self._clock = kernel, flow, sums, clock
        self.rays = 0

    def add(
        self,
        paths: Paths,
        origins: SurfaceOrigins | VolumeOrigins,
        light: LightChoice,
        direct: np.ndarray,
        shares: np.ndarray | None,
    ) -> None:
        """Ask for visibility where light would arrive, and add what does.

        `direct` (3, n) is what of the sampled light is scattered back along the rays, before visibility and throughput; the
        families of lobes have the `shares` of it.
        """
        sample, direct = light.sample, direct * paths.throughput
        index = np.flatnonzero(direct.any(axis=0))
        if self._kernel.sight.casts_shadow is not None:
            casts = np.broadcast_to(self._kernel.sight.casts_shadow[light.number], paths.pixel.shape)[index]
            free, index = index[~casts], index[casts]
            self._arrive(paths, free, gather(direct, free), light.number, shares)
        if index.size == 0:
            return
        if not self._flow.asks_visibility:
            self._arrive(paths, index, gather(direct, index), light.number, shares)
            return
        direction = gather(sample.wi, index)
        origin = gather(origins.towards(sample.wi), index)
        rays = origin, direction, gather(sample.distance, index)
        medium = origins.medium(index, direction)
        tally = paths.tally_of_shadows(index) if self._flow.counts else None
        if self._kernel.sight.shadow_of is None:
            through, unknown = transmittance(self._kernel, self._flow.transparent, *rays, medium=medium, tally=tally)
        else:
            number = np.broadcast_to(light.number, paths.pixel.shape)[index]
            through, unknown = transmittance_to(self._kernel, self._flow.transparent, number, *rays, medium, tally)
        if unknown.size:
            self._sums.add_unknown(paths.pixel[index[unknown]])
        if self._kernel.coplanar is not None:
            through = through * origins.coplanar(self._kernel.coplanar, index, direction, tally)
        self.rays += index.size
        self._clock.lap(Stage.SHADOW_RAYS)
        lit = np.flatnonzero(through.any(axis=0))  # what is hidden does not count, not even as inf * 0
        index = index[lit]
        arriving = gather(direct, index)
        if through.shape[0] == 3:
            arriving *= gather(through, lit)
        self._arrive(paths, index, arriving, light.number, shares)

    def _arrive(
        self, paths: Paths, index: np.ndarray, arriving: np.ndarray, light: np.ndarray, shares: np.ndarray | None
    ) -> None:
        """Add the light (3, n) of the paths at `index`.

        `light` () or of all paths says from which light, `shares` of all paths what the families of lobes have of it.
        """
        sums = self._sums
        sums.add(gather(paths.pixel, index), arriving)
        if sums.passes is not None:
            here = None if shares is None else gather(shares, index)
            sums.passes.add_direct(paths, index, arriving, here)
        if sums.bounces is not None:
            sums.bounces.add(paths, index, arriving, 1)
        if sums.emitters is not None:
            number = np.broadcast_to(light, paths.pixel.shape)[index]
            sums.emitters.add(paths.pixel[index], arriving, self._kernel.emitters.of_lights[number])
        self._clock.lap(Stage.FILM)
