# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that lie on top of one another: by the book they are one, in Cycles they shadow each other."""

from __future__ import annotations

import numpy as np

from .mesh import Mesh

# Odd multipliers and a shift that spread the bits of a coordinate over 64 (Steele et al. 2014, SplitMix).
_MULTIPLIERS = np.array([0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB], np.uint64)
_SHIFT = np.uint64(31)


def coincident_faces(mesh: Mesh) -> np.ndarray:
    """(t,) whether the corners of a triangle are, in any order, where those of another one are, to the last bit."""
    places = np.zeros(mesh.vertices.shape[1], np.uint64)
    for row in mesh.vertices:
        places += (row + 0.0).view(np.uint64)  # -0 becomes 0
        for multiplier in _MULTIPLIERS:
            places *= multiplier
            places ^= places >> _SHIFT
    keys = np.take(places, mesh.triangles[0])
    for corners in mesh.triangles[1:]:
        keys += np.take(places, corners)
    order = np.argsort(keys)
    keys = keys[order]
    same = keys[1:] == keys[:-1]
    found = np.zeros(keys.size, bool)
    found[order[:-1][same]] = found[order[1:][same]] = True
    return found
