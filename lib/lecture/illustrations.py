# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure: the lecture's two rows of illustrations by both renderers.

It has the verdict, and what an eye would notice.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from ..film.pictures import signed8, srgb8
from ..pages.formats import format_bound, format_percent
from ..relative import relative_difference
from ..report.flip import flip
from ..report.pixels import write_shot
from . import captions
from .figure import Figure, Words, show_words

BETWEEN = 0.2
"""Relative differences up to which the picture of differences has a colour."""


@dataclass(frozen=True)
class Sphere:
    """One sphere.

    It has its distribution and sigma, its weight in each pixel (height, width), and the verdict on it. `outcome` is
    the name of one; `difference` is Cycles less reference, relative, of the channel where it is largest, and `bound`
    what the data have not ruled out.
    """

    distribution: str
    sigma: float
    weights: np.ndarray
    outcome: str
    difference: float
    bound: float


@dataclass(frozen=True)
class Rows:
    """Both rows by both renderers.

    They have radiance (height, width, 3), the standard error of each, and the spheres. `all_ggx` is the reference's
    image with GGX in both rows. `tolerance` and `seconds` are those of the comparison, `cycles` names the release.
    """

    reference: np.ndarray
    candidate: np.ndarray
    all_ggx: np.ndarray
    errors: tuple[np.ndarray, np.ndarray]
    spheres: tuple[Sphere, ...]
    tolerance: float
    seconds: float
    cycles: str


def illustrate_rows(rows: Rows, seed: int) -> Figure:
    """The pictures, and a row of the table for each sphere, and for each change of model.

    FLIP of two renders has their noise in it. Beside it stands that of the reference and the same image with noise as large as both
    renders have; what an eye would see of a difference is the rest.
    """
    # Samples are colours: all channels of a pixel are too bright or too dark together.
    normal = np.random.default_rng(seed).standard_normal((*rows.reference.shape[:2], 1))
    noise = np.hypot(*rows.errors) * normal
    seen = flip(rows.reference, rows.candidate, 0.0)
    of_noise = flip(rows.reference, rows.reference + noise, 0.0)
    found = [
        {
            "distribution": one.distribution,
            "sigma": one.sigma,
            "verdict": one.outcome,
            "difference": one.difference,
            "bound": one.bound,
            "flip": _mean(seen, one.weights),
            "flip_of_noise": _mean(of_noise, one.weights),
        }
        for one in rows.spheres
    ]
    between = compare_models(rows)
    gray = rows.reference.mean(axis=2), rows.candidate.mean(axis=2)
    difference = relative_difference(gray[1] - gray[0], gray[0], 0.01 * float(gray[0].mean()))
    pictures = (
        (captions.BY_REFERENCE, srgb8(rows.reference)),
        (Words(rows.cycles, rows.cycles), srgb8(rows.candidate)),
        (captions.DIFFERENCE, signed8(difference, BETWEEN)),
        (captions.BY_FLIP, np.repeat(np.rint(255.0 * np.nan_to_num(seen))[..., None], 3, axis=2).astype(np.uint8)),
    )
    drawing = Markup('<div class="shots">') + Markup("").join(_picture(*one) for one in pictures) + Markup("</div>")
    numbers = {"tolerance": rows.tolerance, "seconds": rows.seconds, "cycles": rows.cycles, "seed": seed}
    return Figure(drawing + _table(found, between), {**numbers, "spheres": found, "ggx_for_beckmann": between})


def compare_models(rows: Rows) -> list[dict[str, Any]]:
    """How GGX in place of Beckmann's distribution changes the upper spheres.

    It gives the relative difference of their light, and mean FLIP.
    """
    seen = flip(rows.reference, rows.all_ggx, 0.0)
    found = []
    for one in rows.spheres:
        if one.distribution == "Beckmann":
            before, after = (
                float(np.average(image.mean(axis=2), weights=one.weights)) for image in (rows.reference, rows.all_ggx)
            )
            found.append({"sigma": one.sigma, "difference": after / before - 1.0, "flip": _mean(seen, one.weights)})
    return found


def illustrate_missing(reason: str) -> Figure:
    """The place of the figure where Blender cannot render it, with the `reason`."""
    said = Markup('<p class="missing">{} {}</p>').format(show_words(captions.MISSING), reason)
    return Figure(said, {"missing": reason})


def _mean(image: np.ndarray, weights: np.ndarray) -> float:
    """The mean over the pixels that have a value."""
    return float(np.average(np.nan_to_num(image), weights=weights * np.isfinite(image)))


def _picture(title: Words, pixels: np.ndarray) -> Markup:
    return Markup('<figure><img src="{}" alt="{} / {}"><figcaption>{}</figcaption></figure>').format(
        write_shot(pixels), title.english, title.french, show_words(title)
    )


def _table(spheres: list[dict[str, Any]], between: list[dict[str, Any]]) -> Markup:
    kinds = ("", "", *["number"] * (len(captions.ROW_HEADS) - 2))
    head = Markup("").join(
        Markup('<th class="{}">{}</th>').format(kind, show_words(words))
        for kind, words in zip(kinds, captions.ROW_HEADS, strict=True)
    )
    body = [
        Markup(
            '<tr><td>{distribution}, σ = {sigma:g}</td><td>{verdict}</td><td class="number">{gap}</td><td class="number">{bound}</td>'
            '<td class="number">{flip:.3f}</td><td class="number">{flip_of_noise:.3f}</td></tr>'
        ).format(gap=format_percent(one["difference"]), **_bounded(one))
        for one in spheres
    ]
    body += [
        Markup(
            '<tr><td>Beckmann → GGX, σ = {sigma:g}</td><td>{told}</td><td class="number">{gap}</td><td></td>'
            '<td class="number">{flip:.3f}</td><td></td></tr>'
        ).format(told=show_words(captions.BOTH_MODELS), gap=format_percent(one["difference"]), **one)
        for one in between
    ]
    return Markup('<div class="scroll"><table><tr>{}</tr>{}</table></div>').format(head, Markup("").join(body))


def _bounded(one: dict[str, Any]) -> dict[str, Any]:
    return {**one, "bound": format_bound(one["bound"])}
