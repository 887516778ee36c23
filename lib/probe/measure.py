# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of a few pixels by its parts, on both sides.

Standard errors come from independent replicates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..comparison.run import TimedRun
from ..comparison.sides import Renderer
from ..errors import Cancelled, EtalonError
from ..film.light_passes import LightPass
from ..film.parts import BounceLimit, EmitterLight, Part
from ..film.rendering import Rendering
from ..film.windows import Box, Windows
from ..progress import Progress
from ..sampling.streams import COUNTED, FIRST_CALLS
from ..verdict.allocation import MOST_SAMPLES

FIRST_SAMPLES = 16
# A round of both sides takes about this part of the time.
ROUND_SHARE = 1.0 / 20.0
# Fewer replicates say little of their own spread.
FEWEST = 4

# Relative differences of sums that are rounding.
ROUNDING = 1e-12
KINDS = ("image", "light pass", "bounce", "light")


@dataclass(frozen=True)
class Reading:
    """One part of the light.

    It has its `kind`, of KINDS, and name; `reference` and `cycles` (3,) with their standard errors, W m^-2 sr^-1.
    """

    kind: str
    name: str
    reference: np.ndarray
    reference_error: np.ndarray
    cycles: np.ndarray
    cycles_error: np.ndarray


@dataclass(frozen=True)
class Probe:
    """The `readings` in the pixels of `box`, the whole light first.

    The box is first column, first row, last column, last row.
    """

    box: Box
    replicates: int
    samples: int
    seconds: float
    readings: tuple[Reading, ...]


def probe(
    renderers: tuple[Renderer, Renderer],
    shape: tuple[int, int],
    box: Box,
    parts: Sequence[Part],
    seconds: float,
    progress: Progress,
) -> Probe:
    """Render the pixels of `box` with both renderers in turns for `seconds`.

    The image has the `shape` (height, width). `parts` are those of the light; limits of bounces are turned into what
    each bounce adds. Cancelling keeps what both sides finished; raises EtalonError where there are fewer than two
    replicates.
    """
    windows = Windows(shape, (box,))
    sides = renderers[0].with_passes(parts), renderers[1].with_passes(parts)
    run, rows = TimedRun(seconds, progress), ([], [])
    try:
        samples = _samples(sides, windows, run)
        while len(rows[1]) < FEWEST or run.left > run.elapsed / max(len(rows[1]), 1):
            number = COUNTED.number(len(rows[1]))
            found = [run.render(side, number, samples, windows)[0] for side in sides]
            for kept, rendering in zip(rows, found, strict=True):
                kept.append(_means(rendering, windows, parts))
    except Cancelled:
        if len(rows[1]) < 2:
            raise EtalonError(
                "cancelled before there were two replicates of both sides; there is nothing to read"
            ) from None
    names = _names(parts)
    means = [np.array([_increments(row, parts) for row in kept]) for kept in rows]
    errors = [one.std(axis=0, ddof=1) / np.sqrt(len(one)) for one in means]
    readings = [
        Reading(kind, name, means[0][:, k].mean(axis=0), errors[0][k], means[1][:, k].mean(axis=0), errors[1][k])
        for k, (kind, name) in enumerate(names)
    ]
    return Probe(box, len(rows[1]), samples, run.elapsed, tuple(readings))


def _samples(sides: tuple[Renderer, Renderer], windows: Windows, run: TimedRun) -> int:
    """Samples of a replicate, a power of two.

    They follow from two short renders of each side that count nowhere.
    """
    spent = []
    for number, samples in enumerate((FIRST_SAMPLES, FIRST_SAMPLES, 16 * FIRST_SAMPLES)):
        spent.append(sum(run.render(side, FIRST_CALLS.number(number), samples, windows)[1] for side in sides))
    few, many = spent[1:]
    each = max((many - few) / (15 * FIRST_SAMPLES), 1e-9)
    # Where a call's fixed part is more than a round should take, samples for as long again nearly come for nothing.
    wanted = max(max(run.share(ROUND_SHARE) - few, few) / each, FIRST_SAMPLES)
    return min(1 << int(np.log2(wanted)), MOST_SAMPLES)


def _means(rendering: Rendering, windows: Windows, parts: Sequence[Part]) -> np.ndarray:
    """The means (1 + parts, 3) over the pixels of `windows`, of the image first."""
    images = [rendering.radiance, *(rendering.passes[part] for part in parts)]
    return np.array([image[windows.mask].mean(axis=0) for image in images])


def _limits(parts: Sequence[Part]) -> list[int]:
    """The places of the limits of bounces among the means, in their order."""
    found = [(part.bounces, k + 1) for k, part in enumerate(parts) if isinstance(part, BounceLimit)]
    return [place for _, place in sorted(found)]


def _names(parts: Sequence[Part]) -> list[tuple[str, str]]:
    """Kind and name of each reading, in the order of `_increments`."""
    names = [("image", "all of it")]
    names += [("light pass", str(part)) for part in parts if isinstance(part, LightPass)]
    limits = sorted(part.bounces for part in parts if isinstance(part, BounceLimit))
    for k, bounces in enumerate(limits):
        names.append(("bounce", f"bounce {bounces}" if k else str(BounceLimit(bounces))))
    names += [("bounce", f"beyond bounce {limits[-1]}")] if limits else []
    return names + [("light", str(part)) for part in parts if isinstance(part, EmitterLight)]


def _increments(means: np.ndarray, parts: Sequence[Part]) -> np.ndarray:
    """The means (1 + parts, 3) with what each bounce adds in place of the limits.

    What is beyond the last limit is among them.
    """
    passes, lights = (
        [k + 1 for k, part in enumerate(parts) if isinstance(part, kind)] for kind in (LightPass, EmitterLight)
    )
    places = _limits(parts)
    series = [means[k] for k in places] + [means[0]] * bool(places)
    added = [one - before for before, one in zip([np.zeros(3), *series], series, strict=False)]
    # What rounding leaves of two equal sums is no light.
    added = [np.where(np.abs(light) < ROUNDING * np.abs(means[0]), 0.0, light) for light in added]
    return np.array([means[0], *means[passes], *added, *means[lights]])
