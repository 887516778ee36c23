# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the light passes for the report's page: their pixels for its script, and images that need none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from ..comparison.compare import Comparison
from ..film.parts import Part
from ..film.pictures import hatched, middle_exposure, signed8, srgb8
from ..relative import relative_difference
from .pixels import averaged, code_significances, pack, pack_floats, pixel_significances, write_shot


@dataclass(frozen=True)
class PassPicture:
    """One pass: its `name`, the `exposure` that shows it best, both sides' `floats` and the `significance`, packed, and three `shots`."""

    name: str
    exposure: float
    floats: tuple[Markup, Markup]
    significance: Markup
    shots: tuple[str, str, str]

    @property
    def view(self) -> dict[str, Any]:
        """What the page's script must know of it."""
        return {"name": self.name, "exposure": self.exposure}


def draw_passes(comparison: Comparison, least: int, most: int, limit: float) -> tuple[list[PassPicture], int]:
    """The pictures of the passes that were compared, and how many pixels wide and high each of their means is.

    That is a multiple of `least`, such that all of them together have `most` pixels or fewer. Differences are drawn up to `limit`.
    """
    passes = tuple(comparison.reference.pass_films)
    height, width = comparison.regions.shape
    step = least
    while len(passes) * -(-height // step) * -(-width // step) > most:
        step += least
    return [_draw(comparison, name, step, limit) for name in passes], step


def _draw(comparison: Comparison, name: Part, step: int, limit: float) -> PassPicture:
    moments = tuple(side.pass_films[name] for side in (comparison.reference, comparison.candidate))
    means = tuple(np.where(comparison.left_out[..., None], np.nan, one.mean) for one in moments)
    images = [averaged(mean, step) for mean in means]
    exposure = round(2 * middle_exposure(images[0])) / 2
    difference = relative_difference(images[1] - images[0], images[0], comparison.verdict.floor)
    drawn = [
        *(srgb8(image, exposure) for image in images),
        signed8(np.clip(difference, -limit, limit).mean(axis=2), limit),
    ]
    hatch = np.isnan(images[0]).any(axis=2) | np.isnan(images[1]).any(axis=2)
    return PassPicture(
        str(name),
        exposure,
        tuple(pack_floats(image) for image in images),
        pack(code_significances(pixel_significances(means, moments, step))),
        tuple(write_shot(hatched(image, hatch)) for image in drawn),
    )
