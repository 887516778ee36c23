# SPDX-License-Identifier: GPL-3.0-or-later
"""What departures do to an image: pairs of replicates of the reference, with them and without, under the same scrambling."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..film.film import finite_or_nan
from ..film.moments import Moments
from ..film.regions import RegionMoments, Regions
from ..film.rendering import Rendering
from ..wavefront.render import ReferenceRenderer
from .catalogue import Departure, relevant

# Pairs are numbered from here, apart from every other replicate.
FIRST = 1 << 21
# What the effects of single departures may take of the time that is set aside; the rest is left to sets of them.
SINGLES_SHARE = 0.6


@dataclass(frozen=True)
class Alternatives:
    """The departures that may matter, and the renderer that departs by a set of their names."""

    departures: tuple[Departure, ...]
    renderer: Callable[[frozenset[str]], Any]


def alternatives(reference: ReferenceRenderer) -> Alternatives:
    """Those of `reference`: what is relevant to its scene and not switched on yet."""
    options = reference.options
    found = tuple(d for d in relevant(reference.scene) if d.name not in options.departures)

    def renderer(names: frozenset[str]) -> ReferenceRenderer:
        changed = replace(options, departures=options.departures | names)
        return ReferenceRenderer(reference.scene, changed, reference.plan)

    return Alternatives(found, renderer)


class PairedEffects:
    """Calling it with a set of names gives what they add to each region, (pairs, N, 3), one row for each pair of replicates.

    `render(renderer, replicate, samples)` does the work and may give None, and so does the call then; it does too once `seconds`
    (None: no limit) are spent, as told by `spent`.
    """

    def __init__(
        self,
        among: Alternatives,
        pairs: int,
        render: Callable[[Any, int, int], Rendering | None],
        spent: Callable[[], float],
        seconds: float | None,
    ) -> None:
        self._among, self._count = among, pairs
        self._render, self._spent, self._seconds = render, spent, seconds
        self._plain: list[np.ndarray] = []
        self.samples = 0

    def budget(self, samples: int, cost: float) -> None:
        """Settle the samples per pixel, once: `samples`, halved until the time suffices; a replicate of one takes `cost` seconds."""
        if self.samples:
            return
        self.samples = samples
        renderings = self._count * (len(self._among.departures) + 1)
        while self._seconds is not None and self.samples > 1:
            if renderings * self.samples * cost <= SINGLES_SHARE * self._seconds:
                return
            self.samples = (self.samples + 1) // 2

    def __call__(self, names: frozenset[str], regions: Regions, excluded: np.ndarray) -> np.ndarray | None:
        """The effects of `names` on `regions` without the pixels `excluded` (height, width)."""
        if self._seconds is not None and self._spent() > self._seconds:
            return None
        if not self._plain:
            plain = self._images(frozenset(), regions.shape)
            if plain is None:
                return None
            self._plain = plain
        changed = self._images(names, regions.shape)
        if changed is None:
            return None
        blank = RegionMoments(regions, Moments.empty((len(regions), 3)), excluded.ravel())
        pairs = zip(changed, self._plain, strict=True)
        return np.stack([blank.add(with_them - without).moments.mean for with_them, without in pairs])

    def _images(self, names: frozenset[str], shape: tuple[int, int]) -> list[np.ndarray] | None:
        renderer = self._among.renderer(names)
        images = []
        for k in range(self._count):
            rendering = self._render(renderer, FIRST + k, self.samples)
            if rendering is None:
                return None
            images.append(finite_or_nan(rendering, shape))
        return images
