# SPDX-License-Identifier: GPL-3.0-or-later
"""A map of what an eye would notice, to look at: no verdict rests on it.

Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild, "FLIP: A Difference Evaluator for Alternating Images" (2020), by
its authors' own implementation, at its standard distance from the screen.
"""

from __future__ import annotations

import flip_evaluator
import numpy as np

from ..film.pictures import srgb8

# The evaluator holds the interpreter's lock, for 4 s of processor time at 1920 x 1080 pixels. A window beside it would
# stand still.
# So it gets a tile at a time, with as many pixels around it as its filters reach at 67 pixels per degree.
TILE, REACH = 256, 10


def flip(reference: np.ndarray, candidate: np.ndarray, exposure: float) -> np.ndarray:
    """LDR-FLIP (height, width), 0 to 1, of two radiances (height, width, 3).

    The radiances are shown as sRGB at `exposure` stops. NaN where one is not finite.
    """
    finite = np.isfinite(reference).all(axis=2) & np.isfinite(candidate).all(axis=2)
    shown = [
        srgb8(np.where(finite[..., None], image, 0.0), exposure).astype(np.float32) / 255.0
        for image in (reference, candidate)
    ]
    found = np.empty(finite.shape)
    for y in range(0, finite.shape[0], TILE):
        for x in range(0, finite.shape[1], TILE):
            found[y : y + TILE, x : x + TILE] = _flip_tile(shown[0], shown[1], y, x)
    return np.where(finite, found, np.nan)


def _flip_tile(reference: np.ndarray, candidate: np.ndarray, y: int, x: int) -> np.ndarray:
    """Return LDR-FLIP of the tile at row `y` and column `x`.

    The images hold all that its filters reach.
    """
    top, left = max(y - REACH, 0), max(x - REACH, 0)
    around = np.s_[top : y + TILE + REACH, left : x + TILE + REACH]
    one, other = np.ascontiguousarray(reference[around]), np.ascontiguousarray(candidate[around])
    found, _, _ = flip_evaluator.evaluate(one, other, "LDR", applyMagma=False, computeMeanError=False)
    return found[y - top : y - top + TILE, x - left : x - left + TILE, 0]
