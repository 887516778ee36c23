# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Color Ramp, exact between its stops.

Cycles looks it up in a table of 257 entries with linear interpolation (none for 'CONSTANT'), which rounds off every corner
and moves every step by up to 1/256; this is the function itself.
"""

from __future__ import annotations

import numpy as np

from ..scene.expressions import ColorRamp
from .color_spaces import hsl_to_rgb, hsv_to_rgb, rgb_to_hsl, rgb_to_hsv

_CARDINAL_TENSION = 0.71


def color_ramp(ramp: ColorRamp, factor: np.ndarray) -> np.ndarray:
    """Return the colour (3, n) or alpha (n,) of `ramp` at `factor`.

    `factor` is a value of shape () or (n,), clamped to 0..1.
    """
    x = np.clip(np.atleast_1d(factor), 0.0, 1.0)
    rgba = _rgba(ramp, x)
    if ramp.output == "COLOR":
        return rgba[:3]
    return rgba[3].reshape(np.shape(factor))


def _rgba(ramp: ColorRamp, x: np.ndarray) -> np.ndarray:
    positions = np.array(ramp.positions)
    stops = np.array(ramp.colors)
    count = positions.size
    right = np.searchsorted(positions, x, side="right")  # the first stop beyond x
    left = np.maximum(right - 1, 0)
    interpolation = ramp.interpolation if ramp.mode == "RGB" else "LINEAR"
    if count == 1 or interpolation == "CONSTANT":
        return _rows(stops, left)

    after = np.minimum(right, count - 1)
    if interpolation in ("CARDINAL", "B_SPLINE"):
        # The curve starts before the first stop and ends after the last: both repeat, at 0 and at 1.
        start = np.where(right == 0, 0.0, positions[left])
        end = np.where(right == count, 1.0, positions[after])
        t = np.where(end > start, (x - start) / np.where(end > start, end - start, 1.0), 0.0)
        neighbours = (np.maximum(right - 2, 0), left, after, np.minimum(right + 1, count - 1))
        weights = _spline_weights(np.clip(t, 0.0, 1.0), interpolation)
        return np.clip(sum(w * _rows(stops, i) for w, i in zip(weights, neighbours, strict=True)), 0.0, 1.0)

    span = positions[after] - positions[left]
    t = np.where(span > 0, (x - positions[left]) / np.where(span > 0, span, 1.0), 0.0)
    if interpolation == "EASE":
        t = t * t * (3 - 2 * t)
    if ramp.mode == "RGB":
        return (1 - t) * _rows(stops, left) + t * _rows(stops, after)
    return _hue_ramp(ramp, stops, left, after, t)


def _spline_weights(t: np.ndarray, interpolation: str) -> tuple[np.ndarray, ...]:
    """Return the weights of the four stops around.

    The spline is a uniform cubic B-spline, or a cardinal spline of tension 0.71.
    """
    s = 1 - t
    if interpolation == "B_SPLINE":
        return (s**3 / 6, (4 - 6 * t * t + 3 * t**3) / 6, (4 - 6 * s * s + 3 * s**3) / 6, t**3 / 6)
    k = _CARDINAL_TENSION
    return (
        -k * t * s * s,
        1 + t * t * ((2 - k) * t + k - 3),
        1 + s * s * ((2 - k) * s + k - 3),
        -k * s * t * t,
    )


def _hue_ramp(ramp: ColorRamp, stops: np.ndarray, left: np.ndarray, right: np.ndarray, t: np.ndarray) -> np.ndarray:
    to_hue, from_hue = (rgb_to_hsv, hsv_to_rgb) if ramp.mode == "HSV" else (rgb_to_hsl, hsl_to_rgb)
    hues = np.concatenate([to_hue(stops[:, :3].T), stops[None, :, 3]]).T
    a, b = _rows(hues, left), _rows(hues, right)
    mixed = (1 - t) * a + t * b
    mixed[0] = (a[0] + t * _hue_step(b[0] - a[0], ramp.hue)) % 1
    # Outside the stops there is no interpolation, so the stop's own colour comes back untouched by the round trip.
    color = np.where(left == right, _rows(stops, left)[:3], from_hue(mixed[:3]))
    return np.concatenate([color, mixed[3:]])


def _rows(table: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Rows `index` (n,) of `table` (m, 4), turned to (4, n)."""
    return np.ascontiguousarray(table.take(index, axis=0, mode="clip").T)


def _hue_step(difference: np.ndarray, direction: str) -> np.ndarray:
    """Return how far to turn from one hue to the next.

    Near and far ways, or always falling (CCW) or always growing (CW).
    """
    if direction == "NEAR":
        return difference - (difference > 0.5) + (difference < -0.5)
    if direction == "CCW":
        return difference - (difference > 0)
    if direction == "CW":
        return difference + (difference < 0)
    return difference - ((difference > 0) & (difference < 0.5)) + ((difference <= 0) & (difference > -0.5))
