# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole comparison in one function: two renderers of one scene, their films, and the verdict on them."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Protocol

import numpy as np
import scipy

from .. import __version__
from .departures.effects import Alternatives, PairedEffects
from .errors import EtalonError
from .film.film import Film, finite_or_nan
from .film.regions import Coverage, RegionMoments, Regions, image_regions
from .film.rendering import Rendering
from .scene.scene import Scene
from .verdict.allocation import Cost, allocate, fit_cost, relative_noise
from .verdict.attribution import ATTRIBUTION_SHARE, PAIRS, Attribution, Explanation
from .verdict.outcome import Outcome
from .verdict.sequential import SequentialTest, next_look
from .verdict.verdict import Verdict, conclude

# Replicates of the pilot are numbered from here, so that the verdict's own start at 0 whatever the pilot needed.
PILOT = 1 << 20
# What the pilot may take of the time, for each side, and where it ends.
PILOT_SHARE = 0.02
PILOT_SAMPLES = 64
# What is set aside of the time to find out why regions differ, where there are departures to ask.
ASIDE_SHARE = 0.1


class Renderer(Protocol):
    """Either side: `settings` is what the report prints; `render` gives replicate number `replicate`, independent of all
    others, with `samples` per pixel. After `cancelled` says so it may return anything or raise an EtalonError.
    """

    name: str
    settings: dict[str, Any]

    def render(
        self, replicate: int, samples: int, progress: Callable[[float], None], cancelled: Callable[[], bool]
    ) -> Rendering:
        """One replicate."""


@dataclass(frozen=True)
class CompareOptions:
    """What the user asks of a comparison.

    tolerance: the relative difference that counts as none. confidence: the probability that no claim on any region is false.
    time: seconds for everything, None for no limit. samples: per pixel and replicate, for both sides or (reference,
    candidate); None: chosen by a pilot. replicates: the most on each side, None for no limit. seed: of the whole, for the record.
    Sampling ends when all is decided or at the first limit. Raises EtalonError for values out of range.
    """

    tolerance: float = 0.01
    confidence: float = 0.99
    time: float | None = 120.0
    samples: int | tuple[int, int] | None = None
    replicates: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        pair = self.samples if isinstance(self.samples, tuple) else (self.samples, self.samples)
        if not 0 < self.tolerance < 1:
            raise EtalonError(f"tolerance is {self.tolerance}; give a share between 0 and 1, 0.01 for 1 %")
        if not 0.5 <= self.confidence < 1:
            raise EtalonError(f"confidence is {self.confidence}; give at least 0.5 and less than 1")
        if self.time is not None and not self.time > 0:
            raise EtalonError(f"time is {self.time} s; give more than 0")
        if any(s is not None and s < 1 for s in pair):
            raise EtalonError(f"samples is {self.samples}; give at least 1")
        if self.replicates is not None and self.replicates < 1:
            raise EtalonError(f"replicates is {self.replicates}; give at least 2 to judge by, 8 or more to judge well")
        if self.time is None and (self.samples is None or self.replicates is None):
            raise EtalonError(
                "without a time limit nothing ends the comparison; give samples and replicates, or a time"
            )


@dataclass(frozen=True)
class Side:
    """One renderer's part: its `name` and `settings`, its film, and the moments of its regions."""

    name: str
    settings: dict[str, Any]
    film: Film
    regions: RegionMoments


@dataclass(frozen=True)
class Comparison:
    """All that came of a comparison of the scene named `scene`.

    `excluded` (height, width) marks pixels with non-finite samples on either side. `explanation` is there where regions differ
    and departures were tried. `stopped` is 'decided', 'time', 'replicates' or 'cancelled'. `seconds` counts everything,
    `pilot_seconds` the pilot alone; `started` is ISO 8601 in UTC.
    """

    scene: str
    options: CompareOptions
    reference: Side
    candidate: Side
    regions: Regions
    excluded: np.ndarray
    verdict: Verdict
    explanation: Explanation | None
    stopped: str
    started: str
    seconds: float
    pilot_seconds: float
    versions: dict[str, str]


