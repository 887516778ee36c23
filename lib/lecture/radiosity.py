# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiosity (Goral et al. 1984): the light between the patches of a box, by form factors."""

from __future__ import annotations

import numpy as np

from .box import Patches

_NODES = np.array([-1.0, 1.0]) / np.sqrt(3.0)


def point_form_factors(points: np.ndarray, normals: np.ndarray, polygons: np.ndarray) -> np.ndarray:
    """Form factors (n, N) from points to whole polygons above their horizon.

    Points (n, 3) have unit normals (n, 3); polygons are (N, k, 3). Lambert's formula: the sum over edges of the angle
    that each takes up times the cosine between the normal and that of its triangle with the point, over 2 pi (Cohen
    and Wallace 1993, eq. 4.23). Polygons run counterclockwise as seen from their inner side.
    """
    total = np.zeros((len(points), len(polygons)))
    for k in range(polygons.shape[1]):
        a = polygons[None, :, k] - points[:, None]
        b = polygons[None, :, (k + 1) % polygons.shape[1]] - points[:, None]
        edge = np.stack([b[..., i] * a[..., j] - b[..., j] * a[..., i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=2)
        length = np.sqrt((edge * edge).sum(axis=2))
        angle = np.arctan2(length, (a * b).sum(axis=2))
        along = np.einsum("nNc,nc->nN", edge, normals)
        total += np.where(length > 0.0, angle * along / np.where(length > 0.0, length, 1.0), 0.0)
    return np.maximum(total, 0.0) / (2.0 * np.pi)


def form_factors(patches: Patches) -> np.ndarray:
    """F[i, j], the share of the light of patch i that arrives at j, (N, N).

    It is exact for points, and the mean over 2 x 2 Gauss nodes of i.
    """
    corners, total = patches.corners, np.zeros((len(patches.corners),) * 2)
    along, across = corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0]
    for s in _NODES:
        for t in _NODES:
            points = patches.centers + 0.5 * s * along + 0.5 * t * across
            total += point_form_factors(points, patches.normals, corners)
    return total / 4.0


def solve_radiosity(patches: Patches) -> np.ndarray:
    """The radiance that leaves each patch, (N, 3), W m^-2 sr^-1.

    L = emitted + albedo F L, all bounces at once.
    """
    factors = form_factors(patches)
    unity = np.eye(len(factors))
    return np.stack(
        [
            np.linalg.solve(unity - patches.albedos[:, c, None] * factors, patches.emitted[:, c])
            for c in range(patches.emitted.shape[1])
        ],
        axis=1,
    )
