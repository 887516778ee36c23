# SPDX-License-Identifier: GPL-3.0-or-later
"""Origins of the rays that leave a vertex of a path, and the medium they start in.

The vertex is on a face or in the middle of a volume.
"""

from __future__ import annotations

import numpy as np

from ..surfaces.surface import SurfacePoints
from ..vectors import dot
from .coplanar import CoplanarFaces
from .kernel import Kernel
from .visibility import coplanar_transmittance


class SurfaceOrigins:
    """Origins (3, n) of rays that leave points: off the plane by what float32 can resolve.

    `medium` (n,) is what the rays were in that came to the points, None where there are no volumes.
    """

    def __init__(
        self, kernel: Kernel, points: SurfacePoints, offset: np.ndarray, medium: np.ndarray | None = None
    ) -> None:
        self.points, self._kernel, self._offset, self._medium = points, kernel, offset, medium
        self._front = self._off(offset) if kernel.one_sided else None

    def _off(self, height: np.ndarray) -> np.ndarray:
        origin = self.points.ng * height
        origin += self.points.position
        return origin

    def towards(self, direction: np.ndarray) -> np.ndarray:
        """Origins on the side of `direction`.

        Where no light passes through, they are on the visible side: rays to the other side carry no light.
        """
        if self._front is not None:
            return self._front
        return self._off(np.copysign(self._offset, dot(self.points.ng, direction)))

    def medium(self, index: np.ndarray, direction: np.ndarray) -> np.ndarray | None:
        """The media of rays that leave the points at `index` along `direction` (3, k).

        None where there are no volumes.
        """
        media = self._kernel.media
        if media is None or self._medium is None:
            return None
        return media.beyond(self._medium[index], self.points.at(index), direction)

    def coplanar(
        self, faces: CoplanarFaces, index: np.ndarray, direction: np.ndarray, tally: np.ndarray | None
    ) -> np.ndarray:
        """The light that `faces` in the planes of the points at `index` let through, (3, k).

        The rays leave along `direction` (3, k), with the counts `tally` (counts, k); see coplanar.py.
        """
        return coplanar_transmittance(self._kernel, faces, self.points.at(index), direction, tally)


class VolumeOrigins:
    """Points `position` (3, n) in the middle of a `medium` (n,), which rays leave as they are."""

    def __init__(self, position: np.ndarray, medium: np.ndarray) -> None:
        self._position, self._medium = position, medium

    def towards(self, direction: np.ndarray) -> np.ndarray:
        """The points themselves."""
        return self._position

    def medium(self, index: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """The medium of the points at `index`."""
        return self._medium[index]

    def coplanar(
        self, faces: CoplanarFaces, index: np.ndarray, direction: np.ndarray, tally: np.ndarray | None
    ) -> float:
        """1: there is no face."""
        return 1.0
