# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolation between the keys of a motion, as Cycles defines it.

See transform_motion_decompose and camera.cpp in its tree.
"""

from __future__ import annotations

import numpy as np
import scipy

from ..errors import EtalonError


def split_interval(keys: int, time: float) -> tuple[int, float]:
    """Return the key before `time`, and the fraction of the way to the next key.

    There are `keys` keys. `time` and the fraction are 0 to 1.
    """
    first = min(int(time * (keys - 1)), keys - 2)
    return first, time * (keys - 1) - first


def interpolate_linearly(keys: np.ndarray, time: float) -> np.ndarray:
    """Values at `time`, 0 to 1, between keys (k, ...)."""
    first, share = split_interval(len(keys), time)
    return (1.0 - share) * keys[first] + share * keys[first + 1]


def interpolate_directions(keys: np.ndarray, time: float) -> np.ndarray:
    """Unit vectors (corners, 3, n) at `time`, 0 to 1, between keys (k, corners, 3, n) of unit vectors.

    They are linear between keys, then normalised, as in Cycles' motion_triangle_normals. Between opposite keys, whose
    middle has no direction, it is the key before.
    """
    mixed = interpolate_linearly(keys, time)
    length = np.linalg.norm(mixed, axis=1, keepdims=True)
    before = keys[split_interval(len(keys), time)[0]]
    return np.divide(mixed, length, out=before.astype(mixed.dtype), where=length > 0.0)


def decompose(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Decompose a (3, 4) map into a rotation (3, 3) and an upper triangular stretch (3, 3).

    Their product is the linear part of the map.

    The stretch has the scales on its diagonal, all negative where the map mirrors, and shears above it.
    """
    rotation, stretch = np.linalg.qr(matrix[:, :3])
    signs = np.where(np.diag(stretch) < 0.0, -1.0, 1.0)
    rotation, stretch = rotation * signs, stretch * signs[:, None]
    if np.linalg.det(rotation) < 0.0:
        return -rotation, -stretch
    return rotation, stretch


def interpolate_transforms(keys: np.ndarray, time: float) -> np.ndarray:
    """The (3, 4) affine map at `time`, 0 to 1, between keys (k, 3, 4).

    Translation, scale and shear are linear in time. The rotation turns at constant speed about one axis, by the smaller angle.
    """
    first, share = split_interval(len(keys), time)
    (start, stretch), (stop, last_stretch) = (decompose(keys[first + k]) for k in (0, 1))
    turn = scipy.spatial.transform.Rotation.from_matrix(start.T @ stop).as_rotvec()
    rotation = start @ scipy.spatial.transform.Rotation.from_rotvec(share * turn).as_matrix()
    linear = rotation @ ((1.0 - share) * stretch + share * last_stretch)
    return np.column_stack([linear, interpolate_linearly(keys[:, :, 3], time)])


def shutter_times(shutter: np.ndarray | None, uniforms: np.ndarray) -> np.ndarray:
    """Sample times (n,) from 0 to 1 for `uniforms` (n,).

    The times are the inverse of the shutter's distribution at the uniforms.

    The density of a time is proportional to how far the shutter is open then. Raises EtalonError for a shutter that
    never opens.
    """
    if shutter is None:
        return uniforms
    areas = 0.5 * (shutter[1:] + shutter[:-1])
    reached = np.concatenate([[0.0], np.cumsum(areas)])
    if not reached[-1] > 0.0 or (shutter < 0.0).any():
        raise EtalonError("The shutter curve is nowhere open, or below 0; raise its points")
    target = uniforms * reached[-1]
    piece = np.clip(np.searchsorted(reached, target, side="right") - 1, 0, areas.size - 1)
    start, slope = shutter[piece], shutter[piece + 1] - shutter[piece]
    rest = target - reached[piece]
    # start s + slope s^2 / 2 = rest, in the form that does not cancel for small slopes.
    root = start + np.sqrt(np.maximum(start**2 + 2.0 * slope * rest, 0.0))
    share = np.divide(2.0 * rest, root, out=np.zeros_like(rest), where=root > 0.0)
    return (piece + np.clip(share, 0.0, 1.0)) / areas.size
