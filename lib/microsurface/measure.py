# SPDX-License-Identifier: GPL-3.0-or-later
"""Height fields traced at some angles, beside the formulas.

This shows which geometry underlies G, in numbers with errors.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..progress import NO_PROGRESS, Progress
from .height_field import gaussian_field, tiled_mesh
from .models import FORMULAS, reflected_once, shared_by_mirror, visible_share
from .ply import write_ply
from .traced import TracedField

CELLS, PLACES, RAYS = 256, 100_000, 40_000
"""Cells along a side of a field; places and rays of each field and angle."""
LEVEL = 0.25
"""Facets count as level whose slope is at most LEVEL times alpha."""


@dataclass(frozen=True)
class Measured:
    """A mean over independent fields, and its standard error."""

    mean: float
    error: float

    def apart(self, value: float) -> float:
        """How many standard errors the mean lies above `value`."""
        return (self.mean - value) / self.error


@dataclass(frozen=True)
class Figures:
    """What was found under one `angle`, in degrees.

    visible: the share of level facets that the direction sees, and `visible_smith` Smith's G1. shared: the share that the direction
    and its mirror image both see, and `shared_by` what each formula says. once: the part of the light that white mirrors
    reflect once and let go, and `once_by` the same by each formula. again: what leaves after more reflections.
    """

    angle: float
    visible: Measured
    visible_smith: float
    shared: Measured
    shared_by: dict[str, float]
    once: Measured
    once_by: dict[str, float]
    again: Measured


def measure_microsurface(
    alpha: float,
    angles: tuple[float, ...],
    fields: int,
    correlation: float,
    seed: int = 0,
    progress: Progress = NO_PROGRESS,
) -> list[Figures]:
    """Trace `fields` independent height fields under each of the `angles`, in degrees.

    The fields have Beckmann's `alpha`.

    `correlation`: the length of correlation in cells of the grid. Errors come from the differences between fields, of
    which there must be two or more. Raises Cancelled when asked to stop.
    """
    directions = [np.array([np.sin(a), 0.0, np.cos(a)]) for a in np.radians(angles)]
    found = np.empty((fields, len(angles), 4))
    for k, one in enumerate(np.random.SeedSequence(seed).spawn(fields)):
        field = TracedField(np.random.default_rng(one), CELLS, correlation, alpha)
        for j, direction in enumerate(directions):
            progress.check()
            found[k, j] = _at(field, direction, alpha)
            progress.report((k * len(angles) + j + 1) / (fields * len(angles)))
    means, errors = found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(fields)
    return [
        Figures(
            angle,
            Measured(means[j, 0], errors[j, 0]),
            visible_share(direction, alpha),
            Measured(means[j, 1], errors[j, 1]),
            shared_by_mirror(direction, alpha),
            Measured(means[j, 2], errors[j, 2]),
            reflected_once(direction, alpha),
            Measured(means[j, 3], errors[j, 3]),
        )
        for j, (angle, direction) in enumerate(zip(angles, directions, strict=True))
    ]


def write_field(path: Path, alpha: float, correlation: float, seed: int, cells: int = CELLS) -> None:
    """Write the first field that `measure_microsurface` traces as a PLY mesh.

    The mesh has half a period more on every side.

    One unit is a cell. The field itself covers 0 to `cells` along x and y. Raises EtalonError where the file cannot
    be written.
    """
    (first,) = np.random.SeedSequence(seed).spawn(1)
    heights = gaussian_field(np.random.default_rng(first), cells, correlation, alpha)
    comment = f"height field of Beckmann's distribution, alpha {alpha:g}, 0 to {cells} along x and y; seed {seed}"
    write_ply(path, tiled_mesh(heights, cells // 2), comment)


def _at(field: TracedField, direction: np.ndarray, alpha: float) -> tuple[float, float, float, float]:
    mirrored = direction * np.array([-1.0, -1.0, 1.0])
    normal, _, seen = field.seen([direction, mirrored], PLACES)
    level = np.hypot(normal[0], normal[1]) <= LEVEL * alpha * normal[2]
    once, total = field.reflected(direction, RAYS)
    return seen[0, level].mean(), (seen[0] & seen[1])[level].mean(), once, total - once


def figures_of(found: list[Figures], alpha: float, fields: int, correlation: float, seed: int) -> dict[str, object]:
    """All of it as a dictionary for JSON."""
    return {
        "alpha": alpha,
        "fields": fields,
        "cells": CELLS,
        "correlation": correlation,
        "seed": seed,
        "level": LEVEL,
        "angles": [
            {
                "angle": one.angle,
                "visible": {"traced": vars(one.visible), "smith": one.visible_smith},
                "mirror": {"traced": vars(one.shared), **one.shared_by},
                "reflected_once": {"traced": vars(one.once), **one.once_by},
                "reflected_again": {"traced": vars(one.again)},
            }
            for one in found
        ],
    }


def lines_of(found: list[Figures]) -> list[str]:
    """A table for each of the three questions, one row an angle."""
    heads = {"separable": "separable", "correlated": "correlated", "torrance_sparrow": "V-cavities"}
    lines = ["Level facets that a direction sees:", f"{'angle':>6}  {'traced':>16}  {'Smith':>10}"]
    lines += [f"{one.angle:>5g}°  {_shown(one.visible):>16}  {one.visible_smith:>10.4f}" for one in found]
    columns = "  ".join(f"{heads[name]:>10}" for name in FORMULAS)
    for title, pick in (
        ("Level facets that a direction and its mirror image both see:", lambda one: (one.shared, one.shared_by)),
        ("Light that white mirrors reflect once:", lambda one: (one.once, one.once_by)),
    ):
        lines += ["", title, f"{'angle':>6}  {'traced':>16}  {columns}"]
        for one in found:
            traced, by = pick(one)
            lines.append(f"{one.angle:>5g}°  {_shown(traced):>16}  " + "  ".join(f"{by[n]:>10.4f}" for n in FORMULAS))
    return lines


def _shown(value: Measured) -> str:
    return f"{value.mean:.4f} ± {value.error:.4f}"
