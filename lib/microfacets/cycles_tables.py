# SPDX-License-Identifier: GPL-3.0-or-later
"""Albedos of dielectrics as Cycles tabulates them: linear between 16 nodes each of roughness, cosine and z = sqrt(|eta - 1| / (eta + 1)).

The nodes themselves come from quadrature; at their ends they stand for 1e-4 and, along z, 0.99 (Cycles, app/cycles_precompute.cpp).
The exact forms are in layers.py.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.special import roots_legendre

from .fresnel import dielectric
from .layers import integrate_glass, visible_normals

_NODES = 16
_LAST = _NODES - 1
_LEAST = 1e-4
_POINTS = 48


def layer_share_cycles(cos_o: np.ndarray, alpha: np.ndarray, eta: float) -> np.ndarray:
    """How far a layer's reflectance lies from f0 towards 1, on the average over what wo sees, (n,).

    The mean of (F - F0) / (1 - F0) over visible normals whose mirror direction rises above the surface, the others counting 0: masking
    between facets is left out. `cos_o` (n,) and `alpha`, () or (n,), in [0, 1].
    """
    return _read(_between(_layer_table, eta), cos_o, alpha)


def glass_albedo_cycles(cos_o: np.ndarray, alpha: np.ndarray, eta: float) -> np.ndarray:
    """What a white interface of index `eta` reflects and refracts together after one scattering, (n,)."""
    return _read(_between(_inside_table if eta < 1.0 else _outside_table, eta), cos_o, alpha)


def average_glass_albedo_cycles(alpha: np.ndarray, eta: float) -> np.ndarray:
    """Integral of 2 mu times the exact albedo over mu, linear between the nodes, shaped as `alpha`."""
    average = _between(_inside_average if eta < 1.0 else _outside_average, eta)
    return np.interp(np.sqrt(alpha), np.linspace(0.0, 1.0, _NODES), average)


def _between(table: Callable[[int], np.ndarray], eta: float) -> np.ndarray:
    """The slice at the z of `eta`, between the two of its neighbouring nodes."""
    z = np.sqrt(abs(eta - 1.0) / (eta + 1.0)) * _LAST
    first = min(int(z), _LAST - 1)
    low, high = table(first), table(first + 1)
    return low + (high - low) * (z - first)


def _read(table: np.ndarray, cos_o: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """A slice, rows of roughness and columns of the cosine, at both."""
    row = np.broadcast_to(np.sqrt(alpha), cos_o.shape) * _LAST
    return map_coordinates(table, [row, np.clip(cos_o, 0.0, 1.0) * _LAST], order=1, mode="nearest")


def _index(node: int) -> float:
    """The index (1 + z^2) / (1 - z^2) of a node of z."""
    z = float(np.clip(node / _LAST, _LEAST, 0.99))
    return (1.0 + z * z) / (1.0 - z * z)


def _grid() -> tuple[np.ndarray, np.ndarray]:
    """Cosine and alpha of a slice's nodes, row by row."""
    node = np.maximum(np.linspace(0.0, 1.0, _NODES), _LEAST)
    roughness, mu = (grid.ravel() for grid in np.meshgrid(node, node, indexing="ij"))
    return mu, roughness**2


@functools.cache
def _layer_table(node: int) -> np.ndarray:
    eta = _index(node)
    normal = ((eta - 1.0) / (eta + 1.0)) ** 2
    m, weight, wo, _ = visible_normals(*_grid(), _POINTS)
    cos_om = np.clip(wo[0] * m[0] + wo[2] * m[2], 0.0, 1.0)
    share = np.where(2.0 * cos_om * m[2] > wo[2], (dielectric(cos_om, eta) - normal) / (1.0 - normal), 0.0)
    return (share.reshape(-1, weight.size) * weight).sum(axis=1).reshape(_NODES, _NODES)


@functools.cache
def _outside_table(node: int) -> np.ndarray:
    return integrate_glass(*_grid(), _index(node), _POINTS).reshape(_NODES, _NODES)


@functools.cache
def _inside_table(node: int) -> np.ndarray:
    return integrate_glass(*_grid(), 1.0 / _index(node), _POINTS).reshape(_NODES, _NODES)


@functools.cache
def _outside_average(node: int) -> np.ndarray:
    return _average(_index(node))


@functools.cache
def _inside_average(node: int) -> np.ndarray:
    return _average(1.0 / _index(node))


def _average(eta: float) -> np.ndarray:
    """The average over the cosine at each node of roughness; quadrature in the root of the cosine, as the albedo goes at grazing."""
    x, weight = roots_legendre(24)
    root = 0.5 + 0.5 * x
    roughness = np.maximum(np.linspace(0.0, 1.0, _NODES), _LEAST)
    mu, alpha = np.tile(root**2, _NODES), np.repeat(roughness**2, root.size)
    values = integrate_glass(mu, alpha, eta, _POINTS).reshape(_NODES, root.size)
    return (values * (2.0 * weight * root**3)).sum(axis=1)
