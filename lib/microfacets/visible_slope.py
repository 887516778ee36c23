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
from .inverse_tables import LEAST_UNIFORM, ViewTable

_SQRT_PI = float(np.sqrt(np.pi))
_ABOVE_END = 1e-10  # how far above -a the bracket begins at least: at -a itself the density is zero


def visible_tangent(sine: np.ndarray, cosine: np.ndarray, u: np.ndarray, lambda_o: np.ndarray) -> np.ndarray:
    """The x above which lies 1 - u of the visible normals, (n,).

    `sine` > 0 and `cosine` > 0, (n,), of the viewing angle to the stretched surface, up to a common factor; `u` in [0, 1]. `lambda_o` is
    Smith's Lambda of that angle, by which the mass of all visible normals is a sqrt(pi) (1 + Lambda).
    """
    u = np.clip(u, LEAST_UNIFORM, LARGEST_UNIFORM)
    cot = cosine / sine
    # With s + c = 1 nothing below overflows, and s is the table's coordinate: a = c / s.
    s = 1.0 / (1.0 + cot)
    c = cot * s
    x, low, high = _bracket(s, u)
    low = np.maximum(low, _ABOVE_END - cot)
    np.maximum(x, low, out=x)
    x += _step(x, s, c, (1.0 - u) * c * (1.0 + lambda_o))
    np.maximum(x, low, out=x)
    return np.minimum(x, high, out=x)


def step_by_definition(x: np.ndarray, s: np.ndarray, c: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The step to add to x, (n,), so that the mass above it is the one that is wanted.

    See the module's docstring.
    s = 1 / (1 + a) and c = a s; `wanted` = c (1 + Lambda) (1 - u), so that sqrt(pi) `wanted` is s times the mass that
    shall lie above x. This is the definition of `_step`, which works in place: a third of the time of a sample.
    """
    gauss = np.exp(-x * x)
    # Of 2 s times the mass above x what is too much, and s times the density, s (a + x) exp(-x^2).
    excess = c * _SQRT_PI * erfc(x) + s * gauss - 2.0 * _SQRT_PI * wanted
    weight = c + s * x
    newton = excess / (weight * gauss)  # twice Newton's step
    # The parabola's step, by the density's slope over the density: density' / density = s / weight - 2 x.
    pull = s / weight
    curvature = np.sqrt(np.maximum(1.0 + newton * (pull - 2.0 * x), 0.0))
    step = newton / (1.0 + curvature)
    # Less what the cubic term adds to it, by (density'' / density + 2) / 4 = x (x - pull); bounded at the far ends, where the table
    # starts too far off for a series.
    cubic = (x * (x - pull) - 0.5) * step * step * (2.0 / 3.0) / np.maximum(curvature, 0.5)
    return step * (1.0 - np.clip(cubic, -0.01, 0.01))


def _step(x: np.ndarray, s: np.ndarray, c: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """`step_by_definition` in place; writes into `wanted`.

    Each array is named after what it holds last.
    """
    gauss = x * x
    np.negative(gauss, out=gauss)
    np.exp(gauss, out=gauss)
    # excess = c sqrt(pi) erfc(x) + s gauss - 2 sqrt(pi) wanted
    excess = erfc(x)
    excess *= c
    wanted *= 2.0
    excess -= wanted
    excess *= _SQRT_PI
    excess += np.multiply(s, gauss, out=wanted)
    # weight = c + s x; newton = excess / (weight gauss)
    weight = np.multiply(s, x, out=wanted)
    weight += c
    gauss *= weight
    newton = np.divide(excess, gauss, out=excess)
    # pull = s / weight; bend = x (x - pull) - 1/2; curvature = sqrt(max(1 + newton (pull - 2 x), 0))
    pull = np.divide(s, weight, out=weight)
    bend = np.subtract(x, pull, out=gauss)
    curvature = np.subtract(pull, x, out=pull)
    curvature -= x
    curvature *= newton
    curvature += 1.0
    np.clip(curvature, 0.0, np.inf, out=curvature)
    np.sqrt(curvature, out=curvature)
    bend *= x
    bend -= 0.5
    # step = newton / (1 + curvature)
    step = np.divide(newton, 1.0 + curvature, out=newton)
    # cubic = 2/3 bend step^2 / max(curvature, 1/2), within 0.01; step (1 - cubic)
    cubic = np.multiply(bend, step, out=bend)
    cubic *= step
    cubic *= 2.0 / 3.0
    cubic /= np.clip(curvature, 0.5, np.inf, out=curvature)
    np.clip(cubic, -0.01, 0.01, out=cubic)
    np.subtract(1.0, cubic, out=cubic)
    step *= cubic
    return step


def _bracket(s: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The table's bilinear value, and the corner values below and above it.

    They are for s = 1 / (1 + a).
    """
    return _table().bracket(s, u)


@functools.cache
def _table() -> ViewTable:
    """The x at the nodes, by bisection: built once."""
    return ViewTable(_invert)


def _invert(s: np.ndarray, above: np.ndarray) -> np.ndarray:
    """The x above which lies the share `above` (m,) of the visible slopes, (k, m).

    The slopes are those visible at `s` (k, 1).
    """
    c = 1.0 - s
    cot = c / np.maximum(s, 1e-100)
    target = above * (c * _SQRT_PI * erfc(-cot) + s * np.exp(-cot * cot))
    low = np.broadcast_to(np.maximum(-cot, -7.0), target.shape)
    high = np.full(target.shape, 7.0)
    for _ in range(56):
        x = 0.5 * (low + high)
        more = c * _SQRT_PI * erfc(x) + s * np.exp(-x * x) > target
        low, high = np.where(more, x, low), np.where(more, high, x)
    return 0.5 * (low + high)
