# SPDX-License-Identifier: GPL-3.0-or-later
"""Error and seconds of many ways to render one scene.

They are measured side by side within a budget.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from datetime import UTC, datetime

import numpy as np

from ..comparison.compare import Renderer, versions
from ..comparison.run import Stop, TimedRun
from ..errors import Cancelled, EtalonError
from ..film.film import finite_or_nan
from ..film.rendering import Rendering
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import COUNTED, FIRST_CALLS, TRUTH
from .ways import Way
from .yardstick import Score, Yardstick

PAIRS = 4
# Of the budget, for the truth.
TRUTH_SHARE = 0.3
# Of the budget, for building renderers and calling them once.
FIRST_SHARE = 0.35
LEVEL_FACTOR = 4
MOST_SAMPLES = 4096


@dataclass(frozen=True)
class Point:
    """One way at `samples` per pixel.

    It has for each pair of replicates its score, and for each replicate the seconds of rendering alone and of the whole
    call (`wall`).
    """

    samples: int
    scores: tuple[Score, ...]
    seconds: np.ndarray
    wall: np.ndarray

    def column(self, name: str) -> np.ndarray:
        """One field of the scores, a value a pair."""
        return np.array([getattr(score, name) for score in self.scores])

    @property
    def pair_seconds(self) -> np.ndarray:
        """Mean seconds of rendering alone in each pair."""
        return self.seconds.reshape(-1, 2).mean(axis=1)


@dataclass
class Measured:
    """All that was measured of one way.

    `setup` are the seconds from the command's start to its second render call, less that of rendering: opening, export,
    building, and what the first call takes longer. `missing` says why there is no point, or ''.
    """

    way: Way
    settings: dict[str, object] = field(default_factory=dict)
    setup: float = 0.0
    points: list[Point] = field(default_factory=list)
    stages: dict[str, float] = field(default_factory=dict)
    camera_samples: int = 0
    nonfinite: int = 0
    missing: str = ""


@dataclass(frozen=True)
class Truth:
    """The long render that all ways are measured against.

    It has the relative squared error that is left in it.
    """

    way: str
    samples: int
    replicates: int
    seconds: float
    relmse: float
    excluded_pixels: int


@dataclass(frozen=True)
class Measurement:
    """All ways of one scene in one run; `stopped` says why it ended."""

    scene: str
    size: tuple[int, int]
    ways: list[Measured]
    truth: Truth
    yardstick: Yardstick
    pairs: int
    stopped: Stop
    started: str
    seconds: float
    budget: float
    versions: dict[str, str]

    def __getitem__(self, key: str) -> Measured:
        return next(m for m in self.ways if m.way.key == key)

    def has(self, key: str) -> bool:
        """Whether the way of that key was measured."""
        return any(m.way.key == key and m.points for m in self.ways)


@dataclass(eq=False)
class _Entry:
    """A way whose renderer stands, and the seconds of all its replicates at the latest level."""

    measured: Measured
    renderer: Renderer
    latest: float = 0.0


def measure(
    scene: str,
    ways: list[Way],
    best: str,
    budget: float,
    pairs: int = PAIRS,
    most_samples: int = MOST_SAMPLES,
    first: tuple[str, ...] = (),
    truth_share: float = TRUTH_SHARE,
    progress: Progress = NO_PROGRESS,
) -> Measurement:
    """Measure `ways` of the scene named `scene` within `budget` seconds.

    The way `best` is the truth for all. At 1, 4, 16 ... samples a pixel as many ways as the time that is left still
    allows, `first` and then the quick ones, render `pairs` pairs of replicates, all in turns, so that a machine that
    changes its pace does so for all. The best way gets its first level whatever it takes; ways that cannot begin
    before the budget is spent say so in `missing`. Cancelling keeps the levels that are done. `truth_share` of the
    budget goes into the truth.
    """
    if pairs < 2:
        raise EtalonError(f"pairs is {pairs}; give at least 2, for an interval")
    started = datetime.now(UTC).isoformat(timespec="seconds")
    run = TimedRun(budget, progress)
    stopped = Stop.SAMPLES
    measured = [Measured(way) for way in ways]
    try:
        entries = _first_calls(run, FIRST_SHARE * budget, measured, (best, *first))
        leader = next(e for e in entries if e.measured.way.key == best)
        truth, yardstick = _truth(run, leader, pairs, truth_share * budget)
        if _levels(run, entries, (best, *first), yardstick, pairs, most_samples):
            stopped = Stop.TIME
    except Cancelled:
        if not any(m.points for m in measured):
            raise Cancelled(f"{scene}: cancelled before anything was measured; nothing was written") from None
        stopped = Stop.CANCELLED
    height, width = yardstick.excluded.shape
    return Measurement(
        scene, (width, height), measured, truth, yardstick, pairs, stopped, started, run.elapsed, budget, versions()
    )


def _first_calls(run: TimedRun, limit: float, measured: list[Measured], first: tuple[str, ...]) -> list[_Entry]:
    """Build every renderer and call it once.

    What this call takes longer than later ones belongs to the setup. The first renderer is built in any case, the
    others within `limit` seconds from the start of the run.
    """
    entries = []
    for m in sorted(measured, key=lambda m: (m.way.key != first[0], m.way.key not in first)):
        if entries and run.elapsed > limit:
            m.missing = "no time left to begin with it"
            continue
        start = time.monotonic()
        try:
            renderer = m.way.make()
        except EtalonError as error:
            if m.way.key == first[0]:
                raise
            m.missing = str(error)
            continue
        built = time.monotonic() - start
        _, wall = run.render(renderer, FIRST_CALLS.number(0), 1)
        m.settings = dict(renderer.settings)
        m.setup = m.way.opening + built + wall
        entries.append(_Entry(m, renderer))
    order = [m.way.key for m in measured]
    return sorted(entries, key=lambda e: order.index(e.measured.way.key))


def _truth(run: TimedRun, leader: _Entry, pairs: int, seconds: float) -> tuple[Truth, Yardstick]:
    """Two long renders a pair, of as many samples as `seconds` allow."""
    begin = run.elapsed
    _, again = run.render(leader.renderer, FIRST_CALLS.number(1), LEVEL_FACTOR)
    per_sample = max(again / LEVEL_FACTOR, 1e-9)
    samples = max(seconds / (2 * pairs * per_sample), LEVEL_FACTOR)
    samples = min(2 ** int(math.log2(samples)), MOST_SAMPLES)
    images = []
    for k in range(2 * pairs):
        rendering, _ = run.render(leader.renderer, TRUTH.number(k), samples)
        images.append(finite_or_nan(rendering, rendering.nonfinite.shape))
    yardstick = Yardstick(images)
    way, excluded = leader.measured.way.label, int(yardstick.excluded.sum())
    return Truth(way, samples, 2 * pairs, run.elapsed - begin, yardstick.noise, excluded), yardstick


@dataclass
class _Level:
    """One way's replicates at one number of samples."""

    scores: list[Score] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)
    stages: dict[str, float] = field(default_factory=dict)
    camera_samples: int = 0

    def add(self, rendering: Rendering, wall: float) -> None:
        """One replicate's clocks."""
        self.seconds.append(rendering.seconds)
        self.wall.append(wall)
        self.camera_samples += rendering.camera_samples
        for stage, seconds in rendering.stages.items():
            self.stages[stage] = self.stages.get(stage, 0.0) + seconds


