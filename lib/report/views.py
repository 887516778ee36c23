# SPDX-License-Identifier: GPL-3.0-or-later
"""The images of a comparison for Blender's Image editor.

They are float images, scene-linear OpenEXR files of three channels. Reference and Cycles hold radiance. Difference and
significance hold their value in red where it is positive, in blue where it is negative, without a limit above, so that
the editor's exposure brings out small values.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import numpy as np

from ..comparison.compare import Comparison
from ..comparison.interim import Interim
from ..film.exr import RADIANCE, Meaning, write_exr
from ..film.moments import Moments
from ..film.parts import Part
from ..film.pictures import hatched
from ..film.regions import Regions
from ..relative import relative_difference
from ..srgb import srgb_decode
from ..verdict.outcome import Outcome
from .page import DIFFERENCE_LIMIT, SIGNIFICANCE_LIMIT, moments_of, shown_means
from .pixels import pixel_significances

# As in the report: blue-green agrees, red differs, yellow is undecided, violet is explained (after Okabe and Ito 2008).
OUTCOME_COLOURS = {
    Outcome.EQUIVALENT: (0, 158, 115),
    Outcome.DIFFERENT: (213, 94, 0),
    Outcome.UNDECIDED: (240, 228, 66),
    Outcome.EXPLAINED: (0, 114, 178),
}
NOTHING = (60, 60, 60)
MAP = Meaning(
    "1",
    "R: the value where it is positive, B: its negative where it is negative, in the unit in which 1 is full colour. "
    "Magenta where pixels have no value.",
    "lin_rec709_scene",
)
COLOURS = Meaning("1", "The outcome of the block that each pixel lies in, as a colour.", "lin_rec709_scene")
# Values of maps end here: a difference relative to black has no bound.
MOST = 1e4


class View(Enum):
    """The images, by the names of their files."""

    REFERENCE = "reference.exr"
    CYCLES = "cycles.exr"
    DIFFERENCE = "difference.exr"
    SIGNIFICANCE = "significance.exr"
    VERDICT = "verdict.exr"


@dataclass(frozen=True, eq=False)
class _State:
    """The data that the images show, of a comparison that is concluded or under way.

    `outcomes` (K,) are those of the regions.
    """

    means: tuple[np.ndarray, np.ndarray]
    moments: tuple[Moments, Moments]
    regions: Regions
    outcomes: np.ndarray
    floor: np.ndarray
    tolerance: float
    left_out: np.ndarray


def write_views(comparison: Comparison, folder: Path, part: Part | None = None) -> None:
    """Write all images of a comparison into `folder`, which is made if it does not exist.

    They are those of a `part` of the light, if it is compared; the verdict is that of the whole image. Raises EtalonError
    where that fails.
    """
    verdict = comparison.verdict
    state = _State(
        shown_means(comparison, part),
        moments_of(comparison, part),
        comparison.regions,
        verdict.outcomes,
        verdict.floor,
        verdict.tolerance,
        comparison.left_out,
    )
    _write(state, folder)


def write_interim(interim: Interim, folder: Path, part: Part | None = None) -> None:
    """Write all images, or those of a `part` of the light, as they are at a look.

    Raises EtalonError where that fails.
    """
    moments = moments_of(interim, part)
    means = moments[0].mean, moments[1].mean
    state = _State(
        means, moments, interim.regions, interim.outcomes, interim.floor, interim.tolerance, interim.left_out
    )
    _write(state, folder)


def _write(state: _State, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for view, mean in zip((View.REFERENCE, View.CYCLES), state.means, strict=True):
        _write_colours(folder / view.value, mean, RADIANCE)
    reference, candidate = state.means
    difference = relative_difference(candidate - reference, reference, state.floor)
    significance = pixel_significances(state.means, state.moments)
    for view, values, limit in (
        (View.DIFFERENCE, difference, DIFFERENCE_LIMIT * state.tolerance),
        (View.SIGNIFICANCE, significance, SIGNIFICANCE_LIMIT),
    ):
        _write_colours(folder / view.value, _striped(signed_colours(values, limit), state.left_out), MAP)
    verdict = srgb_decode(hatched(verdict_map(state.regions, state.outcomes), state.left_out) / 255.0)
    _write_colours(folder / View.VERDICT.value, verdict, COLOURS)


def signed_colours(values: np.ndarray, limit: float) -> np.ndarray:
    """The mean over the channels of (height, width, 3), as float colours.

    Red above 0, blue below, 1 at `limit`; magenta where NaN.
    """
    mean = np.clip(values / limit, -MOST, MOST).mean(axis=2)
    colours = np.stack([np.maximum(mean, 0.0), np.zeros_like(mean), np.maximum(-mean, 0.0)], axis=2)
    return np.where(np.isnan(mean)[..., None], (1.0, 0.0, 1.0), colours)


def _striped(colours: np.ndarray, left_out: np.ndarray) -> np.ndarray:
    """Float colours with the report's stripes over what is left out."""
    stripes = srgb_decode(hatched(np.zeros(colours.shape, np.uint8), left_out) / 255.0)
    return np.where(left_out[..., None], stripes, colours)


def verdict_map(regions: Regions, outcomes: np.ndarray) -> np.ndarray:
    """The outcome of each pixel's block, as uint8 colours (height, width, 3).

    Grey where there is none.
    """
    out = np.full((regions.shape[0] * regions.shape[1], 3), NOTHING, np.uint8)
    for k in regions.indices("block"):
        start, end = regions.weights.indptr[k : k + 2]
        out[regions.weights.indices[start:end]] = OUTCOME_COLOURS[outcomes.item(k)]
    return out.reshape(*regions.shape, 3)


def _write_colours(path: Path, colours: np.ndarray, meaning: Meaning) -> None:
    write_exr(path, {name: colours[..., c] for c, name in enumerate("RGB")}, meaning)
