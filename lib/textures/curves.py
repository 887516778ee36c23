# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's RGB, Vector and Float Curves.

Each curve is a table that Blender makes, with straight lines beyond its ends.

Cycles has a table of its own, lib.departures.scene.tabulated_curves.
"""

from __future__ import annotations

import numpy as np

from ..scene.converters import Curve, Curves
from .context import InputEvaluator


def curve(node: Curve, x: np.ndarray) -> np.ndarray:
    """The curve's value at `x` of any shape."""
    table = np.array(node.table)
    last = table.size - 1
    position = np.clip((x - node.low) / (node.high - node.low), 0.0, 1.0) * last
    cell = np.clip(position, 0, last - 1).astype(np.intp)
    t = position - cell
    inside = (1.0 - t) * table[cell] + t * table[cell + 1]
    below = node.start[0] + node.start[1] * (x - node.low)
    above = node.end[0] + node.end[1] * (x - node.high)
    return np.where(x < node.low, below, np.where(x > node.high, above, inside))


def curve_of_channel(node: Curves, channel: int, x: np.ndarray) -> np.ndarray:
    """The curve of a channel at `x`, after the combined one where there is such."""
    return curve(node.channels[channel], x if node.combined is None else curve(node.combined, x))


def curves(node: Curves, read: InputEvaluator) -> np.ndarray:
    """Colours (3, n), or values () or (n,) where there is one curve."""
    factor, color = read(node.factor), read(node.color)
    if len(node.channels) == 1:
        changed = curve_of_channel(node, 0, color)
    else:
        changed = np.stack([curve_of_channel(node, k, row) for k, row in enumerate(color)])
    return (1.0 - factor) * color + factor * changed
