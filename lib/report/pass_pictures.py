# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the light passes for the report's page.

They are pixels for its script, and images that need none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from ..comparison.compare import Comparison
from ..film.moments import Moments
from ..film.parts import Part
from ..film.pictures import hatched, middle_exposure, signed8, srgb8
from ..relative import relative_difference
from .pixels import averaged, code_errors, code_significances, pack, pack_floats, pixel_significances, write_shot


@dataclass(frozen=True)
class PassPicture:
    """The pictures of one pass.

    They are its `name`, the `exposure` that shows it best, both sides' `floats` and standard `errors` and the
    `significance`, packed, and three `shots`.
    """

    name: str
    exposure: float
    floats: tuple[Markup, Markup]
    errors: tuple[Markup, Markup]
    significance: Markup
    shots: tuple[str, str, str]

    @property
    def view(self) -> dict[str, Any]:
        """The data of it that the page's script needs."""
        return {"name": self.name, "exposure": self.exposure}


def draw_passes(comparison: Comparison, least: int, most: int, limit: float) -> tuple[list[PassPicture], int]:
    """Draw the passes that were compared; returns pictures and the step of their means.

    The step is how many pixels wide and high each mean is. It is a multiple of `least`, such that all of them
    together have `most` pixels or fewer. Differences are drawn up to `limit`.
    """
    passes = tuple(comparison.reference.pass_films)
    height, width = comparison.regions.shape
    step = least
    while len(passes) * -(-height // step) * -(-width // step) > most:
        step += least
    return [_draw(comparison, name, step, limit) for name in passes], step


def pack_errors(moments: tuple[Moments, Moments], step: int) -> tuple[Markup, Markup]:
    """The standard errors of both sides' means of `step` x `step` pixels.

    They are packed for the page's script.
    """
    return pack(code_errors(moments[0], step)), pack(code_errors(moments[1], step))


def _draw(comparison: Comparison, name: Part, step: int, limit: float) -> PassPicture:
    moments = comparison.reference.pass_films[name], comparison.candidate.pass_films[name]
    left_out = comparison.left_out[..., None]
    means = np.where(left_out, np.nan, moments[0].mean), np.where(left_out, np.nan, moments[1].mean)
    reference, candidate = averaged(means[0], step), averaged(means[1], step)
    exposure = round(2 * middle_exposure(reference)) / 2
    difference = relative_difference(candidate - reference, reference, comparison.verdict.floor)
    hatch = np.isnan(reference).any(axis=2) | np.isnan(candidate).any(axis=2)
    return PassPicture(
        str(name),
        exposure,
        (pack_floats(reference), pack_floats(candidate)),
        pack_errors(moments, step),
        pack(code_significances(pixel_significances(means, moments, step))),
        (
            write_shot(hatched(srgb8(reference, exposure), hatch)),
            write_shot(hatched(srgb8(candidate, exposure), hatch)),
            write_shot(hatched(signed8(np.clip(difference, -limit, limit).mean(axis=2), limit), hatch)),
        ),
    )
