# SPDX-License-Identifier: GPL-3.0-or-later
"""The regions of a comparison in the order that suits a reader, each with its figures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..comparison.compare import Comparison
from ..film.parts import Part
from ..relative import worst_channel
from ..verdict.outcome import Outcome
from .page import GRIDS, URGENCY
from .summary import describe_box


@dataclass(frozen=True)
class RankedRegion:
    """One region: its `kind` and `name` as in Regions, its outcome, and figures as shares.

    `label` is short enough for a list. `difference`, `low` and `high` are those of `channel`, where the region is furthest off; `bound` is
    the difference that is not ruled out. `box` is in shares of the image's width and height: left, top, right, bottom.
    """

    kind: str
    name: str
    label: str
    outcome: Outcome
    difference: float
    low: float
    high: float
    bound: float
    channel: str
    box: tuple[float, float, float, float]

    @property
    def margin(self) -> float:
        """The least share that reaches from the difference to both ends of its interval."""
        return max(self.high - self.difference, self.difference - self.low)


def rank_regions(comparison: Comparison, part: Part | None = None) -> list[RankedRegion]:
    """All regions, the worst first, in the order of the report's page.

    Regions without a pixel to compare are left out. With a `part` of the light that was compared, they are the image and the regions with a
    name, with what is claimed of that part in them; no other region is tested by parts. Raises ValueError where it was not.
    """
    regions, (outcomes, bounds, *ends) = comparison.regions, _claims(comparison, part)
    count = outcomes.size  # the image and the regions with a name stand first
    channel = worst_channel(ends[0])
    difference, low, high = (np.take_along_axis(values, channel[:, None], 1)[:, 0] for values in ends)
    undecided = outcomes == Outcome.UNDECIDED
    extent = np.nan_to_num(np.where(undecided, bounds, np.abs(difference)), nan=-1.0, posinf=np.inf)
    urgency = np.array([URGENCY.index(outcome.value) for outcome in outcomes])
    is_cell = np.isin(np.array(regions.kinds[:count], object), GRIDS)
    order = np.lexsort((-extent, is_cell, urgency))
    height, width = regions.shape
    scale = np.array([width, height, width, height], float)
    boxes = ((regions.boxes + np.array([0, 0, 1, 1])) / scale).tolist()
    there = (comparison.verdict.excluded < regions.sizes)[:count]
    return [
        RankedRegion(
            regions.kinds[k],
            regions.names[k],
            _label(comparison, k),
            outcomes.item(k),
            float(difference[k]),
            float(low[k]),
            float(high[k]),
            float(bounds[k]),
            "RGB"[channel[k]],
            tuple(boxes[k]),
        )
        for k in order[there[order]].tolist()
    ]


def _claims(comparison: Comparison, part: Part | None) -> tuple[np.ndarray, ...]:
    """Outcomes, bounds, differences and their ends: of all regions, or of a part of the light in those with a name."""
    verdict, found = comparison.verdict, comparison.passes
    if part is None:
        return verdict.outcomes, verdict.bounds, verdict.difference, verdict.low, verdict.high
    if found is None or part not in found.passes:
        raise ValueError(f"{part} was not compared")
    k = found.passes.index(part)
    return found.outcomes[k], found.bounds[k], found.difference[k], found.low[k], found.high[k]


def _label(comparison: Comparison, k: int) -> str:
    """A name for a list.

    It is the user's own, a material with its angles, or the first pixel of a cell and where that lies.
    """
    kind, name = comparison.regions.kinds[k], comparison.regions.names[k]
    if kind == "facing":
        material, _, angles = name.removesuffix(" degrees").rpartition(", ")
        return f"{material} {angles.replace(' to ', '–')}°"
    if kind not in GRIDS:
        return name
    box = tuple(comparison.regions.boxes[k].tolist())
    return f"{describe_box(box, comparison.regions.shape)} {box[0]}, {box[1]}"
