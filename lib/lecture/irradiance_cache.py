# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance caching (Ward et al. 1988).

Indirect light is computed at few places, and interpolated in between.
"""

from __future__ import annotations

import numpy as np

from .box import Patches, find_harmonic_distance
from .radiosity import point_form_factors

_CHUNK = 512


class Gather:
    """The light that arrives at points of the box, without noise.

    It comes from patches of known radiance (N, 3).
    """

    def __init__(self, patches: Patches, radiance: np.ndarray) -> None:
        self._patches, self._radiance = patches, radiance
        self._is_lamp = patches.emitted[:, 0] > 0.0

    def direct(self, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Irradiance over pi of the lamp alone, (n, 3)."""
        lamp = self._is_lamp
        return point_form_factors(points, normals, self._patches.corners[lamp]) @ self._radiance[lamp]

    def indirect(self, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Irradiance over pi of all else, (n, 3)."""
        lit = []
        for start in range(0, len(points), _CHUNK):
            at = points[start : start + _CHUNK]
            factors = point_form_factors(at, normals[start : start + _CHUNK], self._patches.corners)
            lit.append(factors[:, ~self._is_lamp] @ self._radiance[~self._is_lamp])
        return np.concatenate(lit)


def interpolate_indirect(
    gather: Gather, points: np.ndarray, normals: np.ndarray, accuracy: float
) -> tuple[np.ndarray, int]:
    """Indirect irradiance over pi at points (n, 3), and how many records were made for it.

    `normals` are (n, 3).

    A record at distance d, of a place that sees things at the harmonic mean distance R, weighs w = 1 / (d / R +
    sqrt(1 - n.n')). Where no record weighs more than 1 / `accuracy`, a new one is made (Ward, Rubinstein and Clear
    1988, eq. 4 and 5).
    """
    order = np.random.default_rng(0).permutation(len(points))  # coarse to fine: records far apart come first
    distances = find_harmonic_distance(points, normals)
    places, directions = np.zeros((0, 3)), np.zeros((0, 3))
    values, reaches = np.zeros((0, 3)), np.zeros(0)
    for k in order:
        if (
            not len(places)
            or _weights(points[k : k + 1], normals[k : k + 1], places, directions, reaches).max() <= 1.0 / accuracy
        ):
            place, normal = points[k : k + 1], normals[k : k + 1]
            places, directions = np.r_[places, place], np.r_[directions, normal]
            values, reaches = np.r_[values, gather.indirect(place, normal)], np.r_[reaches, distances[k]]
    weights = _weights(points, normals, places, directions, reaches)
    weights = np.where(weights > 1.0 / accuracy, weights, 0.0)
    return weights @ values / weights.sum(axis=1, keepdims=True), len(places)


def _weights(
    points: np.ndarray, normals: np.ndarray, places: np.ndarray, directions: np.ndarray, reaches: np.ndarray
) -> np.ndarray:
    """The weights (n, k) of records (k, ...) at points (n, ...).

    A record at the place itself weighs 1e9.
    """
    away = np.linalg.norm(points[:, None] - places[None], axis=2) / reaches
    turned = np.sqrt(np.clip(1.0 - normals @ directions.T, 0.0, 2.0))
    return 1.0 / np.maximum(away + turned, 1e-9)
