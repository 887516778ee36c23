# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's procedural textures, each a function of coordinates.

They are gradients, waves, bricks, magic and noise.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..scene import procedural as pr
from ..scene.expressions import Expression
from .context import InputEvaluator
from .hashes import WHITE_NOISE, hash_rows
from .noise import fbm, noise_texture
from .voronoi import voronoi_node

_TURN = 2.0 * np.pi


def gradient(kind: str, vector: np.ndarray) -> np.ndarray:
    """The Gradient texture, (n,) in [0, 1]."""
    x, y, z = vector
    if kind == "LINEAR":
        f = x
    elif kind == "QUADRATIC":
        f = np.square(np.maximum(x, 0.0))
    elif kind == "EASING":
        r = np.clip(x, 0.0, 1.0)
        f = r * r * (3.0 - 2.0 * r)
    elif kind == "DIAGONAL":
        f = 0.5 * (x + y)
    elif kind == "RADIAL":
        f = np.arctan2(y, x) / _TURN + 0.5
    else:
        f = np.maximum(0.999999 - np.sqrt(x * x + y * y + z * z), 0.0)
        f = f * f if kind == "QUADRATIC_SPHERE" else f
    return np.clip(f, 0.0, 1.0)


def _wave(node: pr.Wave, read: InputEvaluator) -> np.ndarray:
    p = (read(node.vector) * read(node.scale) + 1e-6) * 0.999999  # off the steps at whole coordinates, as in Cycles
    axes = "XYZ"
    if node.kind == "BANDS":
        n = p[axes.index(node.direction)] * 20.0 if node.direction in axes else p.sum(axis=0) * 10.0
    else:
        across = [p[k] for k in range(3) if axes[k] != node.direction]
        n = np.sqrt(sum(c * c for c in across)) * 20.0
    n = n + read(node.phase)
    distortion = read(node.distortion)
    if np.any(distortion):
        at = list(p * read(node.detail_scale))
        n = n + distortion * (
            2.0 * fbm(at, read(node.detail), read(node.detail_roughness), np.asarray(2.0), True) - 1.0
        )
    if node.profile == "SIN":
        return 0.5 - 0.5 * np.cos(n)
    n = n / _TURN
    return n - np.floor(n) if node.profile == "SAW" else 2.0 * np.abs(n - np.floor(n + 0.5))


# The steps of the Magic texture: which of x, y, z is set anew, to which function of which signed sum of the three.
_MAGIC = (
    (1, lambda a: -np.cos(a), (1, -1, 1)),
    (0, np.cos, (1, -1, -1)),
    (2, np.sin, (-1, -1, -1)),
    (0, lambda a: -np.cos(a), (-1, 1, -1)),
    (1, lambda a: -np.sin(a), (-1, 1, 1)),
    (1, lambda a: -np.cos(a), (-1, 1, 1)),
    (0, np.cos, (1, 1, 1)),
    (2, np.sin, (1, 1, -1)),
    (0, lambda a: -np.cos(a), (-1, -1, 1)),
    (1, lambda a: -np.sin(a), (1, -1, 1)),
)


def magic(vector: np.ndarray, scale: np.ndarray, distortion: np.ndarray, depth: int) -> np.ndarray:
    """The Magic texture, (3, n)."""
    px, py, pz = np.fmod(vector * scale, _TURN)
    c = [np.sin((px + py + pz) * 5.0), np.cos((-px + py - pz) * 5.0), -np.cos((-px - py + pz) * 5.0)]
    if depth > 0:
        c = [v * distortion for v in c]
    for axis, function, signs in _MAGIC[:depth]:
        c[axis] = function(sum(s * v for s, v in zip(signs, c, strict=True))) * distortion
    twice = np.where(distortion != 0.0, 2.0 * distortion, 1.0)
    return np.stack([0.5 - v / twice for v in c])


