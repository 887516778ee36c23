# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder a comparison leaves: verdict.json, report.html, the EXR images and their PNG views."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from ..comparison.compare import Comparison
from ..effects.plan import Plan
from ..files.atomic import replace_files
from ..files.plain_data import write_json
from ..film.exr import DIFFERENCE, write_exr, write_film
from ..film.pictures import hatched, middle_exposure, signed8, srgb8, write_png
from ..pages import render_page
from ..relative import relative_difference
from .curve import draw_bound
from .document import document
from .flip import flip

# The report carries raw floats of both images; larger ones are averaged down to this many pixels, as it then says.
MOST_PIXELS = 600_000
# Differences are drawn up to this many tolerances.
DIFFERENCE_LIMIT = 5
# FLIP travels as bytes: 0 to 254, and one that stands for pixels that are not finite.
FLIP_ONE, FLIP_NONE = 254, 255


def write_report(comparison: Comparison, plan: Plan, folder: Path, command: str = "") -> None:
    """Write all files into `folder`, which is made if it is not there; each is complete or not there at all.

    `plan` is what the reference ran of its effects, `command` what repeats the comparison, shown as text. Raises EtalonError where the
    folder cannot be written.
    """
    with replace_files(folder) as beside:
        _write_all(comparison, plan, beside, command)


def _shown(comparison: Comparison) -> tuple[np.ndarray, np.ndarray]:
    """Both sides' means (height, width, 3); NaN, as what is not finite, where pixels are not compared."""
    means = comparison.reference.film.moments.mean, comparison.candidate.film.moments.mean
    if not comparison.unknown:
        return means
    reference, candidate = (np.where(comparison.left_out[..., None], np.nan, mean) for mean in means)
    return reference, candidate


def pixel_differences(comparison: Comparison) -> np.ndarray:
    """The relative difference of each pixel (height, width, 3); NaN for what is not compared."""
    means = _shown(comparison)
    out = np.empty_like(means[0])
    for row, (reference, candidate) in enumerate(zip(*means, strict=True)):
        out[row] = relative_difference(candidate - reference, reference, comparison.verdict.floor)
    return out


def _write_all(comparison: Comparison, plan: Plan, folder: Path, command: str) -> None:
    figures = document(comparison, plan, command)
    write_json(folder / "verdict.json", figures)
    (folder / "report.html").write_text(_html(comparison, figures), encoding="utf-8")
    write_film(folder / "reference.exr", comparison.reference.film)
    write_film(folder / "cycles.exr", comparison.candidate.film)
    difference = pixel_differences(comparison)
    write_exr(folder / "difference.exr", {name: difference[..., c] for c, name in enumerate("RGB")}, DIFFERENCE)
    means = _shown(comparison)
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


def _html(comparison: Comparison, figures: dict[str, Any]) -> str:
    height, width = comparison.regions.shape
    step = 1
    while -(-height // step) * -(-width // step) > MOST_PIXELS:
        step += 1
    images = [averaged(mean, step) for mean in _shown(comparison)]
    exposure = round(2 * middle_exposure(images[0])) / 2
    seen = flip(images[0], images[1], exposure)
    bytes_ = np.where(np.isnan(seen), FLIP_NONE, np.rint(FLIP_ONE * np.nan_to_num(seen))).astype(np.uint8)
    view = {
        "width": images[0].shape[1],
        "height": images[0].shape[0],
        "step": step,
        "floor": comparison.verdict.floor.tolist(),
        "tolerance": comparison.verdict.tolerance,
        "limit": DIFFERENCE_LIMIT,
        "exposure": exposure,
        "flip": {
            "one": FLIP_ONE,
            "none": FLIP_NONE,
            "mean": float(np.nanmean(seen)) if np.isfinite(seen).any() else None,
        },
        "names": [comparison.reference.name, comparison.candidate.name],
        "regions": [shorten_region(region) for region in figures["regions"]],
    }
    values = {
        "figures": figures,
        "view": view,
        "curve": draw_bound(comparison.history, comparison.verdict.tolerance),
        "floats": [_packed(image.astype("<f4")) for image in images],
        "flip": _packed(bytes_),
    }
    return render_page(Path(__file__).with_name("report.html"), values)


def _packed(values: np.ndarray) -> Markup:
    """An array's bytes as text for a script element, which they cannot end."""
    return Markup(base64.b64encode(values.tobytes()).decode())


def shorten_region(region: dict[str, Any]) -> dict[str, Any]:
    """A region of verdict.json as the page's script reads it: the same names, six significant digits."""

    def short(values: list[float | None]) -> list[float | None]:
        return [None if v is None else float(f"{v:.6g}") for v in values]

    kept = {key: region[key] for key in ("kind", "name", "outcome", "box", "decided_at")}
    kept["bound"] = None if region["bound"] is None else float(f"{region['bound']:.6g}")
    sizes = {key: round(region[key], 2) for key in ("pixels", "excluded_pixels")}
    return {
        **kept,
        **sizes,
        **{key: short(region[key]) for key in ("reference", "candidate", "difference", "low", "high")},
    }


def averaged(image: np.ndarray, step: int) -> np.ndarray:
    """The means of `step` x `step` pixels (fewer at the right and lower edge) of an image (height, width, 3)."""
    rows, columns = (np.arange(0, size, step) for size in image.shape[:2])
    total = np.add.reduceat(np.add.reduceat(image, rows, axis=0), columns, axis=1)
    counts = [np.diff(np.append(at, size)) for at, size in zip((rows, columns), image.shape[:2], strict=True)]
    return total / (counts[0][:, None] * counts[1])[..., None]
