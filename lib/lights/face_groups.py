# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive faces, long ones cut into strips, in groups of near ones, so that groups can be chosen by place."""

from __future__ import annotations

import math
from heapq import heappop, heappush
from typing import NamedTuple

import numpy as np

from .cells import Parts

# Strips are at least this part of the extent of all faces, and there are at most so many beside whole faces.
_LEAST_STRIP, _MOST_STRIPS = 1.0 / 48.0, 4096
# What differs by less than this share counts as equal, so that rounding does not choose: a scene that lies elsewhere is divided alike.
_EQUAL = 1e-6


class Strips(NamedTuple):
    """Faces cut into strips across their length.

    The corners of a face, turned by `turn` (t,), 0 to 2, have the far one second. Its `count` (t,) of strips are parallel to the side
    opposite that corner, and evenly apart, from the corner on. A whole face is one strip; its corners are not turned.
    """

    turn: np.ndarray
    count: np.ndarray

    def turned(self, corners: np.ndarray) -> np.ndarray:
        """The corners (3, ..., t) in the order of the strips."""
        order = (np.arange(3)[:, None] + self.turn) % 3
        return np.take_along_axis(corners, order if corners.ndim == 2 else order[:, None], axis=0)


class Pieces(NamedTuple):
    """All strips of faces, face after face.

    `face` (p,) of each, `low` and `high` (3, p) of the boxes that hold them, in metres. A strip has the `share` (p,) of its face's area,
    and what is nearer to the far corner has `before`.
    """

    face: np.ndarray
    low: np.ndarray
    high: np.ndarray
    before: np.ndarray
    share: np.ndarray


class FaceGroups(NamedTuple):
    """Groups of near pieces of faces.

    `order` (p,) are the indices of pieces with power, group after group; group k has those from `first[k]` to `first[k + 1]`, with
    `first` (g + 1,). `parts` are the groups' power and the balls that hold them.
    """

    order: np.ndarray
    first: np.ndarray
    parts: Parts


class DividedFaces(NamedTuple):
    """Faces of a `power` (t,) in W, cut into strips, the pieces that these are, and groups of near ones."""

    power: np.ndarray
    strips: Strips
    pieces: Pieces
    groups: FaceGroups


def divide_faces(corners: np.ndarray, power: np.ndarray, most: int) -> DividedFaces:
    """Divide faces into at most `most` groups of near pieces.

    `corners` (3, 3, t), metres: of each face by corner and coordinate. `power` (t,), not negative. Without any there are no groups.
    """
    strips = cut_faces(corners)
    pieces = make_pieces(strips.turned(corners), strips)
    return DividedFaces(power, strips, pieces, group_pieces(pieces, power[pieces.face] * pieces.share, most))


def cut_faces(corners: np.ndarray) -> Strips:
    """Cut those faces into strips that are long beside the extent of all.

    `corners` (3, 3, t), metres: of each face by corner and coordinate.
    """
    sides = np.stack([corners[(k + 1) % 3] - corners[(k + 2) % 3] for k in range(3)])  # opposite each corner
    lengths = np.sqrt(np.square(sides).sum(axis=1))
    extent = float((corners.max(axis=(0, 2)) - corners.min(axis=(0, 2))).max())
    count = np.maximum(np.ceil(lengths.max(axis=0) / max(_LEAST_STRIP * extent, 1e-300) - _EQUAL), 1.0)
    count = np.minimum(count, max(_MOST_STRIPS // max(int((count > 1.0).sum()), 1), 1)).astype(np.intp)
    far = np.argmax(lengths <= lengths.min(axis=0) * (1.0 + _EQUAL), axis=0)
    return Strips(np.where(count > 1, (far - 1) % 3, 0), count)


def make_pieces(corners: np.ndarray, strips: Strips) -> Pieces:
    """The strips of faces whose `corners` (3, 3, t) are in the order of the strips."""
    face = np.repeat(np.arange(strips.count.size), strips.count)
    count = strips.count[face]
    number = np.arange(face.size) - (np.cumsum(strips.count) - strips.count)[face]
    ends = []
    for away in (number / count, (number + 1) / count):
        for side in (0, 2):
            ends.append(corners[1][:, face] + away * (corners[side] - corners[1])[:, face])
    before = np.square(number / count)
    return Pieces(face, np.min(ends, axis=0), np.max(ends, axis=0), before, np.square((number + 1) / count) - before)


def group_pieces(pieces: Pieces, power: np.ndarray, most: int) -> FaceGroups:
    """Divide pieces of faces into at most `most` groups of near ones.

    `power` (p,), not negative. The group with the largest product of power and radius is halved, across the longest side of the box
    about its pieces' middles.
    """
    low, high = pieces.low, pieces.high
    middle = 0.5 * (low + high)

    def ranked(index: np.ndarray, number: int) -> tuple[float, int, np.ndarray]:
        """What a heap is sorted by: groups that cannot be halved come last."""
        size = power[index].sum() * _ball(low[:, index], high[:, index])[1]
        steps = round(math.log2(size) / _EQUAL) if index.size > 1 and size > 0.0 else None
        return (math.inf if steps is None else -steps, number, index)

    shining = np.flatnonzero(power > 0.0)
    if shining.size == 0:
        return FaceGroups(shining, np.zeros(1, np.intp), Parts(np.zeros(0), np.zeros((3, 0)), np.zeros(0)))
    heap = [ranked(shining, 0)]
    while len(heap) < most and heap[0][0] < math.inf:
        index = heappop(heap)[2]
        for half in _halves(middle, index):
            heappush(heap, ranked(half, int(half[0])))
    groups = [index for _, _, index in sorted(heap, key=lambda one: one[1])]
    balls = [_ball(low[:, index], high[:, index]) for index in groups]
    parts = Parts(
        np.array([power[index].sum() for index in groups]),
        np.stack([center for center, _ in balls], axis=1),
        np.array([radius for _, radius in balls]),
    )
    return FaceGroups(np.concatenate(groups), np.cumsum([0, *(index.size for index in groups)]), parts)


def _ball(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, float]:
    """Middle (3,) and radius of the box about boxes from `low` to `high`, (3, k) each."""
    least, most = low.min(axis=1), high.max(axis=1)
    return 0.5 * (least + most), 0.5 * float(np.sqrt(np.square(most - least).sum()))


def _halves(middle: np.ndarray, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The pieces at `index` (k,), at least two, on the two sides of the middle of the box about their middles."""
    here = middle[:, index]
    least, most = here.min(axis=1), here.max(axis=1)
    extent = most - least
    along = int(np.argmax(extent >= extent.max() * (1.0 - _EQUAL)))
    beyond = here[along] > 0.5 * (least + most)[along] + _EQUAL * extent[along]
    if not beyond.any():  # all in one place
        beyond = np.arange(index.size) >= index.size // 2
    return index[~beyond], index[beyond]
