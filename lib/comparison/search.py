# SPDX-License-Identifier: GPL-3.0-or-later
"""Attribution while sampling goes on."""

from __future__ import annotations

from collections.abc import Set

import numpy as np

from ..film.light_passes import LightPass
from ..film.regions import Regions
from ..verdict.attribution import PAIRS, Attribution
from ..verdict.causes import Explanation, nothing_found
from ..verdict.explain import explain
from ..verdict.outcome import Outcome
from ..verdict.sequential import SequentialTest
from .departures import Alternatives, PairedEffects
from .meter import Meter
from .sides import Side


class Search:
    """Attribution while sampling goes on.

    It computes the effects of departures when a region is found to differ. Its claims have a `share` of the error
    level, 1 - confidence.
    """

    def __init__(self, among: Alternatives, test: SequentialTest, meter: Meter, regions: Regions, share: float) -> None:
        level = share * (1 - test.confidence)
        self._attribution = Attribution(among.departures, test, level, lambda: regions.inside)
        self._effects = PairedEffects(
            among, meter.render_aside, lambda: meter.has_time_aside(self._last), meter.seconds_aside
        )
        self._test, self._meter = test, meter
        self._last = False

    @property
    def complete(self) -> bool:
        """Whether all that differs is explained, and the rest agrees."""
        return self._attribution.complete

    def look(
        self, sides: tuple[Side, Side], excluded: np.ndarray, last: bool, differing: Set[LightPass] = frozenset()
    ) -> bool:
        """Take one look; return whether more sampling may yet explain what differs.

        `differing` are the light passes that differ at this look.
        """
        film, regions = sides[0].film, sides[0].regions.regions
        self._last = last
        self._effects.budget(
            film.samples, PAIRS, film.seconds / max(film.camera_samples, 1) * regions.shape[0] * regions.shape[1]
        )
        moments = sides[0].regions, sides[1].regions
        self._attribution.look(
            *moments, lambda names, count: self._effects(names, count, regions, excluded), last, differing
        )
        differs = bool((self._test.outcomes == Outcome.DIFFERENT).any())
        return differs and not (self._attribution.complete or self._attribution.hopeless)

    def conclude(self, sides: tuple[Side, Side]) -> Explanation | None:
        """What was found; None where no region differs."""
        return explain(
            self._attribution, sides[0].regions, sides[1].regions, self._effects.samples, self._meter.spent_aside
        )


def conclude_causes(search: Search | None, test: SequentialTest, sides: tuple[Side, Side]) -> Explanation | None:
    """The known causes; None where no region differs.

    `search` is None where no departure applies to the scene.
    """
    if search is not None:
        return search.conclude(sides)
    if not (test.outcomes == Outcome.DIFFERENT).any():
        return None
    return nothing_found(len(test.outcomes))
