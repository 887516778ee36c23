# SPDX-License-Identifier: GPL-3.0-or-later
"""Student-t slopes at roughness 1: tail, Smith's Lambda, and sampling of visible slopes.

Visible slopes are sampled by inversion.
The slope x along any direction has the density
p(x) = C (1 + x^2 / (g - 1))^-(g - 1/2), C = Gamma(g - 1/2) / (Gamma(g - 1) sqrt(pi (g - 1))):
x sqrt(2) is Student's t with 2 g - 2 degrees of freedom. Above x lie T(x) of the slopes, an incomplete beta function,
and K(x), the integral of t p(t), is (g - 1 + x^2) p(x) / (2 g - 3). Then Smith's Lambda at a = cot(theta) is K(a) / a -
T(a), and of the slopes visible under a the mass a T(x) + K(x) lies above x (Ribardiere et al. 2017, eq. 13 and 14; the
incomplete beta function takes the place of their fit, eq. 22 and 23).

An incomplete beta function takes a microsecond, so each g has tables: of T and Lambda to 1e-11, and of where an
inversion starts. They are spaced evenly in kappa(x) = 1 - (b / (b + x))^(1/4), x >= 0, in which the heaviest tail still
ends smoothly.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from ..sampling.tables import LARGEST_UNIFORM
from .inverse_tables import LARGEST_LEVEL, LEAST_UNIFORM, MaskingTable, Spline, ViewTable, level

_CELLS = 2048
_LEVELS = 1024
_B = 1.5
_LARGEST_KAPPA = 1.0 - 1e-4  # a slope of 1.5e16: the normal lies down to 1e-16 radians
_ABOVE_END = 1e-10  # how far above -a the bracket begins at least: at -a itself the density is zero


def _kappa(x: np.ndarray) -> np.ndarray:
    """The tables' coordinate of x >= 0, in [0, 1)."""
    return 1.0 - np.sqrt(np.sqrt(_B / (_B + x)))


def _slope(kappa: np.ndarray) -> np.ndarray:
    """The x of either sign whose `_kappa` is |kappa|, which is bounded."""
    root = np.abs(kappa)
    np.minimum(root, _LARGEST_KAPPA, out=root)
    np.subtract(1.0, root, out=root)
    root *= root
    root *= root
    np.divide(_B, root, out=root)
    root -= _B
    return np.copysign(root, kappa, out=root)


def tail_by_beta(x: np.ndarray, g: float) -> np.ndarray:
    """The share T(x) of slopes above `x`, by the incomplete beta function.

    `x` (n,) of either sign.
    """
    from scipy.special import betainc

    beyond = 0.5 * betainc(g - 1.0, 0.5, (g - 1.0) / (g - 1.0 + x * x))
    return np.where(x < 0.0, 1.0 - beyond, beyond)


def lambda_by_beta(a: np.ndarray, g: float) -> np.ndarray:
    """Smith's Lambda at `a` = cot(theta) / alpha > 0, (n,), by the incomplete beta function.

    The table is made from it.
    C (g - 1) / ((2 g - 3) a) (1 + a^2 / (g - 1))^-(g - 3/2) - T(a), g > 3/2.
    """
    return np.maximum(_first_moment(a, g) / a - tail_by_beta(a, g), 0.0)


@functools.lru_cache(maxsize=64)
def _factor(g: float) -> float:
    """C (g - 1) / (2 g - 3)."""
    from scipy.special import beta

    return float(np.sqrt(g - 1.0) / (beta(g - 1.0, 0.5) * (2.0 * g - 3.0)))


def _first_moment(x: np.ndarray, g: float) -> np.ndarray:
    """K(x), (n,)."""
    return _factor(g) * np.power(1.0 + x * x / (g - 1.0), 1.5 - g)


