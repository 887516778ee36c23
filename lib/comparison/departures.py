# SPDX-License-Identifier: GPL-3.0-or-later
"""The effect of departures on an image.

It comes from pairs of replicates of the reference, with the departures and without, under the same scrambling.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..departures.catalogue import Departure, relevant
from ..errors import Cancelled
from ..film.film import finite_or_nan
from ..film.regions import RegionMoments, Regions
from ..film.rendering import Rendering
from ..sampling.streams import DEPARTURES
from ..wavefront.render import ReferenceRenderer

# What the effects of single departures may take of the time that is set aside; the rest is left to sets of them.
SINGLES_SHARE = 0.4


@dataclass(frozen=True)
class Alternatives:
    """The departures that may matter, and the renderer that departs by a set of their names."""

    departures: tuple[Departure, ...]
    renderer: Callable[[frozenset[str]], Any]


def alternatives(reference: ReferenceRenderer) -> Alternatives:
    """Those of `reference`: what is relevant to its scene and not switched on yet."""
    options = reference.options
    found = tuple(d for d in relevant(reference.scene, options.masking) if d.name not in options.departures)

    def renderer(names: frozenset[str]) -> ReferenceRenderer:
        changed = replace(options, departures=options.departures | names)
        return ReferenceRenderer(reference.scene, changed, reference.plan, reference.kernel)

    return Alternatives(found, renderer)


class PairedEffects:
    """The effects of departures, by calling it with a set of names.

    The result, (pairs, N, 3), is what they add to each region, one row for each pair of replicates. `render(renderer,
    replicate, samples)` does the work, and may raise Cancelled. Pairs are kept, and more are made as they are asked
    for, while `has_time` says so. `seconds` (None: no limit) are what may be planned with.
    """

    def __init__(
        self,
        among: Alternatives,
        render: Callable[[Any, int, int], Rendering],
        has_time: Callable[[], bool],
        seconds: float | None,
    ) -> None:
        self._among, self._render = among, render
        self._has_time, self._seconds = has_time, seconds
        self._renderers: dict[frozenset[str], Any] = {}
        self._plain: list[np.ndarray] = []
        self._effects: dict[frozenset[str], list[np.ndarray]] = {}
        self._regions: RegionMoments | None = None
        self.samples = 0

    def budget(self, samples: int, pairs: int, cost: float) -> None:
        """Settle the samples per pixel, once.

        They are `samples`, halved until `pairs` of each departure alone fit into the time. A replicate of one sample
        takes `cost` seconds.
        """
        if self.samples:
            return
        self.samples = samples
        renderings = pairs * (len(self._among.departures) + 1)
        while self._seconds is not None and self.samples > 1:
            if renderings * self.samples * cost <= SINGLES_SHARE * self._seconds:
                return
            self.samples = (self.samples + 1) // 2

    def __call__(self, names: frozenset[str], count: int, regions: Regions, excluded: np.ndarray) -> np.ndarray | None:
        """The effects of `names` on `regions` without the pixels `excluded` (height, width).

        None without a pair of them.
        """
        if self._regions is None or (self._regions.excluded != excluded).any():
            # Images are not kept, so what was made of them without these pixels is made again.
            self._plain.clear()
            self._effects.clear()
            self._regions = RegionMoments(regions, excluded)
        effects = self._effects.setdefault(names, [])
        while len(effects) < count and self._has_time():
            k = len(effects)
            if k == len(self._plain):
                plain = self._means(self._regions, frozenset(), k)
                if plain is None:
                    break
                self._plain.append(plain)
            changed = self._means(self._regions, names, k)
            if changed is None:
                break
            effects.append(changed - self._plain[k])
        return np.stack(effects[:count]) if effects else None

    def _means(self, regions: RegionMoments, names: frozenset[str], pair: int) -> np.ndarray | None:
        """The regions' means (N, 3) of one image."""
        if names not in self._renderers:
            self._renderers[names] = self._among.renderer(names)
        try:
            rendering = self._render(self._renderers[names], DEPARTURES.number(pair), self.samples)
        except Cancelled:
            return None
        return regions.means(finite_or_nan(rendering, regions.regions.shape))
