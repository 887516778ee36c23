# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour transforms: luminance, HSV and HSL."""

from __future__ import annotations

import numpy as np

LUMINANCE_REC709 = (0.2126390058715103, 0.7151686787677559, 0.0721923153607337)
"""Y of linear Rec. 709 with white D65 (0.3127, 0.3290); the rounded form is ITU-R BT.709's 0.2126, 0.7152, 0.0722."""
# Of the rows v, p, q, t of `hsv_to_rgb`: red, green and blue in each of the six sectors.
_SECTORS = np.array([(0, 2, 1, 1, 3, 0), (3, 0, 0, 2, 1, 1), (1, 1, 3, 0, 0, 2)])


def luminance(color: np.ndarray) -> np.ndarray:
    """Luminance of linear Rec. 709 `color` (3, n): (n,)."""
    r, g, b = LUMINANCE_REC709
    return r * color[0] + g * color[1] + b * color[2]


def hue(color: np.ndarray) -> np.ndarray:
    """Return the hue in [0, 1) of `color` (3, n), 0 for greys.

    Smith, "Color Gamut Transform Pairs", SIGGRAPH 1978.
    """
    r, g, b = color
    top = color.max(axis=0)
    span = top - color.min(axis=0)
    span = np.where(span == 0, 1.0, span)
    sector = np.where(r == top, (g - b) / span, np.where(g == top, 2 + (b - r) / span, 4 + (r - g) / span))
    return sector / 6 % 1


def rgb_to_hsv(color: np.ndarray) -> np.ndarray:
    """Hue, saturation, value of `color` (3, n)."""
    top = color.max(axis=0)
    span = top - color.min(axis=0)
    saturation = np.where(top != 0, span / np.where(top == 0, 1.0, top), 0.0)
    return np.stack([np.where(saturation != 0, hue(color), 0.0), saturation, top])


def hsv_to_rgb(hsv: np.ndarray) -> np.ndarray:
    """Return the colour (3, n) of hue, saturation, value (3, n).

    It is the inverse of `rgb_to_hsv` for hues of 0..1.

    The circle of hues is cut into six sectors. A hue outside 0..1 belongs to the last sector, at its place in its own
    sector, as in Blender's nodes.
    """
    h, s, v = hsv
    turn = np.where(h == 1.0, 0.0, h) * 6
    sector = np.floor(turn)
    f = turn - sector
    sector = np.where((sector >= 0) & (sector < 5), sector, 5).astype(np.intp)
    p, q, t = v * (1 - s), v * (1 - s * f), v * (1 - s * (1 - f))
    rows = np.stack(np.broadcast_arrays(v, p, q, t))
    picked = np.take_along_axis(rows, np.broadcast_to(_SECTORS[:, sector], (3, *rows.shape[1:])), axis=0)
    return np.where(s == 0, v, picked)


def rgb_to_hsl(color: np.ndarray) -> np.ndarray:
    """Return hue, saturation, lightness of `color` (3, n).

    Lightness is at most 1, and saturation is infinite where its scale is 0.
    """
    top, bottom = color.max(axis=0), color.min(axis=0)
    span, lightness = top - bottom, np.minimum(0.5 * (top + bottom), 1.0)
    scale = np.where(lightness > 0.5, 2 - top - bottom, top + bottom)
    with np.errstate(divide="ignore"):
        saturation = np.where(span != 0, span / np.where(span == 0, 1.0, scale), 0.0)
    return np.stack([hue(color), saturation, lightness])


def hsl_to_rgb(hsl: np.ndarray) -> np.ndarray:
    """Return the colour (3, n) of hue, saturation, lightness (3, n).

    It is the inverse of `rgb_to_hsl` for hues of 0..1.
    """
    h, s, lightness = hsl
    chroma = (1 - np.abs(2 * lightness - 1)) * s
    return (_hue_to_pure(h) - 0.5) * chroma + lightness


def _hue_to_pure(h: np.ndarray) -> np.ndarray:
    """The fully saturated colour of hue `h`: three shifted trapezoids in [0, 1]."""
    h = h * 6
    return np.clip(np.stack([np.abs(h - 3) - 1, 2 - np.abs(h - 2), 2 - np.abs(h - 4)]), 0, 1)
