# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch against an earlier one: which comparisons and which differences changed.

Differences are shown to have changed with confidence. The intervals of one verdict hold together, for all its regions
and channels. Where those of two verdicts do not overlap, the true differences are not the same, unless one of the two
verdicts is wrong: each is so with a probability of at most 1 - its confidence.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import EtalonError
from ..pages.formats import format_percent
from ..report.batch import Row
from ..report.read import read_verdict

FORMAT, VERSION = "etalon-batch", 1
# Grids have other squares where the time gave other samples; these kinds mean the same in both.
_KINDS = ("image", "material", "object")


@dataclass(frozen=True)
class Moved:
    """A region whose difference from the reference has changed, in one channel.

    It has the estimate, and the low and high end, of both batches.
    """

    kind: str
    name: str
    channel: str
    before: tuple[float, float, float]
    after: tuple[float, float, float]


@dataclass(frozen=True)
class Changed:
    """One comparison with another outcome than before, or with regions that moved.

    The largest move is first.
    """

    label: str
    before: str
    after: str
    moved: tuple[Moved, ...]

    def __str__(self) -> str:
        """What changed, in one line."""
        said = f"{self.label}: {self.before} before, now {self.after}" if self.before != self.after else self.label
        if not self.moved:
            return said
        first = self.moved[0]
        where = "whole image" if first.kind == "image" else f"{first.kind} '{first.name}'"
        rest = f", and {len(self.moved) - 1} more" if len(self.moved) > 1 else ""
        return (
            f"{said}; {where}, channel {first.channel}: {format_percent(first.before[0])} before, "
            f"now {format_percent(first.after[0])}{rest}"
        )


def read_batch(earlier: Path) -> dict[str, Any]:
    """Read the batch.json of an earlier batch, named by itself or by its folder.

    Raises EtalonError where it is no batch.json.
    """
    path = earlier / "batch.json" if earlier.is_dir() else earlier
    try:
        figures = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise EtalonError(f"{path}: cannot be read ({error.strerror}); name the folder of an earlier batch") from error
    except ValueError as error:
        raise EtalonError(f"{path}: is not JSON ({error}); name the folder of an earlier batch") from error
    if not isinstance(figures, dict) or figures.get("format") != FORMAT:
        raise EtalonError(f"{path}: is no batch.json of etalon's; name the folder of an earlier batch")
    if figures.get("version") != VERSION:
        raise EtalonError(
            f"{path}: is of version {figures.get('version')}, and this Étalon knows {VERSION}; run it again"
        )
    return figures | {"folder": path.parent}


def find_changes(earlier: Mapping[str, Any], rows: Sequence[tuple[str, Row]], out: Path) -> tuple[Changed, ...]:
    """The comparisons, by their labels, that changed since an earlier batch.

    Those that only one of both batches has are left out.
    """
    before = {one["label"]: one for one in earlier["comparisons"]}
    found = []
    for label, row in rows:
        if label not in before or row.status == "not run":
            continue
        then = before[label]
        outcomes = then["verdict"] or then["status"], row.verdict or row.status
        moved: tuple[Moved, ...] = ()
        if row.verdict and then["verdict"]:
            moved = _moved(earlier["folder"] / then["folder"] / "verdict.json", out / row.folder / "verdict.json")
        if outcomes[0] != outcomes[1] or moved:
            found.append(Changed(label, *outcomes, moved))
    return tuple(found)


def _moved(before: Path, after: Path) -> tuple[Moved, ...]:
    """The regions whose intervals in two verdicts do not overlap.

    Empty where one of the two cannot be read any more.
    """
    try:
        old, new = read_verdict(before), read_verdict(after)
    except EtalonError:
        return ()
    known = {(one["kind"], one["name"]): one for one in old["regions"] if one["kind"] in _KINDS}
    found = []
    for region in new["regions"]:
        then = known.get((region["kind"], region["name"]))
        if then is None:
            continue
        for k, channel in enumerate("RGB"):
            first, second = (tuple(one[key][k] for key in ("difference", "low", "high")) for one in (then, region))
            if None not in first + second and (second[1] > first[2] or second[2] < first[1]):
                found.append(Moved(region["kind"], region["name"], channel, first, second))
    return tuple(sorted(found, key=lambda one: -abs(one.after[0] - one.before[0])))
