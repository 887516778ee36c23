# SPDX-License-Identifier: GPL-3.0-or-later
"""A map of what an eye would notice, to look at: no verdict rests on it.

Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild, "FLIP: A Difference Evaluator for Alternating Images" (2020), by
its authors' own implementation, at its standard distance from the screen.
"""

from __future__ import annotations

import flip_evaluator
import numpy as np

from ..film.pictures import srgb8


def flip(reference: np.ndarray, candidate: np.ndarray, exposure: float) -> np.ndarray:
    """LDR-FLIP (height, width), 0 to 1, of two radiances (height, width, 3).

    The radiances are shown as sRGB at `exposure` stops. NaN where one is not finite.
    """
    finite = np.isfinite(reference).all(axis=2) & np.isfinite(candidate).all(axis=2)
    shown = [
        srgb8(np.where(finite[..., None], image, 0.0), exposure).astype(np.float32) / 255.0
        for image in (reference, candidate)
    ]
    found, _, _ = flip_evaluator.evaluate(shown[0], shown[1], "LDR", applyMagma=False, computeMeanError=False)
    return np.where(finite, found[..., 0].astype(float), np.nan)
