# SPDX-License-Identifier: GPL-3.0-or-later
"""What camera rays meet first: the share of each pixel that shows each material and each object."""

from __future__ import annotations

import numpy as np

from ..sampling.sobol import SobolSampler
from .camera_rays import camera_rays
from .kernel import Kernel
from .render import tiles

TILE_PATHS = 16384


def coverage(kernel: Kernel, samples: int = 16) -> dict[str, list[tuple[str, np.ndarray]]]:
    """Kind ('material', 'object') -> (name, share of each pixel (height, width)); what is not seen is left out."""
    camera, mesh = kernel.scene.camera, kernel.scene.mesh
    pixels = camera.width * camera.height
    sampler = SobolSampler(kernel.options.seed, -1, samples)
    owners = {"material": (mesh.material_index, [m.name for m in kernel.scene.materials])}
    owners["object"] = (mesh.object_index, [o.name for o in mesh.objects])
    counts: dict[str, dict[int, np.ndarray]] = {kind: {} for kind in owners}
    for tile in tiles(pixels, samples, TILE_PATHS):
        index = np.arange(tile.first, tile.last)
        row, column = np.divmod(index, camera.width)
        pixel = np.repeat(np.arange(index.size), tile.stop - tile.start)
        sample = np.tile(np.arange(tile.start, tile.stop), index.size)
        view = sampler.tile(index)
        dx, dy = view.pair(0, pixel, sample)
        lens = view.pair(1, pixel, sample) if kernel.plan.needs("depth of field") else None
        rays = camera_rays(camera, column[pixel] + dx, camera.height - 1.0 - row[pixel] + dy, lens)
        triangle = kernel.caster.closest(rays.origin, rays.direction, rays.reach).triangle
        hit = triangle >= 0
        for kind, (owner, _) in owners.items():
            met = owner[triangle[hit]]
            for k in np.unique(met):
                seen = np.bincount(pixel[hit][met == k], minlength=index.size)
                image = counts[kind].setdefault(int(k), np.zeros(pixels))
                image[tile.first : tile.last] += seen
    shape = (camera.height, camera.width)
    return {
        kind: [(owners[kind][1][k], (image / samples).reshape(shape)) for k, image in sorted(found.items())]
        for kind, found in counts.items()
    }
