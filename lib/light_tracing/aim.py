# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions from a light that can lead to targets, and few others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..lights.cone import uniform_cone
from ..lights.light import Ball, Pair
from ..sampling.tables import Distribution1D
from ..vectors import dot


class Aim:
    """Samples directions uniform in the cones from a light's ball to its targets.

    The targets are balls. Each is chosen by its solid angle.

    A ray from a point of one ball, radius r, to a point of another, radius R at distance D, makes an angle of at most
    asin((r + R) / D) with the line between their middles. Balls that meet are aimed at in all directions.
    """

    def __init__(self, extent: Ball, targets: Sequence[Ball]) -> None:
        toward = np.hstack([target.center - extent.center for target in targets])
        distance = np.sqrt(dot(toward, toward))
        sine = np.array([target.radius for target in targets]) + extent.radius
        apart = distance > sine
        sine = np.where(apart, sine / np.where(apart, distance, 1.0), 1.0)
        # 1 - cos = sin^2 / (1 + cos) keeps the digits of a narrow cone.
        self._spread = np.where(apart, sine * sine / (1.0 + np.sqrt(1.0 - sine * sine)), 2.0)
        self._axis = np.where(apart, toward / np.where(apart, distance, 1.0), np.array([[0.0], [0.0], [1.0]]))
        self._choice = Distribution1D(self._spread)
        self.solid_angle = 2.0 * np.pi * float(self._spread.sum())

    def sample(self, heading: Pair) -> tuple[np.ndarray, np.ndarray]:
        """Sample directions (3, n) and return their density (n,) per steradian.

        The density is the number of cones that hold a direction, over all solid angle.
        """
        which, rest = self._choice.sample(heading[0])
        direction, _ = uniform_cone(np.take(self._axis, which, axis=1), np.take(self._spread, which), rest, heading[1])
        held = np.zeros(which.size)
        for k, spread in enumerate(self._spread):
            beside = direction - self._axis[:, k : k + 1]
            held += (which == k) | (dot(beside, beside) <= 2.0 * spread)
        return direction, held / self.solid_angle
