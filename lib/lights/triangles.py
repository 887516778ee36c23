# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive triangles of the scene as one light."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..sampling.tables import Distribution1D
from ..vectors import cross, dot

_SMALLEST = 1e-100


class TriangleSample(NamedTuple):
    """Places on emissive triangles, one for each point.

    wi (3, n) unit vectors; distance (n,) metres; pdf (n,) per steradian, positive and finite; triangle (n,) the triangle's index in the scene;
    b1, b2 (n,) barycentric weights of its second and third corner; facing (n,) cosine between the geometric normal and the
    way back to the point, negative on the back face. What the triangle emits there is for the caller to evaluate.
    """

    wi: np.ndarray
    distance: np.ndarray
    pdf: np.ndarray
    triangle: np.ndarray
    b1: np.ndarray
    b2: np.ndarray
    facing: np.ndarray


class EmissiveTriangles:
    """Triangles that shine from both faces.

    They are chosen by their power and sampled uniformly by area.

    `corner`, `edge1`, `edge2` (3, t): first corner and the edges to the second and third; `triangle` (t,) indices in
    the scene; `power` (t,) an estimate of each one's flux, luminance in W, not negative; if all are zero, the area
    decides. Triangles without area are never chosen.
    """

    def __init__(
        self, corner: np.ndarray, edge1: np.ndarray, edge2: np.ndarray, triangle: np.ndarray, power: np.ndarray
    ) -> None:
        normal = cross(edge1, edge2)
        length = np.sqrt(dot(normal, normal))
        area = 0.5 * length
        self._corner, self._edge1, self._edge2 = corner, edge1, edge2
        self._normal = normal / np.where(length > 0.0, length, 1.0)
        self._triangle = np.asarray(triangle, np.intp)
        weights = np.where(area > 0.0, power, 0.0)
        self.power = float(weights.sum())
        self._choice = Distribution1D(weights if self.power > 0.0 else area)
        chosen = self._choice.probability
        # Probability per area; one entry more, 0, for all triangles of the scene that do not emit.
        self._density = np.zeros(int(self._triangle.max()) + 2)
        self._density[self._triangle] = np.where(area > 0.0, chosen / np.where(area > 0.0, area, 1.0), 0.0)

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> TriangleSample:
        """Sample uniformly by area on a triangle chosen by power, seen from `point` (3, n).

        PBRT 4th edition, eq. A.15 for the place.
        """
        which, b1, b2, wi = self.place(u1, u2)
        wi -= point
        distance = np.sqrt(dot(wi, wi))
        wi /= np.maximum(distance, _SMALLEST)
        facing = -dot(np.take(self._normal, which, axis=1), wi)
        triangle = np.take(self._triangle, which)
        # A place seen edge on, or met exactly, has no solid angle: its density is bounded, and its contribution vanishes.
        pdf = np.maximum(self.pdf_of_hit(triangle, distance, facing), _SMALLEST)
        return TriangleSample(wi, distance, pdf, triangle, b1, b2, facing)

    def place(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Sample a place on the emissive triangles.

        Returns the index among them, the barycentric weights b1 and b2, (n,) each, and the point (3, n).
        """
        which, rest = self._choice.sample(u1)
        root = np.sqrt(rest)
        b1 = 1.0 - root
        b2 = root * u2
        point = np.take(self._edge1, which, axis=1)
        point *= b1
        along = np.take(self._edge2, which, axis=1)
        along *= b2
        point += along
        point += np.take(self._corner, which, axis=1)
        return which, b1, b2, point

    def area_density(self, triangle: np.ndarray) -> np.ndarray:
        """Density per square metre with which `place` gives a point of the scene triangles (n,)."""
        return np.take(self._density, triangle, mode="clip")

    def pdf_of_hit(self, triangle: np.ndarray, distance: np.ndarray, facing: np.ndarray) -> np.ndarray:
        """Return the density per steradian with which `sample` returns a direction.

        It is that of a direction which meets scene triangle `triangle` at `distance`.

        `facing`: cosine between its normal and the direction, of either sign. The density is 0 for triangles that do not emit.
        """
        density = np.take(self._density, triangle, mode="clip")
        density *= distance
        density *= distance
        density /= np.maximum(np.abs(facing), _SMALLEST)
        return density
