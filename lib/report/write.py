# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a comparison writes.

It holds verdict.json, report.html, the EXR images and their PNG views.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..comparison.compare import Comparison
from ..effects.plan import Plan
from ..files.atomic import replace_files
from ..files.plain_data import write_json
from ..film.exr import DIFFERENCE, write_exr, write_film
from ..film.pictures import hatched, middle_exposure, signed8, srgb8, write_png
from ..film.view_transform import ViewTransform
from ..relative import relative_difference
from .document import document
from .page import DIFFERENCE_LIMIT, render_report, shown_means

EXRS = ("reference.exr", "cycles.exr", "difference.exr")


def write_report(
    comparison: Comparison,
    plan: Plan,
    folder: Path,
    command: str = "",
    transform: ViewTransform | None = None,
    keep_exrs: bool = True,
) -> None:
    """Write all files into `folder`, which is made if it does not exist.

    Each file is complete or does not exist. `plan` is what the reference ran of its effects, `command` what repeats
    the comparison, shown as text; `transform` is the view transform of the user's scene, which the page offers beside
    plain sRGB. Without `keep_exrs` there are no float images, also no older ones. Raises EtalonError where the folder
    cannot be written.
    """
    with replace_files(folder, without=EXRS) as beside:
        _write_all(comparison, plan, beside, command, transform)
        if keep_exrs:
            _write_exrs(comparison, beside)


def pixel_differences(comparison: Comparison) -> np.ndarray:
    """The relative difference of each pixel (height, width, 3); NaN for what is not compared."""
    means = shown_means(comparison)
    out = np.empty_like(means[0])
    for row, (reference, candidate) in enumerate(zip(*means, strict=True)):
        out[row] = relative_difference(candidate - reference, reference, comparison.verdict.floor)
    return out


def _write_all(comparison: Comparison, plan: Plan, folder: Path, command: str, transform: ViewTransform | None) -> None:
    figures = document(comparison, plan, command)
    write_json(folder / "verdict.json", figures)
    (folder / "report.html").write_text(render_report(comparison, figures, transform), encoding="utf-8")
    difference = pixel_differences(comparison)
    means = shown_means(comparison)
    exposure = middle_exposure(means[0])
    limit = DIFFERENCE_LIMIT * comparison.verdict.tolerance
    clipped = np.stack([np.clip(row, -limit, limit).mean(axis=1) for row in difference])
    views = {
        "reference": srgb8(means[0], exposure),
        "cycles": srgb8(means[1], exposure),
        "difference": signed8(clipped, limit),
    }
    for name, view in views.items():
        write_png(folder / f"{name}.png", hatched(view, comparison.left_out))


def _write_exrs(comparison: Comparison, folder: Path) -> None:
    reference, cycles, difference = (folder / name for name in EXRS)
    write_film(reference, comparison.reference.film)
    write_film(cycles, comparison.candidate.film)
    channels = np.moveaxis(pixel_differences(comparison), 2, 0)
    write_exr(difference, dict(zip("RGB", channels, strict=True)), DIFFERENCE)
