# SPDX-License-Identifier: GPL-3.0-or-later
"""Cones of light with a straight edge (Blender's Toon BSDF).

They model no real surface, and are not reciprocal where the cone is about the normal.
"""

from __future__ import annotations

import numpy as np

from ..sampling.warps import circle
from ..vectors import dot, orthonormal_basis, to_world
from .fresnels import part_of
from .lobe import Lobe, to_rgb

LEAST_SIZE = 1e-5
_RIGHT_ANGLE = 0.5 * np.pi


def cone_half_angle(size: np.ndarray, smooth: np.ndarray) -> np.ndarray:
    """Return the half angle in radians of the cone that holds the lobe and its edge.

    It is at most a right angle. The arguments are in parts of a right angle.
    """
    size, smooth = np.clip(size, LEAST_SIZE, 1.0), np.clip(smooth, 0.0, 1.0)
    return np.minimum(size + smooth, 1.0) * _RIGHT_ANGLE


class Toon(Lobe):
    """A cone about the normal, or with `glossy` about the mirror direction.

    The value is intensity / (2 pi (1 - cos s)) within s of the axis; |wi.n| is included in it.

    s is the half angle of the whole cone. The intensity is 1 within `size` and falls evenly to 0 over `smooth`, both
    () or (n,), in parts of a right angle. Directions are uniform in the cone; those below the horizon carry nothing.
    """

    def __init__(self, wo: np.ndarray, size: np.ndarray, smooth: np.ndarray, glossy: bool) -> None:
        self._wo, self._sizes, self._glossy = wo, (size, smooth), glossy
        self._size, self._smooth = (
            np.clip(size, LEAST_SIZE, 1.0) * _RIGHT_ANGLE,
            np.clip(smooth, 0.0, 1.0) * _RIGHT_ANGLE,
        )
        self._reach = cone_half_angle(size, smooth)
        self.diffuse = not glossy
        self._rise = 2.0 * np.square(np.sin(0.5 * self._reach))  # 1 - cos s
        self._axis = np.stack([-wo[0], -wo[1], wo[2]]) if glossy else np.broadcast_to([[0.0], [0.0], [1.0]], wo.shape)
        self._above = (wo[2] > 0.0) | (not glossy)

    def _intensity(self, angle: np.ndarray) -> np.ndarray:
        """From 1 to 0 over the edge, (n,)."""
        width = np.where(self._smooth > 0.0, self._smooth, 1.0)
        edge = np.clip(1.0 - (angle - self._size) / width, 0.0, 1.0)
        return np.where(self._smooth > 0.0, edge, 1.0) * (angle < self._reach)

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value (3, n) and density (n,)."""
        apart = wi - self._axis
        angle = 2.0 * np.arcsin(np.minimum(0.5 * np.sqrt(dot(apart, apart)), 1.0))
        lit = (wi[2] > 0.0) & self._above
        pdf = np.where(lit & (angle < self._reach), 0.5 / (np.pi * self._rise), 0.0)
        return to_rgb(pdf * self._intensity(angle)), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight, density, which is 0 below the horizon."""
        x, y = circle(u1)
        lift = u2 * self._rise  # 1 - cos
        sine = np.sqrt(lift * (2.0 - lift))
        wi = to_world(np.stack([x * sine, y * sine, 1.0 - lift]), *orthonormal_basis(self._axis), self._axis)
        lit = (wi[2] > 0.0) & self._above
        angle = 2.0 * np.arcsin(np.sqrt(0.5 * lift))
        pdf = np.where(lit, 0.5 / (np.pi * self._rise), 0.0)
        return wi, to_rgb(np.where(lit, self._intensity(angle), 0.0)), pdf

    def part(self, index: np.ndarray) -> Toon:
        """The same lobe at fewer points."""
        size, smooth = (part_of(np.asarray(one), index) for one in self._sizes)
        return Toon(np.take(self._wo, index, axis=1), size, smooth, self._glossy)
