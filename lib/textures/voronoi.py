# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Voronoi texture in one to four dimensions, plain and fractal.

Cells hold one random point each; what is found are the nearest of them, or the walls between. A point is a list of coordinates, (n,) each.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..scene.procedural import Voronoi
from .context import InputEvaluator
from .hashes import WHITE_NOISE, hash_floats, hash_rows, pcg

_SAME_POINT = 1e-4


@dataclass(frozen=True)
class Found:
    """Distance (n,), colour (3, n) and position (d, n) of a cell's point, or sums of those."""

    distance: np.ndarray
    color: np.ndarray
    position: np.ndarray


@dataclass(frozen=True)
class Shape:
    """How distance is measured, and how far points stray in their cells."""

    metric: str
    exponent: np.ndarray
    randomness: np.ndarray
    smoothness: np.ndarray
    hashing: str = "PCG"

    def site(self, cell: np.ndarray) -> np.ndarray:
        """Where the point of a cell (d, n) lies within it, (d, n)."""
        if cell.shape[0] == 1:
            return hash_floats(cell[0])[None] * self.randomness
        found = pcg(cell) if self.hashing == "PCG" else hash_rows(cell, _LOOKUP3_SITE[cell.shape[0]])
        return found * self.randomness

    def color(self, cell: np.ndarray) -> np.ndarray:
        """A cell's colour, (3, n)."""
        if cell.shape[0] == 1 or self.hashing != "PCG":
            return hash_rows(cell, WHITE_NOISE[cell.shape[0]])
        return pcg(np.concatenate([cell, np.zeros_like(cell[:1])]) if cell.shape[0] == 2 else cell)[:3]

    def distance(self, offset: np.ndarray) -> np.ndarray:
        """Length (n,) of `offset` (d, n)."""
        if self.metric == "EUCLIDEAN" or offset.shape[0] == 1:
            return np.sqrt((offset * offset).sum(axis=0))
        offset = np.abs(offset)
        if self.metric == "MANHATTAN":
            return offset.sum(axis=0)
        if self.metric == "CHEBYCHEV":
            return offset.max(axis=0)
        return (offset**self.exponent).sum(axis=0) ** (1.0 / self.exponent)

    def reach(self, dimensions: int) -> np.ndarray:
        """The largest distance to the nearest point."""
        return self.distance(np.stack([np.atleast_1d(0.5 + 0.5 * self.randomness)] * dimensions))


def _cells(dimensions: int, radius: int) -> Iterator[np.ndarray]:
    """Offsets (d, 1) of the cells around, x fastest."""
    for offset in itertools.product(range(-radius, radius + 1), repeat=dimensions):
        yield np.array(offset[::-1], np.float64)[:, None]


# Which coordinates, and which constants after them, made the numbers of a cell before Blender 5.0: of its point, of its colour.
_LOOKUP3_SITE = {
    2: ((0, 1), (0, 1, 1.0)),
    3: ((0, 1, 2), (0, 1, 2, 1.0), (0, 1, 2, 2.0)),
    4: ((0, 1, 2, 3), (3, 0, 1, 2), (2, 3, 0, 1), (1, 2, 3, 0)),
}


def _nearest(point: np.ndarray, shape: Shape, rank: int) -> Found:
    """The cell's point that is nearest (`rank` 1) or second nearest (2)."""
    base = np.floor(point)
    inside = point - base
    best = [np.full(point.shape[1], np.inf) for _ in range(rank)]
    cells = [np.zeros_like(point) for _ in range(rank)]
    sites = [np.zeros_like(point) for _ in range(rank)]
    for offset in _cells(point.shape[0], 1):
        site = offset + shape.site(base + offset)
        distance = shape.distance(site - inside)
        first = distance < best[0]
        if rank == 2:
            second = ~first & (distance < best[1])
            for row, new in ((best, distance), (cells, offset), (sites, site)):
                row[1] = np.where(first, row[0], np.where(second, new, row[1]))
        for row, new in ((best, distance), (cells, offset), (sites, site)):
            row[0] = np.where(first, new, row[0])
    return Found(best[-1], shape.color(base + cells[-1]), base + sites[-1])


