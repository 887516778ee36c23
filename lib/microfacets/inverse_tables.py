# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of starting points for inverses that have no closed form.

One step on the exact distribution then completes the inversion.
The level of a uniform u is l / sqrt(2 + |l|) with l = log(u / (1 - u)): it goes to both ends as Gaussian slopes do.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..sampling.tables import LARGEST_UNIFORM
from ..vectors import gather

LEAST_UNIFORM = 0.5 - 0.5 * LARGEST_UNIFORM
"""With LARGEST_UNIFORM the bounds of the u that have a finite logit."""
_LIMIT = float(np.log(LARGEST_UNIFORM / (1.0 - LARGEST_UNIFORM)))
LARGEST_LEVEL = float(_LIMIT / np.sqrt(2.0 + _LIMIT) * (1.0 + 1e-6))
"""The level of LARGEST_UNIFORM, and a little more."""
_VIEWS, _LEVELS = 128, 256  # cells of a table of views along 1 / (1 + a), and along u


def level(u: np.ndarray) -> np.ndarray:
    """The level of `u` (n,) in [LEAST_UNIFORM, LARGEST_UNIFORM], within +-LARGEST_LEVEL."""
    logit = np.log(u / (1.0 - u))
    return logit / np.sqrt(2.0 + np.abs(logit))


class ViewTable:
    """A quantity that grows with s = 1 / (1 + a) and with u.

    It has 129 x 257 nodes, spaced evenly in s and in the level of u.
    """

    def __init__(self, invert: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> None:
        """`invert(s, above)` gives the quantity at `s` (k, 1) and 1 - u = `above` (m,), (k, m)."""
        s = np.linspace(0.0, 1.0, _VIEWS + 1)[:, None]
        x = invert(s, self.share_above(np.linspace(-LARGEST_LEVEL, LARGEST_LEVEL, _LEVELS + 1)))
        # Rounding may have broken, by 1e-8, the order that makes the corners a bracket.
        x = np.maximum.accumulate(np.maximum.accumulate(x, axis=0), axis=1)
        self._table = np.ascontiguousarray(x).ravel()
        self._table.flags.writeable = False
        self._scale = _LEVELS / (2.0 * LARGEST_LEVEL)

    @staticmethod
    def share_above(level: np.ndarray) -> np.ndarray:
        """1 - u for a `level`, shaped as it."""
        square = level * level
        logit = np.copysign(0.5 * (square + np.sqrt(square * (square + 8.0))), level)
        return 1.0 / (1.0 + np.exp(logit))

    def bracket(self, s: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The bilinear value at `s` and `u`, (n,) each, and the corner values below and above it."""
        table = self._table
        along = 0.5 * _LEVELS + self._scale * level(u)
        across = s * _VIEWS
        column = along.astype(np.intp)
        row = np.minimum(across.astype(np.intp), _VIEWS - 1)
        along -= column
        across -= row
        corner = row * (_LEVELS + 1) + column
        low, near = gather(table, corner), gather(table, corner + 1)
        far, high = gather(table, corner + (_LEVELS + 1)), gather(table, corner + (_LEVELS + 2))
        here, beyond = low + (near - low) * along, far + (high - far) * along
        return here + (beyond - here) * across, low, high


class Spline:
    """A function on [0, 1] by cubic pieces between evenly spaced nodes.

    The pieces join smoothly.
    """

    def __init__(self, values: np.ndarray) -> None:
        """`values` (k + 1,) at the nodes."""
        from scipy.interpolate import CubicSpline

        self._cells = values.size - 1
        self._pieces = np.ascontiguousarray(CubicSpline(np.arange(values.size), values).c)
        self._pieces.flags.writeable = False

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """The function at `x` (n,) in [0, 1], (n,)."""
        at = x * self._cells
        cell = at.astype(np.intp)
        np.minimum(cell, self._cells - 1, out=cell)
        at -= cell
        value = gather(self._pieces[0], cell)
        for piece in self._pieces[1:]:
            value *= at
            value += gather(piece, cell)
        return value


class MaskingTable:
    """Smith's Lambda at even steps of 1 - (b / (b + a))^(1/4), a = cot(theta) / alpha.

    In this variable even the heaviest tail ends smoothly.
    It holds Lambda a / (a + b), which is bounded at both ends. `b` is about where Lambda changes most.
    """

    def __init__(self, scale: float, cells: int, masked: Callable[[np.ndarray], np.ndarray]) -> None:
        """`masked(a)` gives a Lambda(a), (cells,), at a >= 0; `scale` is b."""
        self.scale = scale
        a = self.slope(np.linspace(0.0, 1.0, cells + 1)[:-1])
        self._values = Spline(np.append(masked(a) / (a + scale), 0.0))

    def slope(self, kappa: np.ndarray) -> np.ndarray:
        """The a of a coordinate in [0, 1)."""
        return self.scale / np.square(np.square(1.0 - kappa)) - self.scale

    def coordinate(self, sine: np.ndarray, cosine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The coordinate in [0, 1] of the view, and a + b times `sine`, (n,) each."""
        part = self.scale * sine
        end = part + cosine
        part /= end
        np.sqrt(part, out=part)
        np.sqrt(part, out=part)
        return np.subtract(1.0, part, out=part), end

    def __call__(self, sine: np.ndarray, cosine: np.ndarray) -> np.ndarray:
        """Smith's Lambda, (n,).

        `sine` >= 0 and `cosine` > 0, (n,), are those of the view to the stretched surface, up to a common factor.
        """
        kappa, end = self.coordinate(sine, cosine)
        value = self._values(kappa)
        value *= end
        value /= cosine
        return np.maximum(value, 0.0, out=value)
