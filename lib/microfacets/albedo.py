# SPDX-License-Identifier: GPL-3.0-or-later
"""The directional albedo of a white GGX surface with height-correlated masking.

It is the share of light that is left after one scattering:
E(mu, alpha) = integral of D G / (4 mu) over wi, mu = cos(theta_o); isotropic, alpha in [0, 1].
For an anisotropic lobe Blender takes alpha = sqrt(alpha_x alpha_y). The exact form is a table computed once by
quadrature, which gives E to about 5e-6 everywhere; the coarser tables that Cycles reads are also here, up to 1 % away
from it.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev
from scipy.special import roots_legendre

_CELLS = 512
_DEGREE = 31
_CYCLES_NODES = 32
_CYCLES_LEAST = 1e-4
_SMALLEST = 1e-9  # stands for a cosine or an alpha of zero in the quadrature: the limit is reached long before


def directional_albedo(cos_o: np.ndarray, alpha: float | np.ndarray) -> np.ndarray:
    """E(cos_o, alpha), (n,), to 1e-5; `cos_o` (n,) in [0, 1], `alpha` () or (n,) in [0, 1]."""
    q = np.maximum(cos_o, _SMALLEST)
    below = q + alpha
    np.divide(q, below, out=q)
    q *= 1.0 + np.asarray(alpha)
    np.minimum(q, 1.0, out=q)
    np.sqrt(q, out=q)
    q *= _CELLS
    return _bilinear(_table(), np.asarray(alpha, np.float64) * _CELLS, q)


def average_albedo(alpha: float | np.ndarray) -> np.ndarray:
    """Integral of 2 mu E(mu, alpha) over mu in [0, 1], shaped as `alpha`, to 1e-5.

    It is the share of diffuse light that is left.
    """
    return np.asarray(np.interp(alpha, np.linspace(0.0, 1.0, _CELLS + 1), _average()))


def directional_albedo_cycles(cos_o: np.ndarray, alpha: float | np.ndarray, power: int = 1) -> np.ndarray:
    """E as Cycles approximates it, (n,): bilinear between 32 x 32 nodes.

    The nodes lie evenly in roughness = sqrt(alpha) and in cos_o^(1 / power). `power` is 1 up to Blender 5.2 and 2 from 5.3 on. Their
    values come from quadrature; at both lower ends they stand for 1e-4 (Cycles, app/cycles_precompute.cpp).
    """
    last = _CYCLES_NODES - 1
    column = (np.asarray(cos_o, np.float64) if power == 1 else np.power(cos_o, 1.0 / power)) * float(last)
    return _bilinear(_cycles_table(power), np.sqrt(np.asarray(alpha, np.float64)) * last, column)


def average_albedo_cycles(alpha: float | np.ndarray) -> np.ndarray:
    """The average albedo as Cycles approximates it.

    It is linear between 32 nodes in roughness = sqrt(alpha).
    """
    return np.interp(np.sqrt(alpha), np.linspace(0.0, 1.0, _CYCLES_NODES), _cycles_average())


def integrate_albedo(
    cos_o: np.ndarray,
    alpha: np.ndarray,
    radii: int = 24,
    turns: int = 16,
    reflectance: Callable[[np.ndarray], np.ndarray] = np.ones_like,
    shadowed: bool = True,
) -> np.ndarray:
    """E by quadrature to 2e-7, (n,), with `radii` x 2 `turns` points each.

    `cos_o` and `alpha` (n,) in (0, 1].
    The integrand carries `reflectance` at the cosine between light and microfacet. Without `shadowed` light reaches
    every facet that wo sees: the mean over visible normals, those that reflect below the surface counting 0.

    Over the tangents alpha x (cos phi, sin phi) of the microfacets, dm = alpha^2 x dx dphi cos^3, each turn out to the
    radius at which the reflected direction meets the horizon, where the integrand ends at zero. Points crowd towards
    that end (the tail of D) and towards phi = pi / 2 (a grazing observer sees a step there).
    """
    node, weight = roots_legendre(radii)
    rest = 0.5 * (1.0 - node)
    share, weight = 1.0 - rest**3, 1.5 * weight * rest**2
    node, weight_turn = roots_legendre(turns)
    node = 0.5 * (1.0 + node)
    turn, weight_turn = 0.5 * np.pi * node**3, 0.75 * np.pi * weight_turn * node**2
    cos_phi = np.concatenate([np.sin(turn), -np.sin(turn)])[:, None]
    weight_turn = np.concatenate([weight_turn, weight_turn])

    mu, alpha = (np.asarray(v, np.float64)[:, None, None] for v in (cos_o, alpha))
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    forward = sine * cos_phi
    reach = np.sqrt(forward * forward + mu * mu)
    horizon = np.where(forward > 0.0, (forward + reach) / mu, mu / (reach - np.minimum(forward, 0.0)))
    y = share * horizon / (alpha + horizon)
    x = y / (1.0 - y)
    dx = weight * horizon / (alpha + horizon) / (1.0 - y) ** 2
    tangent = alpha * x
    facing = forward * tangent + mu  # wo.m / m.z
    secant2 = 1.0 + tangent * tangent
    cos_i = np.maximum(2.0 * facing / secant2 - mu, 1e-150)
    lambda_o, lambda_i = (
        0.5 * (np.sqrt(1.0 + alpha * alpha * np.maximum(1.0 - c * c, 0.0) / (c * c)) - 1.0) for c in (mu, cos_i)
    )
    hidden = lambda_o + lambda_i if shadowed else lambda_o
    ring = facing / mu * x * dx / (np.pi * (1.0 + x * x) ** 2 * (1.0 + hidden))
    ring *= reflectance(np.clip(facing / np.sqrt(secant2), 0.0, 1.0))
    return 2.0 * (ring.sum(axis=2) * weight_turn).sum(axis=1)


def _bilinear(table: np.ndarray, row: np.ndarray, column: np.ndarray) -> np.ndarray:
    """Bilinear interpolation in the square `table` (k + 1, k + 1).

    `row` () or (n,) and `column` (n,) are both in [0, k].
    """
    cells = table.shape[0] - 1
    first = np.minimum(row.astype(np.intp), cells - 1)
    across = row - first
    index = column.astype(np.intp)
    np.minimum(index, cells - 1, out=index)
    along = column - index
    if first.ndim == 0:
        line = table[first] + (table[first + 1] - table[first]) * across
        low = line.take(index)
        index += 1
        high = line.take(index)
    else:
        index += first * (cells + 1)
        flat = table.ravel()
        low, far = flat.take(index), flat.take(index + (cells + 1))
        far -= low
        far *= across
        low += far
        index += 1
        high, far = flat.take(index), flat.take(index + (cells + 1))
        far -= high
        far *= across
        high += far
    high -= low
    high *= along
    high += low
    return high


@functools.cache
def _table() -> np.ndarray:
    """E at evenly spaced alpha (rows) and q (columns), q^2 = mu (1 + alpha) / (mu + alpha).

    In these coordinates E is smooth down to alpha = 0, where at fixed mu / alpha it keeps a limit of its own, and down to mu = 0,
    where it goes as the root of mu: a Chebyshev interpolant finds it from few quadratures and fills the table.
    """
    size = _DEGREE + 1
    node = 0.5 + 0.5 * np.cos(np.pi * (np.arange(size) + 0.5) / size)
    alpha, q = (grid.ravel() for grid in np.meshgrid(node, node, indexing="ij"))
    mu = alpha * q * q / (1.0 + alpha - q * q)
    vandermonde = chebyshev.chebvander(2.0 * node - 1.0, _DEGREE)
    values = integrate_albedo(mu, alpha).reshape(size, size)
    coefficients = np.linalg.solve(vandermonde, np.linalg.solve(vandermonde, values).T).T
    fine = chebyshev.chebvander(np.linspace(-1.0, 1.0, _CELLS + 1), _DEGREE)
    return _frozen(np.minimum(fine @ coefficients @ fine.T, 1.0))


@functools.cache
def _average() -> np.ndarray:
    """The average albedo at the rows of `_table`.

    The nodes are in the root of mu, as E goes at grazing angles.
    """
    node, weight = roots_legendre(64)
    mu = (0.5 + 0.5 * node) ** 2
    weight = weight * (0.5 + 0.5 * node)
    alpha = np.linspace(0.0, 1.0, _CELLS + 1)
    return _frozen(np.stack([2.0 * (weight * mu * directional_albedo(mu, float(a))).sum() for a in alpha]))


@functools.cache
def _cycles_table(power: int) -> np.ndarray:
    """E at roughness i / 31 (rows) and cosine (j / 31)^power (columns)."""
    node = np.linspace(0.0, 1.0, _CYCLES_NODES)
    lines = np.maximum(node, _CYCLES_LEAST), np.maximum(node**power, _CYCLES_LEAST)
    roughness, mu = (grid.ravel() for grid in np.meshgrid(*lines, indexing="ij"))
    return _frozen(integrate_albedo(mu, roughness**2).reshape(_CYCLES_NODES, _CYCLES_NODES))


@functools.cache
def _cycles_average() -> np.ndarray:
    """The average albedo at roughness i / 31."""
    node = np.maximum(np.linspace(0.0, 1.0, _CYCLES_NODES), _CYCLES_LEAST)
    return _frozen(average_albedo(node**2))


def _frozen(table: np.ndarray) -> np.ndarray:
    table.flags.writeable = False
    return table