def _brick_noise(n: np.ndarray) -> np.ndarray:
    """A number in [0, 1] for whole numbers, uint32."""
    with np.errstate(over="ignore"):
        n = (n + np.uint32(1013)) & np.uint32(0x7FFFFFFF)
        n = (n >> np.uint32(13)) ^ n
        n = (n * (n * n * np.uint32(60493) + np.uint32(19990303)) + np.uint32(1376312589)) & np.uint32(0x7FFFFFFF)
    return 0.5 * (n.astype(np.float32).astype(np.float64) / 1073741824.0)


def _brick(node: pr.Brick, read: InputEvaluator) -> np.ndarray:
    x, y, _ = read(node.vector) * read(node.scale)
    width, height = read(node.brick_width), read(node.row_height)
    row = np.floor(y / height)
    shift = np.zeros_like(row)
    if node.offset_frequency and node.squash_frequency:
        # Counted as C does, towards zero: it is only asked whether nothing remains.
        width = width * np.where(np.fmod(row, node.squash_frequency) != 0.0, 1.0, node.squash)
        shift = np.where(np.fmod(row, node.offset_frequency) != 0.0, 0.0, width * node.offset)
    brick = np.floor((x + shift) / width)
    inside_x, inside_y = x + shift - width * brick, y - height * row
    word = (row.astype(np.int64) << 16) + (brick.astype(np.int64) & 0xFFFF)
    tint = np.clip(_brick_noise(word.astype(np.uint32)) + read(node.bias), 0.0, 1.0)
    edge = np.minimum(np.minimum(inside_x, inside_y), np.minimum(width - inside_x, height - inside_y))
    size, smooth = read(node.mortar_size), read(node.mortar_smooth)
    depth = np.where(size > 0.0, 1.0 - edge / np.where(size > 0.0, size, 1.0), 0.0)
    soft = np.clip(depth / np.where(smooth != 0.0, smooth, 1.0), 0.0, 1.0)
    soft = np.where(smooth == 0.0, 1.0, soft * soft * (3.0 - 2.0 * soft))
    mortar = np.where(edge >= size, 0.0, soft)
    if node.output == "FACTOR":
        return mortar
    stone = np.where(mortar == 1.0, read(node.color1), (1.0 - tint) * read(node.color1) + tint * read(node.color2))
    return stone * (1.0 - mortar) + read(node.mortar) * mortar


def point_of(vector: np.ndarray, w: np.ndarray, dimensions: int) -> list[np.ndarray]:
    """The coordinates that a texture of so many dimensions reads, of one shape (n,)."""
    parts = [w] if dimensions == 1 else [*vector[: min(dimensions, 3)], *([w] if dimensions == 4 else [])]
    return [np.array(part) for part in np.broadcast_arrays(*(np.atleast_1d(part) for part in parts))]


def _noise(node: pr.Noise, read: InputEvaluator) -> np.ndarray:
    scale = read(node.scale)
    point = point_of(read(node.vector) * scale, read(node.w) * scale, node.dimensions)
    fractal = read(node.detail), read(node.roughness), read(node.lacunarity), read(node.offset), read(node.gain)
    return noise_texture(point, node.kind, fractal, read(node.distortion), node.normalize, node.output == "COLOR")


def white_noise(point: list[np.ndarray], colored: bool) -> np.ndarray:
    """The White Noise texture: (n,), or (3, n) if `colored`."""
    rows = WHITE_NOISE[len(point)]
    return hash_rows(point, rows) if colored else hash_rows(point, rows[:1])[0]


PATTERNS: dict[type[Expression], Callable[..., np.ndarray]] = {
    pr.Gradient: lambda node, read: gradient(node.kind, read(node.vector)),
    pr.Wave: _wave,
    pr.Magic: lambda node, read: magic(read(node.vector), read(node.scale), read(node.distortion), node.depth),
    pr.Brick: _brick,
    pr.Noise: _noise,
    pr.WhiteNoise: lambda node, read: white_noise(
        point_of(read(node.vector), read(node.w), node.dimensions), node.output == "COLOR"
    ),
    pr.Voronoi: voronoi_node,
}
"""Node type -> function of the node and the evaluator."""
