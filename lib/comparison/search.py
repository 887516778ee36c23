# SPDX-License-Identifier: GPL-3.0-or-later
"""Attribution while sampling goes on."""

from __future__ import annotations

import numpy as np

from ..departures.effects import Alternatives, PairedEffects
from ..verdict.attribution import ATTRIBUTION_SHARE, PAIRS, Attribution, Explanation
from ..verdict.outcome import Outcome
from ..verdict.sequential import SequentialTest
from .meter import Meter
from .sides import Side


class Search:
    """Attribution while sampling goes on: it asks for the effects of departures when a region is found to differ."""

    def __init__(self, among: Alternatives, test: SequentialTest, meter: Meter) -> None:
        self._attribution = Attribution(among.departures, test, ATTRIBUTION_SHARE * (1 - test.confidence))
        self._effects = PairedEffects(among, meter.render_aside, lambda: meter.spent_aside, meter.seconds_aside)
        self._test, self._meter = test, meter

    @property
    def complete(self) -> bool:
        """Whether all that differs is explained, and the rest agrees."""
        return self._attribution.complete

    def look(self, sides: tuple[Side, Side], excluded: np.ndarray, last: bool) -> bool:
        """One look; whether more sampling may yet explain what differs."""
        film, regions = sides[0].film, sides[0].regions.regions
        self._effects.budget(
            film.samples, PAIRS, film.seconds / max(film.camera_samples, 1) * regions.shape[0] * regions.shape[1]
        )
        moments = sides[0].regions, sides[1].regions
        self._attribution.look(*moments, lambda names, count: self._effects(names, count, regions, excluded), last)
        differs = bool((self._test.outcomes == Outcome.DIFFERENT).any())
        return differs and not (self._attribution.complete or self._attribution.hopeless)

    def conclude(self, sides: tuple[Side, Side]) -> Explanation | None:
        """What was found."""
        return self._attribution.conclude(
            sides[0].regions, sides[1].regions, self._effects.samples, self._meter.spent_aside
        )
