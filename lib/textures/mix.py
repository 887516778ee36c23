# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Mix node: the blend types on colours, as Cycles computes them.

Each takes the factor t, () or (n,), and colours a and b, (3, 1) or (3, n). The separable formulas are those of the PDF blend
modes (ISO 32000-1, 11.3.5), extended by Blender to colours outside 0..1.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .color_spaces import hsv_to_rgb, rgb_to_hsv


def lerp(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(1 - t) a + t b."""
    return (1 - t) * a + t * b


def _overlay(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    dark = a * (1 - t + 2 * t * b)
    light = 1 - (1 - t + 2 * t * (1 - b)) * (1 - a)
    return np.where(a < 0.5, dark, light)


def _divide(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.where(b != 0, lerp(t, a, a / np.where(b == 0, 1.0, b)), a)


def _dodge(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    rest = 1 - t * b
    lit = np.where(rest > 0, np.minimum(a / np.where(rest > 0, rest, 1.0), 1), 1.0)
    return np.where(a != 0, lit, a)


def _burn(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    rest = 1 - t + t * b
    return np.where(rest > 0, np.clip(1 - (1 - a) / np.where(rest > 0, rest, 1.0), 0, 1), 0.0)


def _soft_light(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    screen = 1 - (1 - b) * (1 - a)
    return lerp(t, a, (1 - a) * b * a + a * screen)


def _hue(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    a, b = np.broadcast_arrays(a, b)
    hsv_a, hsv_b = rgb_to_hsv(a), rgb_to_hsv(b)
    return np.where(hsv_b[1] != 0, lerp(t, a, hsv_to_rgb(np.stack([hsv_b[0], hsv_a[1], hsv_a[2]]))), a)


def _saturation(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    t, a, b = np.broadcast_arrays(t, a, b)
    hsv_a, hsv_b = rgb_to_hsv(a), rgb_to_hsv(b)
    return np.where(hsv_a[1] != 0, hsv_to_rgb(np.stack([hsv_a[0], lerp(t[0], hsv_a[1], hsv_b[1]), hsv_a[2]])), a)


def _value(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    t, a, b = np.broadcast_arrays(t, a, b)
    hsv_a = rgb_to_hsv(a)
    return hsv_to_rgb(np.stack([hsv_a[0], hsv_a[1], lerp(t[0], hsv_a[2], b.max(axis=0))]))


def _color(t: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    a, b = np.broadcast_arrays(a, b)
    hsv_b = rgb_to_hsv(b)
    return np.where(hsv_b[1] != 0, lerp(t, a, hsv_to_rgb(np.stack([hsv_b[0], hsv_b[1], a.max(axis=0)]))), a)


BLENDS: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]] = {
    "MIX": lerp,
    "DARKEN": lambda t, a, b: lerp(t, a, np.minimum(a, b)),
    "MULTIPLY": lambda t, a, b: a * (1 - t + t * b),
    "BURN": _burn,
    "LIGHTEN": lambda t, a, b: lerp(t, a, np.maximum(a, b)),
    "SCREEN": lambda t, a, b: 1 - (1 - t + t * (1 - b)) * (1 - a),
    "DODGE": _dodge,
    "ADD": lambda t, a, b: a + t * b,
    "OVERLAY": _overlay,
    "SOFT_LIGHT": _soft_light,
    "LINEAR_LIGHT": lambda t, a, b: a + t * (2 * b - 1),
    "DIFFERENCE": lambda t, a, b: lerp(t, a, np.abs(a - b)),
    "EXCLUSION": lambda t, a, b: np.maximum(lerp(t, a, a + b - 2 * a * b), 0),
    "SUBTRACT": lambda t, a, b: a - t * b,
    "DIVIDE": _divide,
    "HUE": _hue,
    "SATURATION": _saturation,
    "COLOR": _color,
    "VALUE": _value,
}
"""Blend by Blender's identifier."""


def mix(blend: str, t: np.ndarray, a: np.ndarray, b: np.ndarray, clamp_factor: bool, clamp_result: bool) -> np.ndarray:
    """The Mix node: `a` blended with `b` by the factor `t`; values with 'MIX' only."""
    if clamp_factor:
        t = np.clip(t, 0.0, 1.0)
    result = BLENDS[blend](t, a, b)
    return np.clip(result, 0.0, 1.0) if clamp_result else result
