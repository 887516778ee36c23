# SPDX-License-Identifier: GPL-3.0-or-later
"""report.html: one file with every pixel, every region and a script that shows them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from ..comparison.compare import Comparison
from ..comparison.interim import Interim
from ..errors import EtalonError
from ..film.moments import Moments
from ..film.parts import Part
from ..film.pictures import hatched, middle_exposure, signed8, srgb8
from ..film.view_transform import ViewTransform
from ..pages import render_page
from ..relative import relative_difference, worst_channel
from ..verdict.outcome import Outcome
from .curve import draw_bound
from .flip import flip
from .pass_pictures import draw_passes, pack_errors
from .pixels import (
    ERROR_NONE,
    ERROR_ONE,
    ERROR_STEPS,
    ERROR_ZERO,
    SIGNIFICANCE_NONE,
    SIGNIFICANCE_ONE,
    averaged,
    code_significances,
    pack,
    pack_floats,
    pixel_significances,
    write_shot,
)

# The report carries raw floats of both images; larger ones are averaged down to this many pixels, as it then says.
MOST_PIXELS = 600_000
# Differences are drawn up to this many tolerances, and significances up to this many standard errors.
DIFFERENCE_LIMIT, SIGNIFICANCE_LIMIT = 5, 5
# FLIP travels as bytes: 0 to 254, and one that stands for pixels that are not finite.
FLIP_ONE, FLIP_NONE = 254, 255
# Without JavaScript the page shows this many regions.
MOST_STATIC_ROWS = 40
# The outcomes, the most urgent first.
URGENCY = ("DIFFERENT", "UNDECIDED", "EXPLAINED", "EQUIVALENT")
GRIDS = ("block", "cell")


def moments_of(comparison: Comparison | Interim, part: Part | None = None) -> tuple[Moments, Moments]:
    """Both sides' moments of the pixels.

    They are those of a `part` of the light, if that is compared, or of the image.
    """
    reference, candidate = (
        side.film.moments if part is None else side.pass_films.get(part, side.film.moments)
        for side in (comparison.reference, comparison.candidate)
    )
    return reference, candidate


def shown_means(comparison: Comparison, part: Part | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Both sides' means (height, width, 3), of the image or of a `part` of its light.

    NaN where pixels are not compared or not finite.
    """
    first, second = moments_of(comparison, part)
    if not comparison.left_out.any():
        return first.mean, second.mean
    reference, candidate = (np.where(comparison.left_out[..., None], np.nan, one.mean) for one in (first, second))
    return reference, candidate


def significances(comparison: Comparison, step: int = 1) -> np.ndarray:
    """The significances (rows, columns, 3) of the images' means of `step` x `step` pixels.

    They are those of `pixel_significances`.
    """
    return pixel_significances(shown_means(comparison), moments_of(comparison), step)


def label_maps(comparison: Comparison, step: int) -> tuple[list[str], np.ndarray]:
    """The kinds of regions that the user named, and a map of each.

    The maps (kinds, rows, columns) are uint16. A pixel holds one more than the place in the list of the region that
    covers most of it, and 0 where there is none.
    """
    regions = comparison.regions
    kinds = list(dict.fromkeys(np.array(regions.kinds, object)[regions.families == 1]))
    labels = np.zeros((len(kinds), regions.shape[0] * regions.shape[1]), np.uint16)
    for found, kind in zip(labels, kinds, strict=True):
        most = np.zeros(found.size)
        for k in regions.indices(kind):
            start, end = regions.weights.indptr[k : k + 2]
            pixels, weights = regions.weights.indices[start:end], regions.weights.data[start:end]
            larger = weights > most[pixels]
            most[pixels[larger]] = weights[larger]
            found[pixels[larger]] = k + 1
    return kinds, labels.reshape(-1, *regions.shape)[:, ::step, ::step]


def order_regions(regions: list[dict[str, Any]]) -> list[int]:
    """The places of regions in the order in which the page opens.

    It is the order of compareUrgency in report/calculations.js. Regions that are not equivalent come first, named
    regions before blocks. Then undecided ones are sorted by the largest bound, others by the largest difference.
    """

    def extent(region: dict[str, Any]) -> float:
        if region["outcome"] != Outcome.UNDECIDED.value:
            return max((abs(v) for v in region["difference"] if v is not None), default=-1.0)
        if region["bound"] is not None:
            return region["bound"]
        return math.inf if region["pixels"] > region["excluded_pixels"] else -1.0

    def urgency(k: int) -> tuple[int, bool, float, int]:
        region = regions[k]
        return URGENCY.index(region["outcome"]), region["kind"] in GRIDS, -extent(region), k

    return sorted(range(len(regions)), key=urgency)