@dataclass(frozen=True)
class SlopeTables:
    """The tables of one g.

    `tail` is T, `masking` is Lambda to 1e-11 of 1 + Lambda, `start` and `across` give the kappa of a slope.
    """

    g: float
    tail: Spline
    masking: MaskingTable
    start: ViewTable
    across: Spline

    def visible_tangent(self, sine: np.ndarray, cosine: np.ndarray, u: np.ndarray, lambda_o: np.ndarray) -> np.ndarray:
        """The x above which lies 1 - u of the visible normals, (n,).

        `u` in [0, 1]; `lambda_o` is Lambda of the view.
        `sine` > 0 and `cosine` > 0, (n,), of the viewing angle to the stretched surface, up to a common factor. One
        step by the parabola through value, slope and curvature, as for Beckmann.
        """
        g = self.g
        u = np.clip(u, LEAST_UNIFORM, LARGEST_UNIFORM)
        cot = cosine / sine
        s = 1.0 / (1.0 + cot)
        c = cot * s
        kappa, low, high = self.start.bracket(s, u)
        x, low, high = _slope(kappa), _slope(low), _slope(high)
        np.maximum(low, _ABOVE_END - cot, out=low)
        size = np.abs(kappa, out=kappa)
        below = np.flatnonzero(x < low)
        if below.size:
            x[below] = low[below]
            size[below] = _kappa(np.abs(x[below]))
        tail = self.tail(size)
        np.subtract(1.0, tail, out=tail, where=x < 0.0)
        square = x * x
        moment = np.power(1.0 + square * (1.0 / (g - 1.0)), 1.5 - g)
        moment *= _factor(g)
        # Times s: the mass above x that is too much, the density (a + x) p(x), and the density's slope over the density.
        tail *= c
        tail += s * moment
        tail -= (1.0 - u) * (c * (1.0 + lambda_o))
        weight = s * x
        weight += c
        square += g - 1.0
        tail *= square
        moment *= weight
        moment *= 2.0 * g - 3.0
        twice = np.multiply(2.0, np.divide(tail, moment, out=tail), out=tail)
        pull = np.divide(s, weight, out=weight)
        pull -= (2.0 * g - 1.0) * x / square
        pull *= twice
        pull += 1.0
        np.maximum(pull, 0.0, out=pull)
        np.sqrt(pull, out=pull)
        pull += 1.0
        x += np.divide(twice, pull, out=pull)
        np.maximum(x, low, out=x)
        return np.minimum(x, high, out=x)

    def tangent_across(self, along: np.ndarray, u: np.ndarray) -> np.ndarray:
        """The slope across the view, (n,), where the one `along` it is known.

        It is Student's t with 2 g - 1 degrees of freedom, scaled.
        """
        t = level(np.clip(u, LEAST_UNIFORM, LARGEST_UNIFORM))
        t = np.copysign(_slope(self.across(np.abs(t) / LARGEST_LEVEL)), t)
        return t * np.sqrt((self.g - 1.0 + along * along) / (2.0 * self.g - 1.0))


@functools.lru_cache(maxsize=16)
def slope_tables(g: float) -> SlopeTables:
    """The tables of the shape `g` > 3/2: a tenth of a second the first time."""
    from scipy.special import stdtrit

    kappa = np.linspace(0.0, 1.0, _CELLS + 1)
    x = _slope(kappa)
    tail_at = tail_by_beta(x, g)
    tail_at[-1] = 0.0
    tail = Spline(tail_at)
    masking = MaskingTable(_B, _CELLS, lambda a: _first_moment(a, g) - a * tail_by_beta(a, g))
    above = ViewTable.share_above(np.linspace(0.0, LARGEST_LEVEL, _LEVELS + 1))
    across = Spline(_kappa(-stdtrit(2.0 * g - 1.0, above)))
    start = ViewTable(functools.partial(_invert, g=g, tail=tail))
    return SlopeTables(g, tail, masking, start, across)


def _invert(s: np.ndarray, above: np.ndarray, g: float, tail: Spline) -> np.ndarray:
    """The kappa of the slope above which lies the share `above` (m,), (k, m), by bisection.

    The share is of the slopes visible at `s` (k, 1).
    """

    def mass(x: np.ndarray) -> np.ndarray:
        size = np.abs(x)
        share = tail(_kappa(size))
        return c * np.where(x < 0.0, 1.0 - share, share) + s * _first_moment(size, g)

    c = 1.0 - s
    cot = c / np.maximum(s, 1e-100)
    target = above * mass(-cot)
    low = np.broadcast_to(-_kappa(cot), target.shape)
    high = np.full(target.shape, _LARGEST_KAPPA)
    for _ in range(45):
        kappa = 0.5 * (low + high)
        more = mass(_slope(kappa)) > target
        low, high = np.where(more, kappa, low), np.where(more, high, kappa)
    return 0.5 * (low + high)
