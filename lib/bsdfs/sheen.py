# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheen of a layer of upright fibers: a linearly transformed cosine.

It is that of Blender's Sheen BSDF 'Microfiber' and of its Principled BSDF.
"""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np

from ..sampling.warps import cosine_hemisphere
from .lobe import Lobe, to_rgb
from .rotated import rotate_in

LEAST_ROUGHNESS = 1e-3
_CELLS = 31
_LEAST = 1e-5  # of A and of the albedo: below it the fit is of no use, and the lobe reflects nothing, as in Cycles


def sheen_coefficients(cos_o: np.ndarray, roughness: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A, B and the albedo R of the lobe, (n,) each.

    They are bilinear between the nodes of the table (sheen.txt).

    `cos_o` (n,), clipped to [0, 1]; `roughness` () or (n,), clipped to [0.001, 1]. R is 0 and A is 1 where there is
    no lobe.
    """
    column = np.clip(cos_o, 0.0, 1.0) * _CELLS
    row = np.broadcast_to(np.clip(roughness, LEAST_ROUGHNESS, 1.0) * _CELLS, column.shape)
    i, j = (np.minimum(x.astype(np.intp), _CELLS - 1) for x in (row, column))
    across, along = row - i, column - j
    table = _table()
    low = table[:, i, j] * (1.0 - along) + table[:, i, j + 1] * along
    high = table[:, i + 1, j] * (1.0 - along) + table[:, i + 1, j + 1] * along
    a, b, albedo = low * (1.0 - across) + high * across
    exists = (a >= _LEAST) & (albedo >= _LEAST)
    return np.where(exists, a, 1.0), np.where(exists, b, 0.0), np.where(exists, albedo, 0.0)


def beneath_sheen(tint: np.ndarray, roughness: np.ndarray, weight: np.ndarray, cos_o: np.ndarray) -> np.ndarray:
    """Return the share of light, (n,), at least 0, that sheen leaves for the layers below it.

    It is 1 - R times the largest colour of `weight` `tint`.

    `tint` (3, 1) or (3, n), `weight` () or (n,); values below 0 count as 0.
    """
    _, _, albedo = sheen_coefficients(cos_o, roughness)
    largest = np.maximum(weight, 0.0) * np.maximum(tint, 0.0).max(axis=0)
    return np.maximum(1.0 - largest * albedo, 0.0)


class Sheen(Lobe):
    """A linearly transformed cosine lobe for sheen.

    R D(M wi / |M wi|) |M| / |M wi|^3 with D the cosine over pi and M = ((A, 0, B), (0, A, 0), (0, 0, 1)).

    Zeltner, Burley and Chiang 2022; x points from the normal to the viewer. M keeps the hemisphere, so that the
    cosine's density, transformed, is sampled exactly. Not reciprocal: A, B and R are fits that depend on wo.
    """

    diffuse = True

    def __init__(self, wo: np.ndarray, roughness: np.ndarray) -> None:
        length = np.sqrt(wo[0] * wo[0] + wo[1] * wo[1])
        across = length > 0.0
        self._cos = np.where(across, wo[0] / np.where(across, length, 1.0), 1.0)
        self._sin = np.where(across, wo[1] / np.where(across, length, 1.0), 0.0)
        self._a, self._b, self._albedo = sheen_coefficients(wo[2], roughness)

    @property
    def estimate(self) -> np.ndarray:
        """The albedo."""
        return self._albedo

    def _density(self, wi: np.ndarray) -> np.ndarray:
        """The cosine times a^2 / (pi |M wi|^4) of `wi` in the viewer's plane, (n,)."""
        x, y, z = wi
        length2 = np.square(self._a * x + self._b * z) + np.square(self._a * y) + z * z
        return np.maximum(z, 0.0) * np.square(self._a / length2) * (1.0 / np.pi)

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value (3, n) and density (n,)."""
        pdf = self._density(rotate_in(wi, self._cos, self._sin))
        return to_rgb(self._albedo * pdf), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight R, density: a direction of the cosine's, led back through M."""
        x, y, z = cosine_hemisphere(u1, u2)
        wi = np.stack([x - self._b * z, y, self._a * z])
        wi /= np.sqrt((wi * wi).sum(axis=0))
        return rotate_in(wi, self._cos, -self._sin), to_rgb(self._albedo), self._density(wi)

    def part(self, index: np.ndarray) -> Sheen:
        """The same lobe at fewer points."""
        piece = object.__new__(Sheen)
        for name in ("_cos", "_sin", "_a", "_b", "_albedo"):
            setattr(piece, name, np.take(getattr(self, name), index))
        return piece


@functools.cache
def _table() -> np.ndarray:
    """A, B and R, (3, 32, 32), rows of roughness and columns of the cosine."""
    table = np.loadtxt(Path(__file__).with_name("sheen.txt")).reshape(3, _CELLS + 1, _CELLS + 1)
    table.flags.writeable = False
    return table
