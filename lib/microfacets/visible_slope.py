# SPDX-License-Identifier: GPL-3.0-or-later
"""Beckmann's visible slopes at roughness 1: the inversion of their exact distribution.

Seen under a = cot(theta), the tangent x along the view has the density (a + x) exp(-x^2) on x > -a, up to scale, and
above x lies the mass a sqrt(pi)/2 erfc(x) + exp(-x^2)/2 (Heitz and d'Eon 2014): no closed inverse. x grows with u and
falls with a, so the corners of a table's cell bracket it, and the table's bilinear value starts it; one step on the exact
distribution then leaves what rounding leaves of u. The step follows the parabola through value, slope and curvature, and then
the cubic, not the tangent: at the lower end the density is zero, the distribution a parabola, and Newton's method slow.
"""

from __future__ import annotations

import functools

import numpy as np
from scipy.special import erfc

from ..sampling.tables import LARGEST_UNIFORM

_VIEWS, _LEVELS = 128, 256  # cells of the table along 1 / (1 + a), and along u
_LEAST = 0.5 - 0.5 * LARGEST_UNIFORM  # with LARGEST_UNIFORM the bounds of the u that have a finite logit
_SQRT_PI = float(np.sqrt(np.pi))
_ABOVE_END = 1e-10  # how far above -a the bracket begins at least: at -a itself the density is zero


def visible_tangent(sine: np.ndarray, cosine: np.ndarray, u: np.ndarray, lambda_o: np.ndarray) -> np.ndarray:
    """The x above which lies 1 - u of the visible normals, (n,).

    `sine` > 0 and `cosine` > 0, (n,), of the viewing angle to the stretched surface, up to a common factor; `u` in [0, 1]. `lambda_o` is
    Smith's Lambda of that angle, by which the mass of all visible normals is a sqrt(pi) (1 + Lambda).
    """
    u = np.clip(u, _LEAST, LARGEST_UNIFORM)
    cot = cosine / sine
    # With s + c = 1 nothing below overflows, and s is the table's coordinate.
    s = 1.0 + cot
    np.divide(1.0, s, out=s)
    c = cot * s
    x, low, high = _bracket(s, u)
    np.negative(cot, out=cot)
    np.maximum(low, cot + _ABOVE_END, out=low)
    np.maximum(x, low, out=x)

    # Twice the mass above x that is wanted, (1 - u) of the whole.
    target = np.add(1.0, lambda_o, out=cot)
    target *= c
    np.subtract(1.0, u, out=u)
    target *= u
    target *= 2.0 * _SQRT_PI

    gauss = np.multiply(x, x, out=u)
    np.negative(gauss, out=gauss)
    np.exp(gauss, out=gauss)
    excess = erfc(x)
    excess *= c
    excess *= _SQRT_PI
    excess -= target
    excess += np.multiply(s, gauss, out=target)
    weight = np.multiply(s, x, out=target)
    weight += c
    gauss *= weight
    step = np.divide(excess, gauss, out=excess)  # twice Newton's step
    pull = np.divide(s, weight, out=s)
    bend = np.subtract(x, pull, out=gauss)  # (density'' / density + 2) / 4
    bend *= x
    curvature = np.subtract(pull, x, out=weight)  # density' / density
    curvature -= x
    curvature *= step
    curvature += 1.0
    np.clip(curvature, 0.0, np.inf, out=curvature)
    np.sqrt(curvature, out=curvature)
    step /= np.add(curvature, 1.0, out=pull)
    # The parabola's step, less what the cubic term adds to it.
    bend -= 0.5
    bend *= step
    bend *= step
    bend *= 2.0 / 3.0
    bend /= np.clip(curvature, 0.5, np.inf, out=curvature)
    np.clip(bend, -0.01, 0.01, out=bend)  # at the far ends, where the table starts too far off for a series
    np.subtract(1.0, bend, out=bend)
    step *= bend
    x += step
    np.maximum(x, low, out=x)
    return np.minimum(x, high, out=x)


def _bracket(s: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The table's bilinear value, and the corner values below and above it, for s = 1 / (1 + a)."""
    table, scale = _table()
    along = np.subtract(1.0, u)
    np.divide(u, along, out=along)
    np.log(along, out=along)
    root = np.abs(along)
    root += 2.0
    np.sqrt(root, out=root)
    root *= 1.0 / scale
    along /= root
    along += 0.5 * _LEVELS
    across = s * _VIEWS
    column = along.astype(np.intp)
    row = across.astype(np.intp)
    np.minimum(row, _VIEWS - 1, out=row)
    along -= column
    across -= row
    row *= _LEVELS + 1
    row += column
    low = table.take(row)
    row += 1
    near = table.take(row)
    row += _LEVELS
    far = table.take(row)
    row += 1
    high = table.take(row)
    near -= low
    near *= along
    near += low
    x = high - far
    x *= along
    x += far
    x -= near
    x *= across
    x += near
    return x, low, high


@functools.cache
def _table() -> tuple[np.ndarray, float]:
    """The x at the nodes, flattened from (1 / (1 + a), level), and the nodes per unit of level.

    The level of u is l / sqrt(2 + |l|) with l = log(u / (1 - u)): it goes to the ends as x does. Bisection: built once.
    """
    limit = np.log(LARGEST_UNIFORM / (1.0 - LARGEST_UNIFORM))
    largest = limit / np.sqrt(2.0 + limit) * (1.0 + 1e-6)
    level = np.linspace(-largest, largest, _LEVELS + 1)
    square = level * level
    logit = np.copysign(0.5 * (square + np.sqrt(square * (square + 8.0))), level)
    above = 1.0 / (1.0 + np.exp(logit))
    s = np.linspace(0.0, 1.0, _VIEWS + 1)[:, None]
    c = 1.0 - s
    cot = c / np.maximum(s, 1e-100)
    target = above * (c * _SQRT_PI * erfc(-cot) + s * np.exp(-cot * cot))
    low = np.broadcast_to(np.maximum(-cot, -7.0), target.shape)
    high = np.full(target.shape, 7.0)
    for _ in range(56):
        x = 0.5 * (low + high)
        more = c * _SQRT_PI * erfc(x) + s * np.exp(-x * x) > target
        low, high = np.where(more, x, low), np.where(more, high, x)
    # Rounding may have broken, by 1e-8, the order that makes the corners a bracket.
    x = np.maximum.accumulate(np.maximum.accumulate(0.5 * (low + high), axis=0), axis=1)
    table = np.ascontiguousarray(x).ravel()
    table.flags.writeable = False
    return table, _LEVELS / (2.0 * float(largest))
