# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights that share a plane, and an area of it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from .lights import AreaLight, Light
from .overlap_pairs import overlap_area

# Two planes are one where single precision cannot tell the distances to them apart.
_RESOLVED = 2.0**-24
# Corners of the polygon that stands for an ellipse.
_CORNERS = 64
# Less than this part of the smaller light is an edge that both share.
_LEAST = 1e-6


def find_light_overlaps(lights: Sequence[Light]) -> list[tuple[int, int, float]]:
    """Pairs of area lights that shine to the same side of one plane, and overlap.

    Each is (index, index, square metres that both cover).
    """
    shining = [(k, one) for k, one in enumerate(lights) if isinstance(one, AreaLight) and any(one.radiance)]
    found = []
    for (a, first), (b, second) in itertools.combinations(shining, 2):
        if not _share_a_plane(first, second):
            continue
        area = _shared_area(first, second)
        if area > _LEAST * min(_area(first), _area(second)):
            found.append((a, b, area))
    return found


def _share_a_plane(first: AreaLight, second: AreaLight) -> bool:
    normal, other = np.array(first.normal), np.array(second.normal)
    centers = np.array(first.center), np.array(second.center)
    size = max(np.abs(centers).max(), math.sqrt(_area(first)), math.sqrt(_area(second)))
    apart = abs(float(normal @ (centers[1] - centers[0])))
    return bool(np.abs(normal - other).max() <= 4.0 * _RESOLVED and apart <= 4.0 * _RESOLVED * size)


def _area(light: AreaLight) -> float:
    area = float(np.linalg.norm(np.cross(light.edge_u, light.edge_v)))
    return area if light.shape == "RECTANGLE" else 0.25 * math.pi * area


def _shared_area(first: AreaLight, second: AreaLight) -> float:
    """Square metres that both cover."""
    across = np.array(first.edge_u) / np.linalg.norm(first.edge_u)
    axes = np.stack([across, np.cross(first.normal, across)])
    one, other = (_triangles(light, axes, np.array(first.center)) for light in (first, second))
    pairs = np.array(list(itertools.product(range(one.shape[2]), range(other.shape[2])))).T
    return float(overlap_area(one[:, :, pairs[0]], other[:, :, pairs[1]]).sum())


def _triangles(light: AreaLight, axes: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """The triangles (3 corners, 2, n) of a light in the plane of `axes` (2, 3) about `origin`."""
    if light.shape == "RECTANGLE":
        s, t = np.array([-0.5, 0.5, 0.5, -0.5]), np.array([-0.5, -0.5, 0.5, 0.5])
    else:
        angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS, endpoint=False)
        s, t = 0.5 * np.cos(angle), 0.5 * np.sin(angle)
    corners = np.array(light.center)[:, None] + np.outer(light.edge_u, s) + np.outer(light.edge_v, t)
    flat = axes @ (corners - origin[:, None])
    following = np.arange(1, flat.shape[1] - 1)
    return np.stack([np.repeat(flat[:, :1], following.size, axis=1), flat[:, following], flat[:, following + 1]])
