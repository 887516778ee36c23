# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: transparent surfaces; at each hit a path either passes straight on or scatters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..surfaces.surface import SurfacePoints
from .coplanar import place_left
from .kernel import Kernel
from .paths import Paths

Groups = list[tuple[int, int, int]]


@dataclass(frozen=True)
class Split:
    """The hits, split into those that pass through and those that scatter.

    `passing` paths are already on the far side. `index` are the hits that scatter, with their groups; `share` (n,) of
    all hits that do.
    """

    passing: Paths
    index: np.ndarray
    groups: Groups
    share: np.ndarray


def split(
    kernel: Kernel,
    paths: Paths,
    alive: np.ndarray,
    points: SurfacePoints,
    distance: np.ndarray,
    offset: np.ndarray,
    groups: Groups,
    uniform: np.ndarray,
    most_bounces: int,
) -> Split:
    """Decide by `uniform` which paths pass through.

    The chance is that of the transparent lobe among all lobes.
    Bounces are counted as Cycles counts them: passing is no scattering, but a path that has used up its bounces stops,
    and so does one that is not `alive`, (n,) bool: it has passed max(transparent_max_bounces, 1) surfaces.
    """
    factor = np.zeros_like(paths.throughput)
    chance = np.zeros(paths.size)
    for material, a, b in groups:
        if kernel.materials[material].transparent:
            here = points.part(a, b)
            factor[:, a:b] = kernel.materials[material].transparency(here)
            through = np.abs(factor[:, a:b]).mean(axis=0)
            total = through + kernel.materials[material].scattered_share(here)
            chance[a:b] = np.divide(through, total, out=np.zeros(b - a), where=total > 0.0)
    passes = alive & (uniform < chance)
    scatters = alive & ~passes & (chance < 1.0) & paths.may_scatter(most_bounces, kernel.scene.transport.volume_bounces)
    index = np.flatnonzero(scatters)
    counts = [(material, int(np.count_nonzero(scatters[a:b]))) for material, a, b in groups]
    stops = np.cumsum([n for _, n in counts])
    kept = [(material, int(stop - n), int(stop)) for (material, n), stop in zip(counts, stops, strict=True) if n]
    return Split(
        _passed(kernel, paths, points, distance, offset, factor, chance, np.flatnonzero(passes)),
        index,
        kept,
        1.0 - chance,
    )


def _passed(
    kernel: Kernel,
    paths: Paths,
    points: SurfacePoints,
    distance: np.ndarray,
    offset: np.ndarray,
    factor: np.ndarray,
    chance: np.ndarray,
    index: np.ndarray,
) -> Paths:
    going = paths.take(index)
    going.throughput *= np.take(factor, index, axis=1) / chance[index]
    going.origin = np.take(points.position, index, axis=1) - np.take(points.ng, index, axis=1) * offset[index]
    if going.travelled is not None and going.passed is not None:
        going.travelled += distance[index]
        going.passed += 1 if kernel.media is None else kernel.is_counted(points.triangle[index])
    if kernel.media is not None and paths.medium is not None:
        going.medium = kernel.media.crossed(paths.medium, points, np.ones(paths.size, bool))[index]
    if going.left is not None:
        going.left, going.left_uv = place_left(points, index)
    return going
