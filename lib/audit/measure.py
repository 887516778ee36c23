# SPDX-License-Identifier: GPL-3.0-or-later
"""Rounds of renders of the neutral state and every setting.

Each round has random numbers of its own that all of them share. The same random numbers on both sides make most
differences nearly free of noise, and turns within a round make what slows the machine for a while slow both sides. How
many rounds there are depends on time alone, never on what was rendered.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from ..comparison.compare import CompareOptions, Renderer, versions
from ..comparison.run import Stop, TimedRun
from ..errors import Cancelled, EtalonError
from ..film.regions import image_regions
from ..film.rendering import Rendering
from ..pages.formats import format_duration
from ..plural import plural
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import COUNTED, FIRST_CALLS
from ..verdict.allocation import Cost, fit_cost
from ..verdict.claims import FLOOR_SHARE
from .findings import Audit, Series, judge
from .setting import Setting

# Rounds that are aimed at: quantiles of t far out in the tail need degrees of freedom.
ROUNDS, FEWEST = 16, 8
# Cycles adds samples up in float32, which drifts beyond this many.
MOST_SAMPLES = 4096
# Blocks that are aimed at: many small ones find a small place, few large ones are decided soon.
BLOCKS = 64
GRAIN = 16
FIRST_SAMPLES = (1, 8)


def audit(
    scene: str,
    neutral: Renderer,
    candidates: list[tuple[Setting, Renderer]],
    options: CompareOptions,
    asked: int,
    same: tuple[Setting, ...] = (),
    missing: tuple[Setting, ...] = (),
    progress: Progress = NO_PROGRESS,
) -> Audit:
    """Render the `neutral` state and each of the `candidates` in rounds.

    They are compared pair by pair. There are rounds for `options.time` seconds, and at most `options.replicates`. A
    renderer must draw the same random numbers for the same replicate, whatever its setting. Samples a pixel are
    `options.samples`, or what the time allows, at most the `asked`. Cancelling keeps the rounds that are complete;
    raises EtalonError where there are none, or where `options.samples` are two numbers.
    """
    rounds = _Rounds(scene, neutral, candidates, options, TimedRun(options.time, progress))
    stopped = None if candidates else Stop.NOTHING
    try:
        stopped = stopped or rounds.prepare(asked)
        while stopped is None:
            stopped = rounds.render_round()
    except Cancelled:
        rounds.refuse_if_empty()
        stopped = Stop.CANCELLED
    return rounds.conclude(stopped, asked, same, missing)


class _Rounds:
    """The rounds of one audit under way."""

    def __init__(
        self,
        scene: str,
        neutral: Renderer,
        candidates: list[tuple[Setting, Renderer]],
        options: CompareOptions,
        run: TimedRun,
    ) -> None:
        self._started = datetime.now(UTC).isoformat(timespec="seconds")
        self._scene, self._neutral, self._candidates = scene, neutral, candidates
        self._options, self._run = options, run
        if isinstance(options.samples, tuple):
            raise EtalonError("samples: an audit renders all settings with the same samples per pixel; give one number")
        self._samples, self._count = options.samples or 0, 0
        self._too_few: tuple[Setting, ...] = ()
        self._boxes = np.zeros((0, 4), int)
        self._series: list[Series] = []
        self._seconds_neutral: list[float] = []
        self._image = np.zeros((0, 0, 3))
        self._bad = np.zeros((0, 0), bool)

    def prepare(self, asked: int) -> Stop | None:
        """Call every renderer once, and settle the samples.

        Settings that so few samples cannot show are set aside. Returns the reason to stop, or None.
        """
        cost, shape = _first_calls(self._run, [self._neutral, *(renderer for _, renderer in self._candidates)])
        self._samples = n = self._samples or choose_samples(self._run.left, cost, asked)
        self._too_few = tuple(_too_few(setting, n, cost) for setting, _ in self._candidates if setting.needs > n)
        self._candidates = [candidate for candidate in self._candidates if candidate[0].needs <= n]
        regions = image_regions(*shape, {}, (block_edge(*shape),))
        self._boxes = regions.boxes
        self._series = [Series(regions) for _ in self._candidates]
        self._image, self._bad = np.zeros((*shape, 3)), np.zeros(shape, bool)
        return None if self._candidates else Stop.NOTHING

    def render_round(self) -> Stop | None:
        """Render one image of the neutral state and one of each setting, in turns.

        All use the same random numbers. Returns the reason to stop, or None.
        """
        begin = self._run.elapsed
        renderers = [self._neutral, *(renderer for _, renderer in self._candidates)]
        got: dict[int, Rendering] = {}
        for index in take_turns(self._count, len(renderers)):
            rendering, _ = self._run.render(renderers[index], COUNTED.number(self._count), self._samples)
            # Cycles' own precision: a round holds an image of every setting.
            got[index] = replace(rendering, radiance=rendering.radiance.astype(np.float32))
        plain = got[0]
        finite = np.isfinite(plain.radiance).all(axis=2)
        self._count += 1
        self._image = self._image + (np.where(finite[..., None], plain.radiance, 0.0) - self._image) / self._count
        self._bad |= ~finite
        self._seconds_neutral.append(plain.seconds)
        for index, entry in enumerate(self._series, start=1):
            self._bad |= entry.add(plain.radiance, got[index])
        if self._options.replicates is not None and self._count >= self._options.replicates:
            return Stop.REPLICATES
        return Stop.TIME if self._run.left < self._run.elapsed - begin else None

    def refuse_if_empty(self) -> None:
        """Raise EtalonError where no round is complete."""
        if not self._count:
            raise EtalonError(f"{self._scene}: cancelled before the first round was done; there is nothing to tell")

    def conclude(self, stopped: Stop, asked: int, same: tuple[Setting, ...], missing: tuple[Setting, ...]) -> Audit:
        """What the rounds say of each setting."""
        seconds, count = np.array(self._seconds_neutral), self._count
        floor = FLOOR_SHARE * float(np.abs(self._image).mean()) if count else 0.0
        settings = [setting for setting, _ in self._candidates]
        return Audit(
            scene=self._scene,
            options=self._options,
            findings=judge(settings, self._series, seconds, self._options, floor, self._image, self._bad),
            same=same,
            missing=missing + self._too_few,
            boxes=self._boxes,
            neutral=self._image,
            floor=floor,
            rounds=count,
            samples=self._samples,
            asked=asked,
            nonfinite=int(self._bad.sum()),
            seconds_neutral=float(seconds.mean()) if count else 0.0,
            stopped=stopped,
            started=self._started,
            seconds=self._run.elapsed,
            settings=dict(self._neutral.settings),
            versions=versions(),
        )


def _first_calls(run: TimedRun, renderers: list[Renderer]) -> tuple[Cost, tuple[int, int]]:
    """Make the first call of every renderer, which also sets things up.

    Returns the cost of a round, and the image's height and width.
    """
    few, more = FIRST_SAMPLES
    rendering, _ = run.render(renderers[0], FIRST_CALLS.number(0), few)
    calls = [run.render(renderer, FIRST_CALLS.number(1), few)[1] for renderer in renderers]
    _, longer = run.render(renderers[0], FIRST_CALLS.number(1), more)
    one = fit_cost([few, more], [calls[0], longer])
    fixed = max(sum(calls) - len(calls) * few * one.per_sample, 0.0)
    return Cost(fixed, len(calls) * one.per_sample), rendering.radiance.shape[:2]


def choose_samples(seconds: float, cost: Cost, asked: int) -> int:
    """Samples a pixel for ROUNDS rounds in `seconds`.

    The rounds may be fewer, but not below FEWEST, while calls cost more than their samples. It is a power of two, at
    which low-discrepancy sequences are best.
    """
    many, few = ((seconds / rounds - cost.fixed) / cost.per_sample for rounds in (ROUNDS, FEWEST))
    wanted = max(many, min(few, cost.fixed / cost.per_sample), 1.0)
    return 1 << int(np.log2(min(wanted, max(min(asked, MOST_SAMPLES), 1))))


def _too_few(setting: Setting, samples: int, cost: Cost) -> Setting:
    """A setting that so few samples cannot measure, with what it would take."""
    enough = 1 << (setting.needs - 1).bit_length()
    time_ = format_duration(ROUNDS * cost.seconds(enough))
    few = f"it takes {plural(setting.needs, 'sample')} per pixel, and these were {samples}"
    return replace(setting, missing=f"{few}; give --samples {enough} and --time for about {time_}")


def block_edge(height: int, width: int) -> int:
    """The edge of blocks, a multiple of GRAIN, of which about BLOCKS fill the image."""
    return GRAIN * max(int(np.ceil(np.sqrt(height * width / BLOCKS) / GRAIN)), 1)


def take_turns(number: int, count: int) -> list[int]:
    """The order of one round.

    Every other one is backwards, and then another one is first, so that nobody has a place of its own.
    """
    order = [(number // 2 + k) % count for k in range(count)]
    return order[::-1] if number % 2 else order