def _smooth(point: np.ndarray, shape: Shape) -> Found:
    """Return the nearest point, blended with its neighbours.

    The result depends on the order of the cells.
    """
    base = np.floor(point)
    inside = point - base
    total: list[np.ndarray] = []
    k = np.where(shape.smoothness != 0.0, shape.smoothness, 1.0)
    for offset in _cells(point.shape[0], 2):
        site = offset + shape.site(base + offset)
        new = [shape.distance(site - inside), shape.color(base + offset), site]
        if not total:
            total = new
            continue
        h = np.clip(0.5 + 0.5 * (total[0] - new[0]) / k, 0.0, 1.0)
        h = h * h * (3.0 - 2.0 * h)
        less = k * h * (1.0 - h)
        rest = less / (1.0 + 3.0 * k)
        total = [(1.0 - h) * a + h * b - c for a, b, c in zip(total, new, (less, rest, rest), strict=True)]
    smooth = Found(total[0], total[1], base + total[2])
    if np.all(shape.smoothness != 0.0):
        return smooth
    sharp = _nearest(point, shape, 1)
    pairs = ((getattr(smooth, name), getattr(sharp, name)) for name in ("distance", "color", "position"))
    return Found(*(np.where(shape.smoothness != 0.0, a, b) for a, b in pairs))


def _to_edge(point: np.ndarray, shape: Shape) -> np.ndarray:
    """Distance to the wall of the cell of the nearest point, (n,)."""
    base = np.floor(point)
    inside = point - base
    if point.shape[0] == 1:
        sites = [k + shape.site(base + k)[0] for k in (-1.0, 0.0, 1.0)]
        walls = (0.5 * (sites[1] + other) for other in (sites[0], sites[2]))
        return np.minimum(*(np.abs(wall - inside[0]) for wall in walls))
    toward = [o + shape.site(base + o) - inside for o in _cells(point.shape[0], 1)]
    best, closest = np.full(point.shape[1], np.inf), np.zeros_like(point)
    for vector in toward:
        distance = (vector * vector).sum(axis=0)
        closest = np.where(distance < best, vector, closest)
        best = np.minimum(best, distance)
    nearest = np.full(point.shape[1], np.inf)
    for vector in toward:
        across = vector - closest
        length2 = (across * across).sum(axis=0)
        apart = length2 > _SAME_POINT
        distance = (0.5 * (closest + vector) * across).sum(axis=0) / np.sqrt(np.where(apart, length2, 1.0))
        nearest = np.where(apart, np.minimum(nearest, distance), nearest)
    return nearest


def _radius(point: np.ndarray, shape: Shape) -> np.ndarray:
    """Half the distance from the nearest point to the one nearest to that, (n,)."""
    base = np.floor(point)
    inside = point - base
    best, site_there, cell = np.full(point.shape[1], np.inf), np.zeros_like(point), np.zeros_like(point)
    for offset in _cells(point.shape[0], 1):
        site = offset + shape.site(base + offset)
        distance = ((site - inside) ** 2).sum(axis=0)
        nearer = distance < best
        best, site_there, cell = (
            np.where(nearer, distance, best),
            np.where(nearer, site, site_there),
            np.where(nearer, offset, cell),
        )
    best = np.full(point.shape[1], np.inf)
    for offset in _cells(point.shape[0], 1):
        if offset.any():
            site = offset + cell + shape.site(base + offset + cell)
            best = np.minimum(best, ((site - site_there) ** 2).sum(axis=0))
    return 0.5 * np.sqrt(best)


