# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts of directions, for chi2.py, on a sampler's own domain.

The density of a light's sampler, or of a rough interface, is smooth there.
"""

from dataclasses import dataclass

import numpy as np
from etalon.tests.chi2 import Tangents


@dataclass(frozen=True)
class Flat:
    """Places of a parallelogram (`disk` False) or of the ellipse in it, seen from `point`.

    A place is corner + p' u + q' v.
    """

    point: np.ndarray
    center: np.ndarray
    edge_u: np.ndarray
    edge_v: np.ndarray
    disk: bool = False

    def _places(self, p, q):
        if self.disk:
            radius, phi = 0.5 * np.sqrt(p), 2.0 * np.pi * q
            p, q = 0.5 + radius * np.cos(phi), 0.5 + radius * np.sin(phi)
        offset = (p - 0.5) * self.edge_u[:, None] + (q - 0.5) * self.edge_v[:, None]
        return self.center[:, None] + offset - self.point[:, None]

    def directions(self, p, q):
        way = self._places(p, q)
        return way / np.sqrt((way * way).sum(axis=0))

    def solid_angle(self, p, q):
        way = self._places(p, q)
        across = np.cross(self.edge_u, self.edge_v) * (np.pi / 4.0 if self.disk else 1.0)
        return np.abs(across @ way) / (way * way).sum(axis=0) ** 1.5

    def coordinates(self, directions):
        normal = np.cross(self.edge_u, self.edge_v)
        falling = normal @ directions
        reach = (normal @ (self.center - self.point)) / np.where(falling == 0.0, np.nan, falling)
        offset = self.point[:, None] + reach * directions - self.center[:, None]
        basis = np.stack([self.edge_u, self.edge_v, normal], axis=1)
        s, t, _ = np.linalg.solve(basis, offset)
        if self.disk:
            p, q = 4.0 * (s * s + t * t), np.arctan2(t, s) / (2.0 * np.pi) % 1.0
        else:
            p, q = s + 0.5, t + 0.5
        # The rim may fall on either side of itself by rounding.
        inside = (reach > 0.0) & (np.abs(p - 0.5) <= 0.5 + 1e-9) & (np.abs(q - 0.5) <= 0.5 + 1e-9)
        return tuple(np.where(inside, np.clip(c, 0.0, 1.0), np.nan) for c in (p, q))


@dataclass(frozen=True)
class Cone:
    """Directions about unit `axis` by 1 - cos (from 0 to `top`, evenly) and azimuth."""

    axis: np.ndarray
    top: float

    def _frame(self):
        across = np.cross(self.axis, np.eye(3)[np.argmin(np.abs(self.axis))])
        across /= np.linalg.norm(across)
        return across, np.cross(self.axis, across)

    def directions(self, p, q):
        inner, phi = p * self.top, 2.0 * np.pi * q
        sine = np.sqrt(inner * (2.0 - inner))
        across, up = self._frame()
        return (
            (1.0 - inner) * self.axis[:, None] + sine * np.cos(phi) * across[:, None] + sine * np.sin(phi) * up[:, None]
        )

    def solid_angle(self, p, q):
        return np.full(p.shape, 2.0 * np.pi * self.top)

    def coordinates(self, directions):
        across, up = self._frame()
        inner = 0.5 * ((directions - self.axis[:, None]) ** 2).sum(axis=0)  # 1 - cos, without cancellation
        p = inner / self.top
        q = np.arctan2(up @ directions, across @ directions) / (2.0 * np.pi) % 1.0
        return np.where(p <= 1.0 + 1e-9, np.clip(p, 0.0, 1.0), np.nan), q


@dataclass(frozen=True)
class Sky:
    """All directions by the rows and columns of an equirectangular table.

    v goes by z evenly in each row, u = 1/2 - phi / 2 pi.
    """

    rows: int

    def directions(self, p, q):
        row = np.minimum((p * self.rows).astype(int), self.rows - 1)
        edges = np.cos(np.linspace(0.0, np.pi, self.rows + 1))
        z = edges[row] + (p * self.rows - row) * (edges[row + 1] - edges[row])
        phi = 2.0 * np.pi * (0.5 - q)
        sine = np.sqrt(np.maximum(1.0 - z * z, 0.0))
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), z])

    def solid_angle(self, p, q):
        row = np.minimum((p * self.rows).astype(int), self.rows - 1)
        edges = np.cos(np.linspace(0.0, np.pi, self.rows + 1))
        return 2.0 * np.pi * self.rows * (edges[row] - edges[row + 1])

    def coordinates(self, directions):
        x, y, z = directions
        edges = np.cos(np.linspace(0.0, np.pi, self.rows + 1))
        row = np.clip(np.searchsorted(-edges, -z, side="right") - 1, 0, self.rows - 1)
        inside = (edges[row] - z) / (edges[row] - edges[row + 1])
        return (row + np.clip(inside, 0.0, 1.0 - 1e-15)) / self.rows, (0.5 - np.arctan2(y, x) / (2.0 * np.pi)) % 1.0


@dataclass(frozen=True)
class Refractions:
    """The refracted images of one `wo`, (3,), in the normals of a chart.

    `eta` is the far side's index over the near side's.
    """

    wo: np.ndarray
    eta: float
    normals: Tangents

    def _pair(self, p, q):
        m = self.normals.directions(p, q)
        cos_o = self.wo @ m
        cos_t = np.sqrt(np.maximum(1.0 - (1.0 - cos_o**2) / self.eta**2, 0.0))
        return m, cos_o, cos_t

    def directions(self, p, q):
        m, cos_o, cos_t = self._pair(p, q)
        wi = m * (cos_o / self.eta - cos_t) - self.wo[:, None] / self.eta
        return np.where(
            cos_t > 0.0, wi, np.array([[0.0], [0.0], [1.0]])
        )  # none: above the surface, where nothing is refracted

    def solid_angle(self, p, q):
        _, cos_o, cos_t = self._pair(p, q)
        jacobian = (self.eta * cos_t - cos_o) ** 2 / (self.eta**2 * np.where(cos_t > 0.0, cos_t, 1.0))
        return jacobian * self.normals.solid_angle(p, q)

    def coordinates(self, directions):
        m = self.eta * directions + self.wo[:, None]
        m /= np.sqrt((m * m).sum(axis=0))
        p, q = self.normals.coordinates(np.where(m[2] < 0.0, -m, m))
        return np.where(directions[2] < 0.0, p, np.nan), q
