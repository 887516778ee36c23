# SPDX-License-Identifier: GPL-3.0-or-later
"""The images of a comparison for Blender's Image editor: radiance as float images, and what differs as maps in colours.

Reference and Cycles are scene-linear OpenEXR files of three channels. The maps have the colours of the report.
"""

from __future__ import annotations

from enum import Enum
from pathlib import Path

import numpy as np

from ..comparison.compare import Comparison, Interim
from ..film.exr import RADIANCE, write_exr
from ..film.pictures import hatched, signed8, write_png
from ..relative import relative_difference
from ..verdict.outcome import Outcome
from .page import DIFFERENCE_LIMIT, SIGNIFICANCE_LIMIT, shown_means, significances

# As in the report: blue-green agrees, red differs, yellow is undecided, violet is explained (after Okabe and Ito 2008).
OUTCOME_COLOURS = {
    Outcome.EQUIVALENT: (0, 158, 115),
    Outcome.DIFFERENT: (213, 94, 0),
    Outcome.UNDECIDED: (240, 228, 66),
    Outcome.EXPLAINED: (0, 114, 178),
}
NOTHING = (60, 60, 60)


class View(Enum):
    """The images, by the names of their files."""

    REFERENCE = "reference.exr"
    CYCLES = "cycles.exr"
    DIFFERENCE = "difference.png"
    SIGNIFICANCE = "significance.png"
    VERDICT = "verdict.png"


def write_views(comparison: Comparison, folder: Path) -> None:
    """Write all images of a comparison into `folder`, which is made if it is not there; raises EtalonError where that fails."""
    folder.mkdir(parents=True, exist_ok=True)
    means = shown_means(comparison)
    _write_means(means, folder)
    difference = relative_difference(means[1] - means[0], means[0], comparison.verdict.floor)
    maps = {
        View.DIFFERENCE: _signed(difference, DIFFERENCE_LIMIT * comparison.verdict.tolerance),
        View.SIGNIFICANCE: _signed(significances(comparison), SIGNIFICANCE_LIMIT),
        View.VERDICT: verdict_map(comparison),
    }
    for view, pixels in maps.items():
        write_png(folder / view.value, hatched(pixels, comparison.left_out))


def write_interim(interim: Interim, folder: Path) -> None:
    """Write the two images as they are at a look."""
    folder.mkdir(parents=True, exist_ok=True)
    _write_means((interim.reference.film.moments.mean, interim.candidate.film.moments.mean), folder)


def verdict_map(comparison: Comparison) -> np.ndarray:
    """The outcome of the block that each pixel lies in, as uint8 colours (height, width, 3); grey where there is none."""
    regions = comparison.regions
    out = np.full((regions.shape[0] * regions.shape[1], 3), NOTHING, np.uint8)
    for k in regions.indices("block"):
        start, end = regions.weights.indptr[k : k + 2]
        out[regions.weights.indices[start:end]] = OUTCOME_COLOURS[comparison.verdict.outcomes.item(k)]
    return out.reshape(*regions.shape, 3)


def _write_means(means: tuple[np.ndarray, np.ndarray], folder: Path) -> None:
    for view, mean in zip((View.REFERENCE, View.CYCLES), means, strict=True):
        write_exr(folder / view.value, {name: mean[..., c] for c, name in enumerate("RGB")}, RADIANCE)


def _signed(values: np.ndarray, limit: float) -> np.ndarray:
    """The mean over the channels of (height, width, 3), each clipped at +-limit, as colours."""
    return signed8(np.clip(values, -limit, limit).mean(axis=2), limit)
