# SPDX-License-Identifier: GPL-3.0-or-later
"""Where rays that leave points begin."""

from __future__ import annotations

import numpy as np

from ..surfaces.surface import SurfacePoints
from ..vectors import dot


class Origins:
    """Origins (3, n) of rays that leave points: off the plane by what float32 can resolve."""

    def __init__(self, points: SurfacePoints, offset: np.ndarray, one_sided: bool) -> None:
        self.points, self._offset = points, offset
        self._front = self._off(offset) if one_sided else None

    def _off(self, height: np.ndarray) -> np.ndarray:
        origin = self.points.ng * height
        origin += self.points.position
        return origin

    def towards(self, direction: np.ndarray) -> np.ndarray:
        """On the side of `direction`; where no light passes through, the side that is seen: the others carry none."""
        if self._front is not None:
            return self._front
        return self._off(np.copysign(self._offset, dot(self.points.ng, direction)))
