# SPDX-License-Identifier: GPL-3.0-or-later
"""Rounds of renders: the neutral state and every setting, each round from random numbers of its own that all of them share.

The same random numbers on both sides make most differences nearly free of noise, and turns within a round make what slows the machine
for a while slow both sides. How many rounds there are depends on time alone, never on what was rendered.
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
    """Render the `neutral` state and each of the `candidates` in rounds, and compare them pair by pair.

    There are rounds for `options.time` seconds, and at most `options.replicates`.
    A renderer must draw the same random numbers for the same replicate, whatever its setting. Samples a pixel are
    `options.samples`, or what the time allows, at most the `asked`. Cancelling keeps the rounds that are complete; raises EtalonError
    where there is none.
    """
    started = datetime.now(UTC).isoformat(timespec="seconds")
    run = TimedRun(options.time, progress)
    seconds_neutral: list[float] = []
    image = np.zeros((0, 0, 3))
    bad = np.zeros((0, 0), bool)
    regions, series, samples, rounds = None, [], options.samples or 0, 0
    stopped = None if candidates else Stop.NOTHING
    try:
        if candidates:
            cost, shape = _first_calls(run, [neutral, *(renderer for _, renderer in candidates)])
            samples = samples or _samples(options.time - run.elapsed, cost, asked)
            missing += tuple(_too_few(setting, samples, cost) for setting, _ in candidates if setting.needs > samples)
            candidates = [candidate for candidate in candidates if candidate[0].needs <= samples]
            series = [Series() for _ in candidates]
            regions = image_regions(*shape, {}, _block(*shape))
            image, bad = np.zeros((*shape, 3)), np.zeros(shape, bool)
            renderers = [neutral, *(renderer for _, renderer in candidates)]
            stopped = None if candidates else Stop.NOTHING
        while stopped is None:
            begin = run.elapsed
            got: list[Rendering | None] = [None] * len(renderers)
            for index in _turns(rounds, len(renderers)):
                rendering = run.render(renderers[index], COUNTED.number(rounds), samples)[0]
                # Cycles' own precision: a round holds an image of every setting.
                got[index] = replace(rendering, radiance=rendering.radiance.astype(np.float32))
            plain = got[0]
            finite = np.isfinite(plain.radiance).all(axis=2)
            image = image + (np.where(finite[..., None], plain.radiance, 0.0) - image) / (rounds + 1)
            bad |= ~finite
            seconds_neutral.append(plain.seconds)
            for entry, rendering in zip(series, got[1:], strict=True):
                bad |= entry.add(regions, plain.radiance, rendering)
            rounds += 1
            if options.replicates is not None and rounds >= options.replicates:
                stopped = Stop.REPLICATES
            elif run.elapsed + (run.elapsed - begin) > options.time:
                stopped = Stop.TIME
    except Cancelled:
        stopped = Stop.CANCELLED
        if not rounds:
            raise EtalonError(f"{scene}: cancelled before the first round was done; there is nothing to tell") from None
    floor = FLOOR_SHARE * float(np.abs(image).mean()) if rounds else 0.0
    settings = [setting for setting, _ in candidates]
    return Audit(
        scene=scene,
        options=options,
        findings=judge(settings, series, np.array(seconds_neutral), options, floor, image, bad),
        same=same,
        missing=missing,
        regions=regions,
        neutral=image,
        floor=floor,
        rounds=rounds,
        samples=samples,
        asked=asked,
        nonfinite=int(bad.sum()),
        seconds_neutral=float(np.mean(seconds_neutral)) if rounds else 0.0,
        stopped=stopped,
        started=started,
        seconds=run.elapsed,
        settings=dict(neutral.settings),
        versions=versions(),
    )


def _first_calls(run: TimedRun, renderers: list[Renderer]) -> tuple[Cost, tuple[int, int]]:
    """The first call of every renderer, which also sets things up; the cost of a round, and the image's height and width."""
    few, more = FIRST_SAMPLES
    rendering, _ = run.render(renderers[0], FIRST_CALLS.number(0), few)
    calls = [run.render(renderer, FIRST_CALLS.number(1), few)[1] for renderer in renderers]
    _, longer = run.render(renderers[0], FIRST_CALLS.number(1), more)
    one = fit_cost([few, more], [calls[0], longer])
    fixed = max(sum(calls) - len(calls) * few * one.per_sample, 0.0)
    return Cost(fixed, len(calls) * one.per_sample), rendering.radiance.shape[:2]


def _samples(seconds: float, cost: Cost, asked: int) -> int:
    """Samples a pixel for ROUNDS rounds in `seconds`, or for no fewer than FEWEST while calls cost more than their samples.

    A power of two, at which low-discrepancy sequences are best.
    """
    many, few = ((seconds / rounds - cost.fixed) / cost.per_sample for rounds in (ROUNDS, FEWEST))
    wanted = max(many, min(few, cost.fixed / cost.per_sample), 1.0)
    return 1 << int(np.log2(min(wanted, max(min(asked, MOST_SAMPLES), 1))))


def _too_few(setting: Setting, samples: int, cost: Cost) -> Setting:
    """A setting that so few samples cannot measure, with what it would take."""
    enough = 1 << (setting.needs - 1).bit_length()
    time_ = format_duration(ROUNDS * cost.seconds(enough))
    few = f"it takes {setting.needs} samples a pixel, and these were {samples}"
    return replace(setting, missing=f"{few}; give --samples {enough} and --time for about {time_}")


def _block(height: int, width: int) -> int:
    """The edge of blocks, a multiple of GRAIN, of which about BLOCKS fill the image."""
    return GRAIN * max(int(np.ceil(np.sqrt(height * width / BLOCKS) / GRAIN)), 1)


def _turns(number: int, count: int) -> list[int]:
    """The order of one round: every other one backwards, and then another one first, so that nobody has a place of its own."""
    order = [(number // 2 + k) % count for k in range(count)]
    return order[::-1] if number % 2 else order
