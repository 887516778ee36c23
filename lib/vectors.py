# SPDX-License-Identifier: GPL-3.0-or-later
"""Vectors of shape (3, n): products, normalisation, local frames, picking and writing some of them."""

from __future__ import annotations

import numpy as np


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar product, (n,)."""
    product = a[0] * b[0]
    product += a[1] * b[1]
    product += a[2] * b[2]
    return product


def normalize(v: np.ndarray) -> np.ndarray:
    """Unit vectors, (3, n); a zero vector stays zero."""
    length = np.sqrt(dot(v, v))
    return v / np.where(length > 0.0, length, 1.0)


def gather(values: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Copies of the elements at `index` (k,) of the last axis, (..., k).

    All indices must be in range. It is not checked, which saves a third of the time: beyond an end its last element is taken.
    """
    return values.take(index, axis=-1, mode="clip")


def put(whole: np.ndarray, index: np.ndarray, part: np.ndarray) -> None:
    """Write `part` (k,) or (3, k) into `whole` (n,) or (3, n) at `index` (k,), row by row.

    This takes a third of the time of one masked write.
    """
    for row, values in zip(np.atleast_2d(whole), np.atleast_2d(part), strict=True):
        row[index] = values


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Vector product, (3, n)."""
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(a[j], b[k], out=product[i])
        product[i] -= a[k] * b[j]
    return product


def orthonormal_basis(n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across `n`, right-handed with it; Duff et al. 2017, listing 3."""
    x, y, z = n
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y
    b *= a
    t, s = np.empty_like(n), np.empty_like(n)
    a_sign = sign * a
    np.multiply(x, x, out=t[0])
    t[0] *= a_sign
    t[0] += 1.0
    np.multiply(sign, b, out=t[1])
    np.multiply(sign, x, out=t[2])
    np.negative(t[2], out=t[2])
    s[0] = b
    np.multiply(y, y, out=s[1])
    s[1] *= a
    s[1] += sign
    np.negative(y, out=s[2])
    return t, s


def to_local(v: np.ndarray, t: np.ndarray, s: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Components of `v` along t, s, n, (3, n)."""
    local = np.empty_like(v)
    scratch = np.empty(v.shape[1])
    for axis, row in zip((t, s, n), local, strict=True):
        np.multiply(axis[0], v[0], out=row)
        np.multiply(axis[1], v[1], out=scratch)
        row += scratch
        np.multiply(axis[2], v[2], out=scratch)
        row += scratch
    return local


def to_world(v: np.ndarray, t: np.ndarray, s: np.ndarray, n: np.ndarray) -> np.ndarray:
    """The vector with components `v` along t, s, n, (3, n)."""
    world = np.empty_like(v)
    scratch = np.empty(v.shape[1])
    for k, row in enumerate(world):
        np.multiply(t[k], v[0], out=row)
        np.multiply(s[k], v[1], out=scratch)
        row += scratch
        np.multiply(n[k], v[2], out=scratch)
        row += scratch
    return world


def basis_across(n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors across `n`, (3, n) each: along (1, 1, 1) x n, and what completes the frame.

    They are Cycles' own: with a few probes the mean of unit vectors depends on the axes.
    """
    x, y, z = n
    even = (x == y) & (x == z)
    first = normalize(np.stack([z - y, np.where(even, x + z, x - z), np.where(even, -y - x, y - x)]))
    return first, cross(n, first)


def rotate_about(v: np.ndarray, axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Rodrigues' rotation of `v` about unit `axis`."""
    c, s = np.cos(angle), np.sin(angle)
    return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1.0 - c))


def any_perpendicular(n: np.ndarray) -> np.ndarray:
    """A unit vector across n, (3, n)."""
    x, _, z = n
    other = np.where(np.abs(x) > 0.9, 0.0, 1.0)
    return normalize(cross(n, np.stack([other, 1.0 - other, np.zeros_like(z)])))