def _worst(region: dict[str, Any]) -> int:
    """The channel in which a region is furthest off.

    It is that of worstChannel in report/calculations.js.
    """
    return int(worst_channel(np.array(region["difference"], float)))


def shorten_region(region: dict[str, Any]) -> dict[str, Any]:
    """A region of verdict.json as the page's script reads it.

    It has the same names and six significant digits.
    """

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


def render_report(comparison: Comparison, figures: dict[str, Any], transform: ViewTransform | None) -> str:
    """Render the page as text.

    `figures` are those of verdict.json, `transform` is the view transform of the user's scene.
    """
    height, width = comparison.regions.shape
    step = 1
    while -(-height // step) * -(-width // step) > MOST_PIXELS:
        step += 1
    images = [averaged(mean, step) for mean in shown_means(comparison)]
    exposure = round(2 * middle_exposure(images[0])) / 2
    passes, pass_step = draw_passes(comparison, step, MOST_PIXELS, DIFFERENCE_LIMIT * comparison.verdict.tolerance)
    seen = flip(images[0], images[1], exposure)
    kinds, labels = label_maps(comparison, step)
    shots, told = _shots(images, exposure, transform)
    regions = [shorten_region(region) for region in figures["regions"]]
    order = order_regions(regions)
    shot = _difference_shot(comparison, images)
    hatch = np.isnan(images[0]).any(axis=2) | np.isnan(images[1]).any(axis=2)
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
        "significance": {"one": SIGNIFICANCE_ONE, "none": SIGNIFICANCE_NONE, "limit": SIGNIFICANCE_LIMIT},
        "transform": transform.name if transform is not None and not told else None,
        "names": [comparison.reference.name, comparison.candidate.name],
        "kinds": kinds,
        "error": {"steps": ERROR_STEPS, "one": ERROR_ONE, "none": ERROR_NONE, "zero": ERROR_ZERO},
        "passes": [one.view for one in passes],
        "passStep": pass_step,
        "regions": regions,
    }
    values = {
        "figures": figures,
        "view": view,
        "counts": {name: sum(region["outcome"] == name for region in regions) for name in URGENCY},
        "rows": [(k, {**regions[k], "worst": _worst(regions[k])}) for k in order[:MOST_STATIC_ROWS]],
        "transform_note": told,
        "omitted": transform.omitted if transform is not None and not told else (),
        "curve": draw_bound(comparison.history, comparison.verdict.tolerance),
        "shots": [write_shot(hatched(image, hatch)) for image in (*shots, shot)],
        "passes": passes,
        "errors": pack_errors(moments_of(comparison), step) if passes else (),
        "floats": [pack_floats(image) for image in images],
        "flip": pack(np.where(np.isnan(seen), FLIP_NONE, np.rint(FLIP_ONE * np.nan_to_num(seen))).astype(np.uint8)),
        "significance": pack(code_significances(significances(comparison, step))),
        "labels": pack(labels.astype("<u2")),
    }
    return render_page(Path(__file__).with_name("report.html"), values)


def _shots(images: list[np.ndarray], exposure: float, transform: ViewTransform | None) -> tuple[list[np.ndarray], str]:
    """Both images as the scene wants them shown, and why they are not, if they are not."""
    plain = [srgb8(image, exposure) for image in images]
    if transform is None:
        return plain, ""
    try:
        # In one call, which reads the colour configuration once.
        shots = np.split(transform.apply(np.concatenate(images)), len(images))
    except EtalonError as error:
        return plain, str(error)
    return shots, ""


def _difference_shot(comparison: Comparison, images: list[np.ndarray]) -> np.ndarray:
    verdict, (reference, candidate) = comparison.verdict, images
    limit = DIFFERENCE_LIMIT * verdict.tolerance
    difference = relative_difference(candidate - reference, reference, verdict.floor)
    return signed8(np.clip(difference, -limit, limit).mean(axis=2), limit)
