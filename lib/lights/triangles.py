# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive triangles of the scene as one light."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..sampling.tables import LARGEST_UNIFORM, Distribution1D
from ..vectors import cross, dot
from .by_place import PartChances
from .face_groups import FaceGroups, Pieces, Strips

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

    They are chosen by their power, or in groups by the place that they are to light, and sampled uniformly by area.

    `corner`, `edge1`, `edge2` (3, t): first corner and the edges to the second and third; `triangle` (t,) indices in
    the scene; `power` (t,) an estimate of each one's flux, luminance in W, not negative; if all are zero, the area
    decides. Triangles without area are never chosen. The corners may have been turned for `strips`.
    """

    def __init__(
        self,
        corner: np.ndarray,
        edge1: np.ndarray,
        edge2: np.ndarray,
        triangle: np.ndarray,
        power: np.ndarray,
        strips: Strips | None = None,
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
        self._strips = strips if strips is not None and strips.count.max() > 1 else None
        self._by_place: _ByPlace | None = None

    def choose_by_place(self, pieces: Pieces, groups: FaceGroups, chances: PartChances) -> None:
        """Have samples in cells choose a group of pieces by `chances`, and by power within it."""
        group_of = np.zeros(pieces.face.size, np.intp)
        group_of[groups.order] = np.repeat(np.arange(groups.first.size - 1), np.diff(groups.first))
        chosen = Distribution1D((self._choice.probability[pieces.face] * pieces.share)[groups.order])
        start = np.append(0.0, np.cumsum(chosen.probability))[groups.first]
        place = np.zeros(self._density.size, np.intp)  # of each triangle of the scene among the emissive ones
        place[self._triangle] = np.arange(self._triangle.size)
        first = np.searchsorted(pieces.face, np.arange(self._triangle.size))
        self._by_place = _ByPlace(
            *(pieces.face, pieces.before, pieces.share, groups.order, group_of, chosen, start[:-1], np.diff(start)),
            *(chances, self._strips, place, first),
        )

    def sample(
        self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray, cell: np.ndarray | None = None
    ) -> TriangleSample:
        """Sample uniformly by area on a triangle, seen from `point` (3, n).

        The triangle is chosen by power, or by the chances of the cells (n,). PBRT 4th edition, eq. A.15 for the place.
        """
        which, b1, b2, wi = self.place(u1, u2, cell)
        wi -= point
        distance = np.sqrt(dot(wi, wi))
        wi /= np.maximum(distance, _SMALLEST)
        facing = -dot(np.take(self._normal, which, axis=1), wi)
        triangle = np.take(self._triangle, which)
        # A place seen edge on, or met exactly, has no solid angle: its density is bounded, and its contribution vanishes.
        pdf = np.maximum(self.pdf_of_hit(triangle, distance, facing, cell, (b1, b2)), _SMALLEST)
        return TriangleSample(wi, distance, pdf, triangle, b1, b2, facing)

    def place(
        self, u1: np.ndarray, u2: np.ndarray, cell: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Sample a place on the emissive triangles, `cell` as for `sample`.

        Returns the index among them, the barycentric weights b1 and b2, (n,) each, and the point (3, n).
        """
        if cell is None or self._by_place is None:
            which, rest = self._choice.sample(u1)
        else:
            which, rest = self._by_place.sample(cell, u1)
        root = np.sqrt(rest)
        b1 = 1.0 - root
        b2 = root * u2
        point = np.take(self._edge1, which, axis=1)
        point *= b1
        along = np.take(self._edge2, which, axis=1)
        along *= b2
        point += along
        point += np.take(self._corner, which, axis=1)
        if self._strips is None:
            return which, b1, b2, point
        turn = np.take(self._strips.turn, which)
        weights = [1.0 - b1 - b2, b1, b2]
        return which, np.choose((1 - turn) % 3, weights), np.choose((2 - turn) % 3, weights), point

    def area_density(self, triangle: np.ndarray) -> np.ndarray:
        """Density per square metre with which `place` gives a point of the scene triangles (n,)."""
        return np.take(self._density, triangle, mode="clip")

    def pdf_of_hit(
        self,
        triangle: np.ndarray,
        distance: np.ndarray,
        facing: np.ndarray,
        cell: np.ndarray | None = None,
        weights: tuple[np.ndarray, np.ndarray] | None = None,
    ) -> np.ndarray:
        """Return the density per steradian with which `sample` returns a direction.

        It is that of a direction which meets scene triangle `triangle` at `distance`. With the cells (n,) of `sample`, the barycentric
        `weights` of its second and third corner, (n,) each, say where.

        `facing`: cosine between its normal and the direction, of either sign. The density is 0 for triangles that do not emit.
        """
        density = np.take(self._density, triangle, mode="clip")
        if cell is not None and weights is not None and self._by_place is not None:
            density *= self._by_place.over_power(triangle, cell, *weights)
        density *= distance
        density *= distance
        density /= np.maximum(np.abs(facing), _SMALLEST)
        return density


class _ByPlace(NamedTuple):
    """Pieces of triangles in the order of their groups.

    `face`, `before` and `share` (p,) as in Pieces; `order` (p,) their indices; `group_of` (p,) the group of each; `chosen` by power, in
    that order; `start` and `width` (g,) of each group in it; `chances` of the groups. `strips` where triangles are cut; `place` of each
    triangle of the scene among the emissive ones, and the `first` piece (t,) of each of these.
    """

    face: np.ndarray
    before: np.ndarray
    share: np.ndarray
    order: np.ndarray
    group_of: np.ndarray
    chosen: Distribution1D
    start: np.ndarray
    width: np.ndarray
    chances: PartChances
    strips: Strips | None
    place: np.ndarray
    first: np.ndarray

    def sample(self, cell: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the triangles (n,) that uniforms choose in the cells (n,).

        Also the share of each triangle's area that is nearer to its second corner than the place that is chosen.
        """
        group, rest = self.chances.choose(cell, u)
        rest *= np.take(self.width, group)
        rest += np.take(self.start, group)
        place, rest = self.chosen.sample(np.minimum(rest, LARGEST_UNIFORM, out=rest))
        piece = np.take(self.order, place)
        if self.strips is not None:
            rest *= np.take(self.share, piece)
            rest += np.take(self.before, piece)
        return np.take(self.face, piece), rest

    def over_power(self, triangle: np.ndarray, cell: np.ndarray, b1: np.ndarray, b2: np.ndarray) -> np.ndarray:
        """Probability (n,) of places on triangles of the scene in the cells (n,), over that by power."""
        place = np.take(self.place, triangle, mode="clip")
        piece = np.take(self.first, place)
        if self.strips is not None:
            count = np.take(self.strips.count, place)
            far = np.choose((1 + np.take(self.strips.turn, place)) % 3, [1.0 - b1 - b2, b1, b2])
            piece += np.clip((1.0 - far) * count, 0.0, count - 1.0).astype(np.intp)
        return self.chances.over_power(np.take(self.group_of, piece), cell)
