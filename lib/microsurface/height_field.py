# SPDX-License-Identifier: GPL-3.0-or-later
"""Height fields with Gaussian heights and slopes.

This is the surface that Beckmann's distribution describes.
"""

from __future__ import annotations

import numpy as np

from ..scene.mesh import Mesh, Object


def gaussian_field(rng: np.random.Generator, cells: int, correlation: float, alpha: float) -> np.ndarray:
    """Return the heights (cells, cells) of a periodic field with Beckmann's `alpha`.

    The heights are in cells; `alpha` is that of the slopes.

    Gaussian heights with the autocorrelation exp(-(r / correlation)^2), `correlation` in cells, made of white noise
    by its spectrum. The slopes of the triangles, differences between neighbours, then have the variance alpha^2 / 2
    along each axis (Beckmann and Spizzichino 1963, ch. 5; Heitz 2014, sec. 5.3): the heights are scaled so that they
    have it exactly in the mean.
    """
    frequency = 2.0 * np.pi * np.fft.fftfreq(cells)
    squared = np.add.outer(frequency**2, frequency**2)[:, : cells // 2 + 1]
    power = np.exp(-0.25 * squared * correlation**2)
    noise = np.fft.rfft2(rng.standard_normal((cells, cells)))
    heights = np.fft.irfft2(noise * np.sqrt(power / power_mean(power, cells)), s=(cells, cells))
    return heights * alpha / (2.0 * np.sqrt(-np.expm1(-(correlation**-2.0))))


def power_mean(power: np.ndarray, cells: int) -> float:
    """Return the mean over all frequencies of a spectrum (cells, cells // 2 + 1).

    `rfft2` halves the spectrum. The mean is the variance that it gives to white noise.
    """
    columns = np.full(power.shape[1], 2.0)
    columns[0] = 1.0
    if cells % 2 == 0:
        columns[-1] = 1.0
    return float((power * columns).sum() / cells**2)


def tiled_mesh(heights: np.ndarray, margin: int) -> Mesh:
    """Return the triangles of a periodic field (n, n), one cell wide each.

    They are repeated by `margin` cells on every side.

    The field itself covers 0 to n along x and y. Both diagonals of a cell occur, in a chessboard's order, so that
    none is preferred.
    """
    count = heights.shape[0]
    index = np.arange(-margin, count + margin + 1)
    side = index.size
    x, y = np.meshgrid(index.astype(float), index.astype(float), indexing="ij")
    z = heights[np.ix_(index % count, index % count)]
    corner = np.arange(side * side, dtype=np.int32).reshape(side, side)
    a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]))
    rising = (np.add.outer(index[:-1], index[:-1]) % 2 == 0).ravel()
    first = np.where(rising, (a, b, c), (a, b, d))
    second = np.where(rising, (a, c, d), (b, c, d))
    triangles = np.concatenate([first, second], axis=1).astype(np.int32)
    many = triangles.shape[1]
    return Mesh(
        vertices=np.stack([x.ravel(), y.ravel(), z.ravel()]),
        triangles=triangles,
        material_index=np.zeros(many, np.int32),
        object_index=np.zeros(many, np.int32),
        smooth=np.zeros(many, bool),
        corner_normals=np.zeros((3, 3, 0), np.float32),
        objects=(Object("height field", np.eye(4)[:3]),),
    )
