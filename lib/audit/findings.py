# SPDX-License-Identifier: GPL-3.0-or-later
"""The result of an audit.

It is the series that the rounds give for each setting, and the claims from them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..comparison.compare import CompareOptions
from ..comparison.run import Stop
from ..cost.estimates import Estimate, of_geometric_mean
from ..film.moments import Moments, merge
from ..film.regions import Regions
from ..film.rendering import Rendering
from ..relative import relative_difference
from ..report.page import averaged
from ..verdict.outcome import Outcome
from ..verdict.sequential import holm
from .paired import CHANNELS, interval, p_values
from .setting import Setting

# A difference is drawn from this many standard errors on, of a pixel or of the smallest of these squares around it.
DRAWN = 3.0
SQUARES = (1, 4, 16)
# Beyond any relative difference, to put what has no bound first.
UNBOUNDED = 1e9
# Blocks darker than this share of the whole image count, in noise, as if they were as bright.
NOISE_FLOOR = 0.01


@dataclass(frozen=True)
class Finding:
    """The result for one setting.

    `outcomes` (k,) of Outcome for each region, the whole image first; `difference`, `low`, `high` (k, 3) the relative difference to the
    neutral state and its interval, simultaneous for all settings, regions and channels. `seconds` are the mean ones of a render call,
    `time` their ratio to the neutral state's and `noise` the ratio of the pixels' variances, with 95 % intervals. `map` (height, width) is
    the relative difference where it is sure (see `drawn`), else 0, and NaN where a sample was not finite.
    """

    setting: Setting
    outcomes: np.ndarray
    difference: np.ndarray
    low: np.ndarray
    high: np.ndarray
    seconds: float
    time: Estimate
    noise: Estimate
    map: np.ndarray

    @property
    def outcome(self) -> Outcome:
        """DIFFERENT if a region is, EQUIVALENT if all are."""
        if (self.outcomes == Outcome.DIFFERENT).any():
            return Outcome.DIFFERENT
        return Outcome.EQUIVALENT if (self.outcomes == Outcome.EQUIVALENT).all() else Outcome.UNDECIDED

    @property
    def worst(self) -> tuple[int, int]:
        """Region and channel of the block to show.

        Where the setting is biased, it is the one with the largest least difference. Where it is undecided, it is the
        undecided one with the largest possible difference; else the one with the largest estimate.
        """
        low, high = self.low[1:], self.high[1:]
        size = np.abs(self.difference[1:])
        if self.outcome is Outcome.DIFFERENT:
            sure = np.maximum(np.maximum(low, -high), 0.0)
            size = sure if np.nanmax(sure, initial=0.0) > 0 else size
        elif self.outcome is Outcome.UNDECIDED:
            open_ = (self.outcomes[1:] == Outcome.UNDECIDED)[:, None]
            reach = np.maximum(-low, high)
            reach = np.where(np.isfinite(reach), reach, UNBOUNDED + size)
            size = np.where(open_, reach, -1.0) if open_.any() else size
        place, channel = np.unravel_index(np.argmax(np.nan_to_num(size, nan=-1.0)), size.shape)
        return 1 + int(place), int(channel)


@dataclass(frozen=True)
class Audit:
    """All settings of one scene in one run.

    `same` are those that are at their neutral value, `missing` those that cannot be rendered. `boxes` (k, 4) are the
    first column, first row, last column and last row of each region; k is 0 where there was nothing to measure.
    `neutral` (height, width, 3) is the image of the neutral state, `seconds_neutral` the mean seconds of one render
    call of it, `nonfinite` the number of pixels in which a sample of any image was not finite, `asked` the samples a
    pixel that the user's file asks for. `stopped` says why the audit ended.
    """

    scene: str
    options: CompareOptions
    findings: tuple[Finding, ...]
    same: tuple[Setting, ...]
    missing: tuple[Setting, ...]
    boxes: np.ndarray
    neutral: np.ndarray
    floor: float
    rounds: int
    samples: int
    asked: int
    nonfinite: int
    seconds_neutral: float
    stopped: Stop
    started: str
    seconds: float
    settings: dict[str, object]
    versions: dict[str, str]


@dataclass
class Series:
    """The data of the rounds so far on one setting.

    They are regions' means of both sides, pixels' differences, seconds, and noise for each two rounds.
    """

    regions: Regions
    user: list[np.ndarray] = field(default_factory=list)
    neutral: list[np.ndarray] = field(default_factory=list)
    squares: list[Moments] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    noise: list[float] = field(default_factory=list)
    before: tuple[np.ndarray, np.ndarray] | None = None

    def add(self, neutral: np.ndarray, rendering: Rendering) -> np.ndarray:
        """Add one pair; pixels (height, width) that are not finite on either side are returned.

        Such pixels count on neither side.
        """
        used = np.isfinite(neutral).all(axis=2) & np.isfinite(rendering.radiance).all(axis=2)
        user, plain = rendering.radiance, neutral
        if not used.all():
            user, plain = (np.where(used[..., None], image, np.float32(0.0)) for image in (user, plain))
        weights = self.regions.weights
        sizes = weights @ used.ravel().astype(float)
        share = np.where(sizes > 0, sizes, np.nan)[:, None]
        for means, image in ((self.user, user), (self.neutral, plain)):
            means.append((weights @ image.reshape(-1, CHANNELS)) / share)
        gap = (user - plain).mean(axis=2, keepdims=True, dtype=float)
        once = [averaged(gap, step)[..., 0] for step in SQUARES]
        seen = [Moments(1, mean, np.zeros(mean.shape)) for mean in once]
        self.squares = [merge(*pair) for pair in zip(self.squares, seen, strict=True)] if self.squares else seen
        self.seconds.append(rendering.seconds)
        if self.before is None:
            self.before = user, plain
        else:
            self.noise.append(_noise_ratio(self.regions, (user, plain), self.before, self.neutral[-1]))
            self.before = None
        return ~used


def _noise_ratio(
    regions: Regions, now: tuple[np.ndarray, np.ndarray], then: tuple[np.ndarray, np.ndarray], means: np.ndarray
) -> float:
    """Variance of the pixels of the first image over that of the second.

    It comes from two independent replicates of both; NaN where the second has no variance. Each block counts relative
    to its own brightness, the region `means` (k, 3), so that neither the brightest nor the darkest dominate.
    """
    levels = np.square(means).mean(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = 1.0 / np.maximum(np.nan_to_num(levels[1:]), NOISE_FLOOR**2 * levels[0])
        squares = [regions.weights[1:] @ np.square(a - b).sum(axis=2).ravel() for a, b in zip(now, then, strict=True)]
        user, plain = (float(s @ weight) for s in squares)
    return user / plain if plain > 0 else math.nan


def drawn(squares: list[Moments], neutral: np.ndarray, floor: float) -> np.ndarray:
    """The relative difference (height, width) that a map shows.

    It is that of the smallest square around each pixel that is sure of it, else 0. Where a larger square is sure of the
    other sign, that one counts: single pixels that no firefly has reached yet are sure too soon.
    """
    height, width, _ = neutral.shape
    out = np.zeros((height, width))
    for step, moments in reversed(list(zip(SQUARES, squares, strict=True))):
        sure = np.abs(moments.mean) >= DRAWN * np.nan_to_num(moments.standard_error)
        value = np.where(sure, relative_difference(moments.mean, averaged(neutral, step)[..., 0], floor), 0.0)
        value = value.repeat(step, axis=0).repeat(step, axis=1)[:height, :width]
        out = np.where((value != 0.0) & (value * out >= 0.0), value, out)
    return out


def judge(
    settings: list[Setting],
    series: list[Series],
    seconds: np.ndarray,
    options: CompareOptions,
    floor: float,
    image: np.ndarray,
    bad: np.ndarray,
) -> tuple[Finding, ...]:
    """Judge all settings together, so that one level holds for all that is claimed."""
    if not settings:
        return ()
    pairs = [(np.stack(entry.user), np.stack(entry.neutral)) for entry in series]
    p = np.stack([p_values(user, neutral, options.tolerance, floor) for user, neutral in pairs])
    rejected = holm(np.nan_to_num(p, nan=1.0).ravel(), 1 - options.confidence).reshape(p.shape)
    tail = (1 - options.confidence) / (2 * CHANNELS * p.shape[0] * p.shape[2])
    grey, found = image.mean(axis=2, keepdims=True), []
    for setting, entry, (user, neutral), (inside, outside) in zip(settings, series, pairs, rejected, strict=True):
        outcomes = np.full(inside.shape, Outcome.UNDECIDED)
        outcomes[inside] = Outcome.EQUIVALENT
        outcomes[outside] = Outcome.DIFFERENT
        low, high = interval(user, neutral, floor, tail)
        found.append(
            Finding(
                setting=setting,
                outcomes=outcomes,
                difference=relative_difference((user - neutral).mean(axis=0), neutral.mean(axis=0), floor),
                low=low,
                high=high,
                seconds=float(np.mean(entry.seconds)),
                time=of_geometric_mean(np.array(entry.seconds) / seconds),
                noise=of_geometric_mean(np.array(entry.noise or [np.nan])),
                map=np.where(bad, np.nan, drawn(entry.squares, grey, floor)),
            )
        )
    return tuple(found)