def compare(
    scene: Scene,
    reference: Renderer,
    candidate: Renderer,
    coverage: Coverage,
    options: CompareOptions,
    progress: Callable[[float], None] = lambda fraction: None,
    cancelled: Callable[[], bool] = lambda: False,
    among: Alternatives | None = None,
) -> Comparison:
    """Render `scene` with both renderers in turns until every region is decided, or a limit of `options` is reached.

    `coverage` maps a kind of region ('material', 'object') to its (name, weights (height, width)) pairs. `progress` is told the
    share of the time (or of the replicates) that is spent. Cancelling keeps what both sides finished; EtalonError is raised if
    that is nothing, or if the renderers disagree on the size of the image. Where regions differ, the causes are
    sought `among` departures, in a fifth of the time that is set aside for it, and sampling goes on until they are found or ruled out.
    """
    started = datetime.now(UTC).isoformat(timespec="seconds")
    asked = among is not None and bool(among.departures)
    meter = _Meter(options, progress, cancelled, ASIDE_SHARE if asked else 0.0)
    samples = _both(options.samples) or _pilot(reference, candidate, options, meter)
    pilot_seconds = meter.elapsed
    regions = image_regions(scene.camera.height, scene.camera.width, coverage)
    del coverage  # as large as the regions made of it
    sides = tuple(_empty_side(r, regions, s) for r, s in zip((reference, candidate), samples, strict=True))
    excluded = np.zeros(regions.shape, bool)
    held_back = ATTRIBUTION_SHARE if asked else 0.0
    test = SequentialTest(len(regions), options.tolerance, options.confidence, held_back)
    search = _Search(among, test, meter) if asked else None
    stopped = ""
    while not stopped:
        for index, renderer in enumerate((reference, candidate)):
            rendering = meter.render(renderer, sides[index].film.moments.n, samples[index])
            if rendering is None:
                break
            excluded = excluded | np.isnan(finite_or_nan(rendering, regions.shape)[..., 0])
            sides = tuple(_exclude(side, excluded) for side in sides)
            sides = (*sides[:index], _add(sides[index], rendering), *sides[index + 1 :])
        n = sides[1].film.moments.n
        if n == 0:
            raise EtalonError(f"{scene.name}: cancelled before both sides had an image; there is nothing to compare")
        stopped = meter.why_stop(n)
        if stopped or n == next_look(n - 1):
            test.look(sides[0].regions.moments, sides[1].regions.moments, last=bool(stopped))
            open_ = test.undecided.any()
            if search is not None:
                open_ = search.look(sides, excluded, last=bool(stopped)) or (open_ and not search.complete)
            if not open_:
                stopped = stopped or "decided"
    nonfinite = {side.name: int((side.film.nonfinite > 0).sum()) for side in sides}
    explanation = None if search is None else search.conclude(sides)
    verdict = conclude(test, sides[0].regions, sides[1].regions, nonfinite, explanation)
    return Comparison(
        scene=scene.name,
        options=options,
        reference=sides[0],
        candidate=sides[1],
        regions=regions,
        excluded=excluded,
        verdict=verdict,
        explanation=explanation,
        stopped=stopped,
        started=started,
        seconds=meter.elapsed,
        pilot_seconds=pilot_seconds,
        versions=versions(),
    )


def _empty_side(renderer: Renderer, regions: Regions, samples: int) -> Side:
    film = Film.empty(*regions.shape, samples)
    return Side(renderer.name, dict(renderer.settings), film, RegionMoments.empty(regions))


def _exclude(side: Side, excluded: np.ndarray) -> Side:
    return Side(side.name, side.settings, side.film, side.regions.exclude(excluded, side.film.moments))


def _add(side: Side, rendering: Rendering) -> Side:
    return Side(side.name, side.settings, side.film.add(rendering), side.regions.add(rendering.radiance))


def _both(samples: int | tuple[int, int] | None) -> tuple[int, int] | None:
    return (samples, samples) if isinstance(samples, int) else samples


def versions() -> dict[str, str]:
    """What a report says about the software it was made with."""
    return {
        "etalon": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "system": platform.platform(),
    }