@dataclass(frozen=True)
class Fractal:
    """Octaves of a fractal: `detail`, () or (n,), is their number beyond the first.

    Each is `lacunarity` times finer and `roughness` times weaker.
    """

    detail: np.ndarray
    roughness: np.ndarray
    lacunarity: np.ndarray

    def octaves(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield the scale and amplitude of each octave, and its weight, (n,) or ().

        The weight is 1, or the fraction of detail for the last octave.
        """
        scale, amplitude = np.ones(1), np.ones(1)
        for octave in range(int(np.ceil(np.max(self.detail))) + 1):
            yield scale, amplitude, np.clip(self.detail - (octave - 1.0), 0.0, 1.0) if octave else np.ones(1)
            scale, amplitude = scale * self.lacunarity, amplitude * self.roughness


def _mix(a: np.ndarray, b: np.ndarray, t: np.ndarray) -> np.ndarray:
    return (1.0 - t) * a + t * b


def _fractal(point: np.ndarray, feature: str, shape: Shape, fractal: Fractal, normalize: bool) -> Found:
    count = point.shape[1]
    distance, color, position = np.zeros(count), np.zeros((3, count)), np.zeros_like(point)
    largest = np.zeros(1)
    for scale, amplitude, share in fractal.octaves():
        if feature == "SMOOTH_F1" and np.any(shape.smoothness):
            found = _smooth(point * scale, shape)
        else:
            found = _nearest(point * scale, shape, 2 if feature == "F2" else 1)
        largest = largest + share * amplitude
        distance = distance + share * amplitude * found.distance
        color = color + share * amplitude * found.color
        position = _mix(position, _mix(position, found.position / scale, amplitude), share)
    if normalize:
        reach = shape.reach(point.shape[0]) * (2.0 if feature == "F2" else 1.0)
        distance, color = distance / (largest * reach), color / largest
    return Found(distance, color, position)


def _fractal_edge(point: np.ndarray, shape: Shape, fractal: Fractal, normalize: bool) -> np.ndarray:
    reach = 0.5 + 0.5 * shape.randomness
    largest, distance = reach * np.ones(1), np.full(point.shape[1], 8.0)
    for scale, amplitude, share in fractal.octaves():
        nearer = _mix(distance, np.minimum(distance, _to_edge(point * scale, shape) / scale), amplitude)
        broken = share < 1.0
        distance = np.where(broken, _mix(distance, np.minimum(distance, nearer), share), nearer)
        largest = _mix(largest, _mix(largest, reach / scale, amplitude), share)
    return distance / largest if normalize else distance


def voronoi_node(node: Voronoi, read: InputEvaluator) -> np.ndarray:
    """The Voronoi texture: (n,), or (3, n) for its colour and position."""
    scale = read(node.scale)
    vector, w = read(node.vector) * scale, read(node.w) * scale
    rows = [w] if node.dimensions == 1 else [*vector[: min(node.dimensions, 3)], *([w] if node.dimensions == 4 else [])]
    point = np.stack(np.broadcast_arrays(*(np.atleast_1d(row) for row in rows)))
    shape = Shape(
        node.metric,
        read(node.exponent),
        np.clip(read(node.randomness), 0.0, 1.0),
        np.clip(0.5 * read(node.smoothness), 0.0, 0.5),
        node.hashing,
    )
    roughness = np.clip(read(node.roughness), 0.0, 1.0)
    fractal = Fractal(np.clip(read(node.detail), 0.0, 15.0), roughness, read(node.lacunarity))
    if node.feature == "DISTANCE_TO_EDGE":
        return _fractal_edge(point, shape, fractal, node.normalize)
    if node.feature == "N_SPHERE_RADIUS":
        return _radius(point, shape)
    found = _fractal(point, node.feature, shape, fractal, node.normalize)
    if node.output in ("DISTANCE", "COLOR"):
        return found.distance if node.output == "DISTANCE" else found.color
    position = np.where(scale != 0.0, found.position / np.where(scale != 0.0, scale, 1.0), 0.0)
    if node.output == "W":
        return position[-1]
    there = position[:3] if node.dimensions > 1 else position[:0]
    return np.concatenate([there, np.zeros((3 - there.shape[0], point.shape[1]))])
