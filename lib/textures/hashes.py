# SPDX-License-Identifier: GPL-3.0-or-later
"""The integer hashes of Blender's procedural textures, on whole arrays.

They are Jenkins' lookup3 (public domain).
"""

from __future__ import annotations

import numpy as np

_SEED = 0xDEADBEEF + 13
_LARGEST = 1.0 / float(np.float32(0xFFFFFFFF))


def _rotate(x: np.ndarray, k: int) -> np.ndarray:
    return (x << np.uint32(k)) | (x >> np.uint32(32 - k))


def _final(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    c = (c ^ b) - _rotate(b, 14)
    a = (a ^ c) - _rotate(c, 11)
    b = (b ^ a) - _rotate(a, 25)
    c = (c ^ b) - _rotate(b, 16)
    a = (a ^ c) - _rotate(c, 4)
    b = (b ^ a) - _rotate(a, 14)
    return (c ^ b) - _rotate(b, 24)


def _mixed(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    for k in (4, 6, 8, 16, 19, 4):
        a = (a - c) ^ _rotate(c, k)
        c = c + b
        a, b, c = b, c, a  # the round goes on with the next of the three
    return a, b, c


def hash_words(*words: np.ndarray) -> np.ndarray:
    """Hash of one to four uint32 arrays of one shape, uint32."""
    with np.errstate(over="ignore"):
        start = np.uint32((_SEED + 4 * len(words)) & 0xFFFFFFFF)
        a = start + words[0]
        b = start + words[1] if len(words) > 1 else np.full_like(a, start)
        c = start + words[2] if len(words) > 2 else np.full_like(a, start)
        if len(words) == 4:
            a, b, c = _mixed(a, b, c)
            a = a + words[3]
        return _final(a, b, c)


def hash_cells(*cells: np.ndarray) -> np.ndarray:
    """Hash of whole numbers given as floats, by their two's complement, uint32."""
    return hash_words(*(cell.astype(np.int64).astype(np.uint32) for cell in cells))


def unit(hashed: np.ndarray) -> np.ndarray:
    """A hash as a number in [0, 1], rounded as single precision rounds it."""
    return hashed.astype(np.float32).astype(np.float64) * _LARGEST


def hash_floats(*values: np.ndarray | float) -> np.ndarray:
    """A number in [0, 1] for one to four values, by their bits in single precision."""
    arrays = np.broadcast_arrays(*(np.asarray(v, np.float32) for v in values))
    return unit(hash_words(*(np.ascontiguousarray(a).view(np.uint32) for a in arrays)))


# Which coordinates, and which constants after them, are hashed for the three channels of white noise, by dimension.
WHITE_NOISE: dict[int, tuple[tuple[int | float, ...], ...]] = {
    1: ((0,), (0, 1.0), (0, 2.0)),
    2: ((0, 1), (0, 1, 1.0), (0, 1, 2.0)),
    3: ((0, 1, 2), (0, 1, 2, 1.0), (0, 1, 2, 2.0)),
    4: ((0, 1, 2, 3), (2, 0, 3, 1), (3, 2, 1, 0)),
}


def hash_rows(point: np.ndarray | list[np.ndarray], rows: tuple[tuple[int | float, ...], ...]) -> np.ndarray:
    """Return a number in [0, 1] for each of `rows`, (rows, n).

    The rows name coordinates of the point by whole numbers, and add constants.
    """
    return np.stack([hash_floats(*(point[k] if isinstance(k, int) else k for k in row)) for row in rows])


def pcg(cells: np.ndarray) -> np.ndarray:
    """Return two to four numbers in [0, 1] for each cell of whole coordinates, (d, n).

    Jarzynski and Olano 2020, with signed words.
    """
    v = [c.astype(np.int64).astype(np.int32) for c in cells]
    with np.errstate(over="ignore"):
        v = [c * np.int32(1664525) + np.int32(1013904223) for c in v]
        v = _stirred(v)
        v = [c ^ (c >> np.int32(16)) for c in v]
        v = _stirred(v)
    words = np.stack(v) & np.int32(0x7FFFFFFF)
    return words.astype(np.float32).astype(np.float64) * float(np.float32(1.0) / np.float32(0x7FFFFFFF))


def _stirred(v: list[np.ndarray]) -> list[np.ndarray]:
    """One round of multiplying each word into the next."""
    v = list(v)
    if len(v) == 2:
        v[0] = v[0] + v[1] * np.int32(1664525)
        v[1] = v[1] + v[0] * np.int32(1664525)
    elif len(v) == 3:
        v[0] = v[0] + v[1] * v[2]
        v[1] = v[1] + v[2] * v[0]
        v[2] = v[2] + v[0] * v[1]
    else:
        v[0] = v[0] + v[1] * v[3]
        v[1] = v[1] + v[2] * v[0]
        v[2] = v[2] + v[0] * v[1]
        v[3] = v[3] + v[1] * v[2]
    return v
