# SPDX-License-Identifier: GPL-3.0-or-later
"""Rounds of renders of every version and the reference.

Each round has random numbers of its own that all versions share. Common random numbers make most differences between
versions nearly free of noise. They do not make the two sides independent, nor need they: claims.py and audit/paired.py
judge one series of differences a round. How many rounds there are depends on time alone, never on what was rendered.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..audit.findings import SQUARES
from ..audit.measure import FIRST_SAMPLES, MOST_SAMPLES, block_edge, choose_samples, take_turns
from ..audit.paired import CHANNELS
from ..comparison.run import Stop, TimedRun
from ..comparison.sides import Renderer
from ..errors import Cancelled, EtalonError
from ..film.moments import Moments, merge
from ..film.parts import Part
from ..film.regions import Coverage, Regions, image_regions
from ..film.rendering import Rendering
from ..report.page import averaged
from ..sampling.streams import COUNTED, FIRST_CALLS
from ..settings.comparison import CompareOptions
from ..verdict.allocation import Cost, fit_cost

IMAGE = "image"
"""The name of the whole light beside those of the light passes."""


@dataclass(frozen=True)
class Contestant:
    """One version: its label, its Cycles, and the reference on its own export of the scene.

    `model` is the reference with all departures that this version is known to have, None where it has none that
    another one lacks. Contestants whose scenes are the same have one reference, and may have one model.
    """

    label: str
    cycles: Renderer
    reference: Renderer
    model: Renderer | None = None


@dataclass
class Series:
    """The means of the regions in each round: of every kind of light, (rounds, k, 3)."""

    values: dict[Part | str, list[np.ndarray]] = field(default_factory=dict)

    def add(self, name: Part | str, means: np.ndarray) -> None:
        """Take one round more."""
        self.values.setdefault(name, []).append(means)

    def of(self, name: Part | str) -> np.ndarray:
        """All rounds of one kind of light."""
        return np.stack(self.values[name])


@dataclass(frozen=True)
class Rounds:
    """All that the rounds leave.

    `cycles`, `references` and `models` have a Series for each contestant, a model None where there is none. `squares` are the moments of the
    pixels' differences, of squares of SQUARES pixels, for each pair of contestants. `images` (height, width, 3) are the means of Cycles'
    images, `bad` (height, width) the pixels with samples that were not finite.
    """

    regions: Regions
    pairs: tuple[tuple[int, int], ...]
    cycles: tuple[Series, ...]
    references: tuple[Series, ...]
    models: tuple[Series | None, ...]
    squares: tuple[list[Moments], ...]
    images: tuple[np.ndarray, ...]
    passes: tuple[Part, ...]
    bad: np.ndarray
    count: int
    samples: int
    stopped: Stop
    seconds: float


def pairs_of(count: int) -> tuple[tuple[int, int], ...]:
    """The pairs of versions that are compared.

    Each is compared with the next, and of more than two the first with the last.
    """
    return tuple((k, k + 1) for k in range(count - 1)) + (((0, count - 1),) if count > 2 else ())


def render_rounds(
    scene: str,
    contestants: Sequence[Contestant],
    coverage: Coverage,
    passes: Sequence[Part],
    options: CompareOptions,
    run: TimedRun,
) -> Rounds:
    """Render all contestants in rounds until the limits of `options` are reached.

    They are the time and the replicates. `coverage` names regions beside the image and its blocks. Cancelling keeps the
    rounds that are complete; raises EtalonError where there are none.
    """
    rounds = _Rounds(contestants, tuple(passes), options, run)
    try:
        rounds.prepare(coverage)
        stopped = None
        while stopped is None:
            stopped = rounds.render_round()
    except Cancelled:
        stopped = Stop.CANCELLED
    if not rounds.count:
        raise EtalonError(f"{scene}: cancelled before the first round was done; there is nothing to tell")
    return rounds.conclude(stopped)


class _Rounds:
    """The rounds of one scene under way."""

    def __init__(
        self, contestants: Sequence[Contestant], passes: tuple[Part, ...], options: CompareOptions, run: TimedRun
    ) -> None:
        self._options, self._run, self._passes = options, run, passes
        everything = [
            renderer for c in contestants for renderer in (c.cycles, c.reference, c.model) if renderer is not None
        ]
        # Each renderer once, however many contestants share it.
        self._renderers = list({id(renderer): renderer for renderer in everything}.values())
        self._series = {id(renderer): Series() for renderer in self._renderers}
        self._contestants = tuple(contestants)
        self._pairs = pairs_of(len(contestants))
        self._squares: list[list[Moments]] = [[] for _ in self._pairs]
        self.count, self._samples = 0, options.samples if isinstance(options.samples, int) else 0

    def prepare(self, coverage: Coverage) -> None:
        """Call every renderer, settle the samples, and lay out the regions."""
        few, more = FIRST_SAMPLES
        fixed = per_sample = 0.0
        for renderer in self._renderers:
            first, _ = self._run.render(renderer, FIRST_CALLS.number(0), few)  # sets things up
            seconds = [self._run.render(renderer, FIRST_CALLS.number(1), samples)[1] for samples in (few, more)]
            cost = fit_cost([few, more], seconds)
            fixed, per_sample = fixed + cost.fixed, per_sample + cost.per_sample
        self._samples = self._samples or choose_samples(self._run.left, Cost(fixed, per_sample), MOST_SAMPLES)
        height, width = first.radiance.shape[:2]
        self._regions = image_regions(height, width, coverage, (block_edge(height, width),))
        self._bad = np.zeros((height, width), bool)
        self._images = [np.zeros((height, width, CHANNELS)) for _ in self._contestants]

    def render_round(self) -> Stop | None:
        """Render one image with every renderer, in turns, from the same random numbers.

        Returns the reason to stop, or None.
        """
        begin = self._run.elapsed
        got: dict[int, Rendering] = {}
        for index in take_turns(self.count, len(self._renderers)):
            renderer = self._renderers[index]
            rendering, _ = self._run.render(renderer, COUNTED.number(self.count), self._samples)
            # Cycles' own precision: a round holds an image of every renderer.
            got[id(renderer)] = replace(rendering, radiance=rendering.radiance.astype(np.float32))
        used = np.all([np.isfinite(one.radiance).all(axis=2) for one in got.values()], axis=0)
        self._bad |= ~used
        self.count += 1
        self._take(got, used)
        if self._options.replicates is not None and self.count >= self._options.replicates:
            return Stop.REPLICATES
        return Stop.TIME if self._run.left < self._run.elapsed - begin else None

    def _take(self, got: dict[int, Rendering], used: np.ndarray) -> None:
        """Keep what a round says; pixels that are not `used` (height, width) count on no side."""
        images = {key: np.where(used[..., None], one.radiance, np.float32(0.0)) for key, one in got.items()}
        sizes = self._regions.weights @ used.ravel().astype(float)
        share = np.where(sizes > 0, sizes, np.nan)[:, None]
        named = len(self._regions.named)
        for key, one in got.items():
            self._series[key].add(IMAGE, (self._regions.weights @ images[key].reshape(-1, CHANNELS)) / share)
            for name in self._passes:
                light = np.where(used[..., None], one.passes[name], 0.0).reshape(-1, CHANNELS)
                self._series[key].add(name, (self._regions.weights[:named] @ light) / share[:named])
        of_cycles = [images[id(one.cycles)] for one in self._contestants]
        for k, image in enumerate(of_cycles):
            self._images[k] += (image - self._images[k]) / self.count
        for k, (first, second) in enumerate(self._pairs):
            gap = (of_cycles[second] - of_cycles[first]).mean(axis=2, keepdims=True, dtype=float)
            once = [averaged(gap, step)[..., 0] for step in SQUARES]
            seen = [Moments(1, mean, np.zeros(mean.shape)) for mean in once]
            before = self._squares[k]
            self._squares[k] = [merge(*pair) for pair in zip(before, seen, strict=True)] if before else seen

    def conclude(self, stopped: Stop) -> Rounds:
        """What the rounds leave."""

        def series(renderer: Renderer) -> Series:
            return self._series[id(renderer)]

        return Rounds(
            regions=self._regions,
            pairs=self._pairs,
            cycles=tuple(series(one.cycles) for one in self._contestants),
            references=tuple(series(one.reference) for one in self._contestants),
            models=tuple(None if one.model is None else series(one.model) for one in self._contestants),
            squares=tuple(self._squares),
            images=tuple(self._images),
            passes=self._passes,
            bad=self._bad,
            count=self.count,
            samples=self._samples,
            stopped=stopped,
            seconds=self._run.elapsed,
        )
