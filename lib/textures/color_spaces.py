# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour transforms: luminance, HSV and HSL."""

from __future__ import annotations

import numpy as np

LUMINANCE_REC709 = (0.2126390058715103, 0.7151686787677559, 0.0721923153607337)
"""Y of linear Rec. 709 with white D65 (0.3127, 0.3290); the rounded form is ITU-R BT.709's 0.2126, 0.7152, 0.0722."""


def luminance(color: np.ndarray) -> np.ndarray:
    """Luminance of linear Rec. 709 `color` (3, n): (n,)."""
    r, g, b = LUMINANCE_REC709
    return r * color[0] + g * color[1] + b * color[2]


def hue(color: np.ndarray) -> np.ndarray:
    """Hue in [0, 1) of `color` (3, n), 0 for greys. Smith, "Color Gamut Transform Pairs", SIGGRAPH 1978."""
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
    """Inverse of `rgb_to_hsv`; hue is periodic with period 1."""
    h, s, v = hsv
    return v * (1 - s * (1 - _hue_to_pure(h)))


def rgb_to_hsl(color: np.ndarray) -> np.ndarray:
    """Hue, saturation, lightness of `color` (3, n)."""
    top, bottom = color.max(axis=0), color.min(axis=0)
    span, lightness = top - bottom, 0.5 * (top + bottom)
    scale = np.where(lightness > 0.5, 2 - top - bottom, top + bottom)
    saturation = np.where(span != 0, span / np.where(scale == 0, 1.0, scale), 0.0)
    return np.stack([hue(color), saturation, lightness])


def hsl_to_rgb(hsl: np.ndarray) -> np.ndarray:
    """Inverse of `rgb_to_hsl`; hue is periodic with period 1."""
    h, s, lightness = hsl
    chroma = (1 - np.abs(2 * lightness - 1)) * s
    return (_hue_to_pure(h) - 0.5) * chroma + lightness


def _hue_to_pure(h: np.ndarray) -> np.ndarray:
    """The fully saturated colour of hue `h`: three shifted trapezoids in [0, 1]."""
    h = h % 1 * 6
    return np.clip(np.stack([np.abs(h - 3) - 1, 2 - np.abs(h - 2), 2 - np.abs(h - 4)]), 0, 1)
