# SPDX-License-Identifier: GPL-3.0-or-later
"""Albedos of dielectrics as Cycles tabulates them.

They are linear between nodes of roughness, cosine and z = sqrt(|eta - 1| / (eta + 1)).
Cycles' layout of the nodes changed with Blender 5.3 (`Tables`). The values at the nodes come from quadrature; at the
lower ends the nodes stand for 1e-4, and at the upper end of z for 0.99 (Cycles, app/cycles_precompute.cpp). One table
of Blender up to 5.2 does not hold the integrals: that of glass from inside exceeds them near grazing, by up to 0.6; it
is not reproduced. The exact forms are in layers.py.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from scipy.special import roots_legendre

from ..blender_versions import Release, Versions
from .albedo import average_albedo_cycles, directional_albedo_cycles, integrate_albedo
from .fresnel import dielectric
from .layers import integrate_glass

_LEAST = 1e-4


@dataclass(frozen=True)
class Tables:
    """A layout of Cycles' tables: `nodes` each of roughness, cosine and z.

    Node k is at the cosine (k / (nodes - 1))^`power`.
    Tables of GGX without Fresnel have 32 nodes of roughness and cosine in every layout.
    """

    nodes: int
    power: int

    @property
    def last(self) -> int:
        """The number of the last node."""
        return self.nodes - 1

    @property
    def roughness(self) -> np.ndarray:
        """What the nodes of roughness stand for, (nodes,)."""
        return np.maximum(np.linspace(0.0, 1.0, self.nodes), _LEAST)

    @property
    def cosine(self) -> np.ndarray:
        """What the nodes of the cosine stand for, (nodes,)."""
        return np.maximum(np.linspace(0.0, 1.0, self.nodes) ** self.power, _LEAST)

    def index(self, node: int) -> float:
        """The index of refraction (1 + z^2) / (1 - z^2) that a node of z stands for."""
        z = float(np.clip(node / self.last, _LEAST, 0.99))
        return (1.0 + z * z) / (1.0 - z * z)

    def directional_albedo(self, cos_o: np.ndarray, alpha: float | np.ndarray) -> np.ndarray:
        """E of white GGX reflection, (n,)."""
        return directional_albedo_cycles(cos_o, alpha, self.power)

    average_albedo = staticmethod(average_albedo_cycles)


COARSE, FINE = Tables(16, 1), Tables(32, 2)
LAYOUTS = {COARSE: Versions(None, "5.2"), FINE: Versions("5.3")}
"""The layouts, and the Blender releases that have them; measured on 4.5, 5.2 and 5.3."""


def tables_with(nodes: int) -> Tables | None:
    """The layout of so many nodes; None for 0."""
    return next((tables for tables in LAYOUTS if tables.nodes == nodes), None)


def cycles_tables(blender: Release | None) -> Tables:
    """The layout of a Blender release; of the newest one for None."""
    return FINE if blender is None else next(tables for tables, versions in LAYOUTS.items() if blender in versions)


def layer_share_cycles(cos_o: np.ndarray, alpha: np.ndarray, eta: float, tables: Tables) -> np.ndarray:
    """How far a layer's reflectance lies from f0 towards 1, on average over visible normals.

    The mean (n,) of (F - F0) / (1 - F0), at least 0, over visible normals whose mirror direction rises above the
    surface, the others counting 0: masking between facets is left out. The nodes stand for indices above 1 and are read
    by z alone: a layer of index below 1 gets the share of one of 1 / `eta`, which reflects nothing totally. `cos_o`
    (n,) and `alpha`, () or (n,), in [0, 1].
    """
    return _read(_between(_layer_table, eta, tables), cos_o, alpha, tables)


def glass_albedo_cycles(cos_o: np.ndarray, alpha: np.ndarray, eta: float, tables: Tables) -> np.ndarray:
    """The albedo, (n,), of a white interface of index `eta` after one scattering.

    It counts what the interface reflects and refracts together.
    """
    return _read(_between(_inside_table if eta < 1.0 else _outside_table, eta, tables), cos_o, alpha, tables)


def average_glass_albedo_cycles(alpha: np.ndarray, eta: float, tables: Tables) -> np.ndarray:
    """Integral of 2 mu times the exact albedo over mu, shaped as `alpha`.

    It is linear between the nodes.
    """
    average = _between(_inside_average if eta < 1.0 else _outside_average, eta, tables)
    return np.interp(np.sqrt(alpha), np.linspace(0.0, 1.0, tables.nodes), average)


def _between(table: Callable[[Tables, int], np.ndarray], eta: float, tables: Tables) -> np.ndarray:
    """The slice at the z of `eta`, between the two of its neighbouring nodes."""
    z = np.sqrt(abs(eta - 1.0) / (eta + 1.0)) * tables.last
    first = min(int(z), tables.last - 1)
    low, high = table(tables, first), table(tables, first + 1)
    return low + (high - low) * (z - first)


def _read(table: np.ndarray, cos_o: np.ndarray, alpha: np.ndarray, tables: Tables) -> np.ndarray:
    """A slice, rows of roughness and columns of the cosine, at both."""
    row = np.broadcast_to(np.sqrt(alpha), cos_o.shape) * tables.last
    column = np.clip(cos_o, 0.0, 1.0) ** (1.0 / tables.power) * tables.last
    return scipy.ndimage.map_coordinates(table, [row, column], order=1, mode="nearest")


def _grid(tables: Tables) -> tuple[np.ndarray, np.ndarray]:
    """Cosine and alpha of a slice's nodes, row by row."""
    roughness, mu = (grid.ravel() for grid in np.meshgrid(tables.roughness, tables.cosine, indexing="ij"))
    return mu, roughness**2


@functools.cache
def _layer_table(tables: Tables, node: int) -> np.ndarray:
    eta = tables.index(node)
    normal = ((eta - 1.0) / (eta + 1.0)) ** 2

    def share(cos: np.ndarray) -> np.ndarray:
        return np.clip((dielectric(cos, eta) - normal) / (1.0 - normal), 0.0, 1.0)

    return integrate_albedo(*_grid(tables), reflectance=share, shadowed=False).reshape(tables.nodes, tables.nodes)


@functools.cache
def _outside_table(tables: Tables, node: int) -> np.ndarray:
    return integrate_glass(*_grid(tables), tables.index(node)).reshape(tables.nodes, tables.nodes)


@functools.cache
def _inside_table(tables: Tables, node: int) -> np.ndarray:
    return integrate_glass(*_grid(tables), 1.0 / tables.index(node)).reshape(tables.nodes, tables.nodes)


@functools.cache
def _outside_average(tables: Tables, node: int) -> np.ndarray:
    return _average(tables, tables.index(node))


@functools.cache
def _inside_average(tables: Tables, node: int) -> np.ndarray:
    return _average(tables, 1.0 / tables.index(node))


def _average(tables: Tables, eta: float) -> np.ndarray:
    """The average over the cosine at each node of roughness.

    The quadrature is in the root of the cosine, as the albedo goes at grazing angles.
    """
    x, weight = roots_legendre(24)
    root = 0.5 + 0.5 * x
    mu, alpha = np.tile(root**2, tables.nodes), np.repeat(tables.roughness**2, root.size)
    values = integrate_glass(mu, alpha, eta).reshape(tables.nodes, root.size)
    return (values * (2.0 * weight * root**3)).sum(axis=1)