def _levels(
    run: TimedRun, entries: list[_Entry], first: tuple[str, ...], yardstick: Yardstick, pairs: int, most_samples: int
) -> bool:
    """Go through the levels; whether time, and not `most_samples`, ended it."""
    alive, samples, replicate = sorted(entries, key=lambda e: e.measured.way.key not in first), 1, 0
    while alive and samples <= most_samples:
        levels = [_Level() for _ in alive]
        for pair in range(pairs):
            for entry, level in zip(alive, levels, strict=True):
                begun = entry.measured.points or level.scores or entry.measured.way.key == first[0]
                if not begun and run.left < 0.0:
                    entry.measured.missing = "no time left for one sample a pixel"
                if not entry.measured.missing:
                    _pair(run, entry, yardstick, samples, replicate + 2 * pair, pair, level)
        for entry, level in zip(alive, levels, strict=True):
            if level.scores:
                _finish(entry, samples, level)
        alive = _affordable(alive, run.left, first)
        samples, replicate = LEVEL_FACTOR * samples, replicate + 2 * pairs
    return samples <= most_samples


def _affordable(entries: list[_Entry], left: float, first: tuple[str, ...]) -> list[_Entry]:
    """The entries whose next level fits into the seconds `left`.

    The keys `first` come first, then the quick ones.
    """
    chosen: list[_Entry] = []
    ready = [e for e in entries if e.measured.points]
    for entry in sorted(ready, key=lambda e: (e.measured.way.key not in first, e.latest)):
        left -= LEVEL_FACTOR * entry.latest
        if left < 0.0:
            break
        chosen.append(entry)
    return chosen


def _pair(
    run: TimedRun, entry: _Entry, yardstick: Yardstick, samples: int, replicate: int, pair: int, level: _Level
) -> None:
    images = []
    for k in range(2):
        rendering, wall = run.render(entry.renderer, COUNTED.number(replicate + k), samples)
        images.append(finite_or_nan(rendering, yardstick.excluded.shape))
        entry.measured.nonfinite += int(rendering.nonfinite.sum())
        level.add(rendering, wall)
    level.scores.append(yardstick.score(images[0], images[1], pair))


def _finish(entry: _Entry, samples: int, level: _Level) -> None:
    """Keep a level; stages are those of the last one, which says most."""
    m = entry.measured
    if not m.points:
        m.setup = max(m.setup - float(np.median(level.wall)), m.way.opening)
    m.points.append(Point(samples, tuple(level.scores), np.array(level.seconds), np.array(level.wall)))
    m.stages, m.camera_samples = level.stages, level.camera_samples
    entry.latest = sum(level.wall)
