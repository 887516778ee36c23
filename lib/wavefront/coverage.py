# SPDX-License-Identifier: GPL-3.0-or-later
"""What camera rays meet first in each pixel.

The share of each pixel that shows each material, each of its angles, and each object.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from scipy import sparse

from ..effects.names import Effect
from ..sampling.sobol import SobolSampler
from ..sampling.streams import COVERAGE, LENS, PIXEL
from ..surfaces.surface import SurfacePoints
from .camera_rays import CameraRays, camera_rays
from .kernel import Kernel
from .raycaster import Hits
from .render import Tile, tiles

TILE_PATHS = 16384
# Angles between the shading normal and the viewer, in degrees, at which bands of a material end: microfacet models part at grazing.
BANDS = (30.0, 60.0, 80.0, 90.0)
# What shows in fewer pixels than this makes no region of its own; blocks still hold it.
LEAST_PIXELS = 64.0
# A band has so many times as many at least, half a block's: with fewer its own noise would decide the bound of the whole image.
BAND_FACTOR = 2.0

Coverage = dict[str, list[tuple[str, sparse.csr_array]]]


def coverage(kernel: Kernel, samples: int = 16, least: float = LEAST_PIXELS) -> Coverage:
    """The shares of each pixel that show each material, band of angles and object.

    Returns kind ('material', 'facing', 'object') -> (name, share of each pixel as a sparse (height, width) array).
    'facing' splits each material into bands of the angle between shading normal and viewer; narrow ones are joined. What covers
    fewer than `least` pixels in all is left out.
    """
    camera, mesh = kernel.scene.camera, kernel.scene.mesh
    sampler = SobolSampler(kernel.options.seed, COVERAGE.number(0), samples)
    materials = [material.name or "(no material)" for material in kernel.scene.materials]
    edges = np.cos(np.radians(BANDS[:-1]))

    def count(tile: Tile) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        pixel, points = _first_points(kernel, tile, sampler)
        material = np.take(mesh.material_index, points.triangle)
        band = (points.cos_wo[:, None] < edges).sum(axis=1)
        owners = material, material * len(BANDS) + band, np.take(mesh.object_index, points.triangle)
        return _counted(owners[0], pixel), _counted(owners[1], pixel), _counted(owners[2], pixel)

    with ThreadPoolExecutor(kernel.options.threads) as pool:
        found = zip(*pool.map(count, tiles(camera.width * camera.height, samples, TILE_PATHS)), strict=True)
    counted = dict(zip(("material", "facing", "object"), (np.concatenate(rows, axis=1) for rows in found), strict=True))
    counted["facing"], bands = _in_wide_bands(counted["facing"], materials, BAND_FACTOR * least * samples)
    names = {"material": materials, "facing": bands, "object": [item.name for item in mesh.objects]}
    shape = (camera.height, camera.width)
    return {kind: _regions(counted[kind], names[kind], shape, samples, least) for kind in counted}


def join_bands(sizes: np.ndarray, least: float) -> list[tuple[int, int]]:
    """Join bands of angles, from grazing angles on, until each has the size `least`.

    `sizes` are those of the bands of one material, in the order of BANDS. Returns the first and the last band of each that is
    made. What remains at small angles joins the one before. Bands that would all be joined to one make none: it would
    be the material. The sizes alone decide, and no light.
    """
    seen = np.flatnonzero(sizes > 0)
    joined: list[tuple[int, int]] = []
    total, last = 0.0, -1
    for band in seen[::-1].tolist():
        last = band if total == 0 else last
        total += sizes[band]
        if total >= least:
            joined.append((band, last))
            total = 0.0
    if total and joined:
        joined[-1] = int(seen[0]), joined[-1][1]
    return joined if len(joined) > 1 or seen.size == 1 else []


def _in_wide_bands(counted: np.ndarray, materials: list[str], least: float) -> tuple[np.ndarray, list[str]]:
    """The `counted` bands of materials, joined where they count fewer than `least`, and their names."""
    owner, pixel, count = counted
    sizes = np.bincount(owner, count, len(materials) * len(BANDS)).reshape(len(materials), len(BANDS))
    becomes, names = np.full(sizes.shape, -1), []
    for k, material in enumerate(materials):
        for first, last in join_bands(sizes[k], least):
            becomes[k, first : last + 1] = len(names)
            names.append(f"{material}, {(0.0, *BANDS)[first]:g} to {BANDS[last]:g} degrees")
    owner = becomes.ravel()[owner]
    return np.stack([owner, pixel, count])[:, owner >= 0], names


def caught_pixels(kernel: Kernel, samples: int = 16) -> np.ndarray:
    """The pixels (height, width) that show shadow catchers: more than half of their camera rays meet these first.

    What little such pixels show of other things would be noisy. There are none where volumes scatter or emit light, which
    is seen in front of the catchers.
    """
    camera = kernel.scene.camera
    count = np.zeros(camera.width * camera.height, np.int64)
    clear = kernel.media is None or not (kernel.media.emits or kernel.plan.needs(Effect.VOLUME_SCATTERING))
    if kernel.catchers is not None and clear:
        sampler = SobolSampler(kernel.options.seed, COVERAGE.number(0), samples)
        for tile in tiles(count.size, samples, TILE_PATHS):
            pixel, _, hits = _first_hits(kernel, tile, sampler)
            count += np.bincount(pixel[np.take(kernel.catchers, hits.triangle)], minlength=count.size)
    return (2 * count > samples).reshape(camera.height, camera.width)


def bare_pixels(kernel: Kernel, samples: int = 4) -> np.ndarray:
    """The pixels (height, width) in which no camera ray meets a face: they show the world alone.

    There are none where there are volumes, objects that move while the shutter is open, or lamps that camera rays can meet: a
    small one is met as seldom as a caustic.
    """
    camera = kernel.scene.camera
    met = np.zeros(camera.width * camera.height, bool)
    shows_lamps = any(kernel.sight.shows[k] for k, _ in kernel.meetable)
    if kernel.media is not None or shows_lamps or kernel.plan.needs(Effect.MOTION_BLUR):
        return met.reshape(camera.height, camera.width)
    sampler = SobolSampler(kernel.options.seed, COVERAGE.number(0), samples)
    for tile in tiles(met.size, samples, TILE_PATHS):
        pixel, _, hits = _first_hits(kernel, tile, sampler)
        met[pixel[hits.triangle >= 0]] = True
    return ~met.reshape(camera.height, camera.width)


def _first_hits(kernel: Kernel, tile: Tile, sampler: SobolSampler) -> tuple[np.ndarray, CameraRays, Hits]:
    """The camera rays of a tile, the pixels (n,) that they belong to, and what they meet first."""
    camera = kernel.scene.camera
    index, samples = np.arange(tile.first, tile.last), np.arange(tile.start, tile.stop)
    row, column = np.divmod(index, camera.width)
    pixel, sample = np.repeat(np.arange(index.size), samples.size), np.tile(samples, index.size)
    view = sampler.tile(index)
    dx, dy = view.pair(PIXEL, pixel, sample)
    lens = view.pair(LENS, pixel, sample) if kernel.plan.needs(Effect.DEPTH_OF_FIELD) else None
    rays = camera_rays(camera, column[pixel] + dx, camera.height - 1.0 - row[pixel] + dy, lens)
    if rays.index is not None:
        pixel = pixel[rays.index]
    return index[pixel], rays, kernel.sight.camera.closest(rays.origin, rays.direction, rays.reach)


def _first_points(kernel: Kernel, tile: Tile, sampler: SobolSampler) -> tuple[np.ndarray, SurfacePoints]:
    """Pixels (n,) of the camera rays that meet a face, and the points they meet; shadow catchers do not count."""
    pixel, rays, hits = _first_hits(kernel, tile, sampler)
    is_met = hits.triangle >= 0
    if kernel.catchers is not None:
        is_met &= ~np.take(kernel.catchers, hits.triangle)
    met = np.flatnonzero(is_met)
    direction = np.take(rays.direction, met, axis=1)
    place = np.take(rays.origin, met, axis=1) + direction * hits.distance[met]
    placed, ng, _ = kernel.caster.on_plane(hits.triangle[met], place)
    u, v = (x[met].astype(np.float64) for x in (hits.u, hits.v))
    return pixel[met], SurfacePoints(kernel.tables, hits.triangle[met], u, v, placed, ng, -direction)


def _counted(owner: np.ndarray, pixel: np.ndarray) -> np.ndarray:
    """Distinct (owner, pixel) pairs and how often each occurs, (3, k)."""
    span = int(pixel.max(initial=0)) + 1
    keys, counts = np.unique(owner * np.int64(span) + pixel, return_counts=True)
    return np.stack([*np.divmod(keys, span), counts])


def _regions(
    counted: np.ndarray, names: list[str], shape: tuple[int, int], samples: int, least: float
) -> list[tuple[str, sparse.csr_array]]:
    owner, pixel, count = counted
    if owner.size == 0:
        return []
    owners, starts = np.unique(owner[order := np.argsort(owner, kind="stable")], return_index=True)
    regions = []
    for k, part in zip(owners, np.split(order, starts[1:]), strict=True):
        if count[part].sum() >= least * samples:
            place = np.divmod(pixel[part], shape[1])
            regions.append((names[k], sparse.csr_array((count[part] / samples, place), shape=shape)))
    return regions