class _Search:
    """Attribution while sampling goes on: it asks for the effects of departures when a region is found to differ."""

    def __init__(self, among: Alternatives, test: SequentialTest, meter: _Meter) -> None:
        self._attribution = Attribution(among.departures, test, ATTRIBUTION_SHARE * (1 - test.confidence))
        self._effects = PairedEffects(among, meter.aside, lambda: meter.spent_aside, meter.seconds_aside)
        self._test, self._meter = test, meter

    @property
    def complete(self) -> bool:
        """Whether all that differs is explained, and the rest agrees."""
        return self._attribution.complete

    def look(self, sides: tuple[Side, Side], excluded: np.ndarray, last: bool) -> bool:
        """One look; whether more sampling may yet explain what differs."""
        film, regions = sides[0].film, sides[0].regions.regions
        self._effects.budget(film.samples, PAIRS, film.seconds / (film.moments.n * film.samples))
        moments = sides[0].regions, sides[1].regions
        self._attribution.look(*moments, lambda names, count: self._effects(names, count, regions, excluded), last)
        differs = bool((self._test.outcomes == Outcome.DIFFERENT).any())
        return differs and not (self._attribution.complete or self._attribution.hopeless)

    def conclude(self, sides: tuple[Side, Side]) -> Explanation | None:
        """What was found."""
        return self._attribution.conclude(
            sides[0].regions, sides[1].regions, self._effects.samples, self._meter.spent_aside
        )


class _Meter:
    """Time, limits and progress of one comparison."""

    def __init__(
        self, options: CompareOptions, progress: Callable[[float], None], cancelled: Callable[[], bool], aside: float
    ) -> None:
        self._start = time.monotonic()
        self.seconds_aside = None if options.time is None else aside * options.time
        self.spent_aside = 0.0
        self._options = options
        self._progress = progress
        self._cancelled = cancelled
        self._rendered = 0
        self._first = 0.0

    @property
    def elapsed(self) -> float:
        """Seconds since the comparison began."""
        return time.monotonic() - self._start

    def render(self, renderer: Renderer, replicate: int, samples: int) -> Rendering | None:
        """One replicate that counts towards the limits, or None if it was cancelled."""
        if not self._rendered:
            self._first = self.elapsed
        rendering = self.pilot(renderer, replicate, samples)
        self._rendered += rendering is not None
        return rendering

    def pilot(self, renderer: Renderer, replicate: int, samples: int) -> Rendering | None:
        """One replicate, or None if it was cancelled."""
        try:
            rendering = renderer.render(replicate, samples, self._report, self._cancelled)
        except EtalonError:
            if self._cancelled():
                return None
            raise
        # What a cancelled renderer hands over may be half an image.
        return None if self._cancelled() else rendering

    def aside(self, renderer: Renderer, replicate: int, samples: int) -> Rendering | None:
        """One replicate on the time set aside, or None if it was cancelled."""
        before = self.elapsed
        rendering = self.pilot(renderer, replicate, samples)
        self.spent_aside += self.elapsed - before
        return rendering

    def why_stop(self, replicates: int) -> str:
        """Why sampling ends with `replicates` on both sides, or '' if it goes on; never depends on what was rendered."""
        if self._cancelled():
            return "cancelled"
        if self._options.replicates is not None and replicates >= self._options.replicates:
            return "replicates"
        if self._options.time is not None and replicates >= 2:
            # What is set aside counts as spent from the start: how much of it is used depends on what was rendered.
            sampling = self.elapsed - self.spent_aside
            another = (sampling - self._first) / replicates
            if sampling + another > self._options.time - self.seconds_aside:
                return "time"
        return ""

    def _report(self, fraction: float) -> None:
        spent = self.elapsed / self._options.time if self._options.time else 0.0
        done = (self._rendered + fraction) / (2 * self._options.replicates) if self._options.replicates else 0.0
        self._progress(min(max(spent, done), 1.0))


def _pilot(reference: Renderer, candidate: Renderer, options: CompareOptions, meter: _Meter) -> tuple[int, int]:
    """Samples per replicate for both sides, from what they cost and how noisy they are; 1 each where it is cancelled."""
    measured = [_measure(r, PILOT_SHARE * options.time, meter) for r in (reference, candidate)]
    if None in measured:
        return 1, 1
    costs, noises = zip(*measured, strict=True)
    return allocate(options.time - meter.elapsed, costs, noises)


def _measure(renderer: Renderer, share: float, meter: _Meter) -> tuple[Cost, float] | None:
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
    means = [RegionMoments.empty(grid).add(np.nan_to_num(r.radiance)).moments.mean for r in (rendering, again)]
    return fit_cost(samples, seconds), relative_noise(*means, samples[-1])
