# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: shadow rays."""

from __future__ import annotations

import numpy as np

from ..scene.rays import COUNTS
from ..surfaces.surface import SurfacePoints
from ..vectors import dot
from .casters import PartCaster
from .coplanar import CoplanarFaces, Left
from .kernel import Kernel
from .raycaster import Raycaster


def transmittance(
    kernel: Kernel,
    transparent: bool,
    origin: np.ndarray,
    direction: np.ndarray,
    reach: np.ndarray,
    to_camera: bool = False,
    caster: Raycaster | PartCaster | None = None,
    medium: np.ndarray | None = None,
    tally: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """The share of light that arrives over distance `reach`, (1, n) or (3, n).

    Also the rays (k,) that an unsupported material ends.
    Opaque scenes need one occlusion query. Where materials are `transparent` the ray goes on through them, at most
    `transparent_max_bounces` times, as in Cycles. Rays begin where light is scattered; those `to_camera` follow the
    light, meet only what the camera sees, and pass faces as the camera sees them. `caster` meets what hides the light,
    where that is not what shadow rays meet. `medium` (n,) is what the rays begin in, where there are volumes, and
    `tally` (counts, n) what they have counted, where shaders ask.
    """
    if caster is None:
        caster = kernel.sight.camera if to_camera else kernel.sight.shadow
    viewer, media = 1.0 if to_camera else -1.0, kernel.media
    unknown = np.empty(0, np.intp)
    if not transparent:
        return (~caster.occluded(origin, direction, reach))[None].astype(np.float64), unknown
    through = np.ones_like(direction)
    active = np.arange(direction.shape[1])
    start, left = origin, reach.copy()
    passes = np.full(active.size, kernel.scene.transport.transparent_max_bounces)
    while active.size:
        hits = caster.closest(start, direction[:, active], np.minimum(left, 1e30))
        if media is not None and medium is not None:
            # What is left of a way to an emissive face that is seen edge-on may be less than nothing.
            way = np.maximum(np.minimum(hits.distance, left), 0.0)
            through[:, active] *= media.transmittance(medium, way)
        met = np.flatnonzero(hits.triangle >= 0)
        if met.size == 0:
            break
        active, triangle = active[met], hits.triangle[met]
        if kernel.has_unknown and not kernel.is_passive:
            unknown = np.concatenate([unknown, active[kernel.is_unknown(triangle)]])
        along = direction[:, active]
        point = start[:, met] + along * hits.distance[met]
        placed, ng, offset = kernel.caster.on_plane(triangle, point)
        points = SurfacePoints(kernel.tables, triangle, hits.u[met], hits.v[met], placed, ng, viewer * along)
        counted = 1 if medium is None else kernel.is_counted(triangle)
        if tally is not None:
            points.tally, tally = _count(tally[:, met], hits.distance[met], counted)
        through[:, active] *= kernel.shadow_transparency(points)
        passes = passes[met] - counted
        through[:, active[passes < 0]] = 0.0
        start = placed + ng * np.copysign(offset, dot(ng, along))
        left = left[met] - hits.distance[met] - offset
        alive = np.flatnonzero(through[:, active].any(axis=0) & (left > 0.0))
        if media is not None and medium is not None:
            medium = media.crossed(medium[met], points, np.ones(met.size, bool))[alive]
        tally = None if tally is None else tally[:, alive]
        active, start, left, passes = active[alive], start[:, alive], left[alive], passes[alive]
    return through, unknown


def _count(tally: np.ndarray, way: np.ndarray, passed: int | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The counts (counts, n) of rays that meet faces after a further `way` (n,), and those beyond the faces."""
    here = tally.copy()
    here[COUNTS.index("RAY_LENGTH")] += way
    beyond = here.copy()
    beyond[COUNTS.index("TRANSPARENT_DEPTH")] += passed
    return here, beyond


def transmittance_to(
    kernel: Kernel,
    transparent: bool,
    number: np.ndarray,
    origin: np.ndarray,
    direction: np.ndarray,
    reach: np.ndarray,
    medium: np.ndarray | None = None,
    tally: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """As `transmittance`, towards the lights `number` (n,).

    Each light is hidden by the objects linked to its shadows.
    """
    sight = kernel.sight
    through, unknown = np.zeros((3 if transparent else 1, reach.size)), []
    group = np.take(sight.shadow_of, number)
    for k in np.unique(group):
        index = np.flatnonzero(group == k)
        rays = np.take(origin, index, axis=1), np.take(direction, index, axis=1), reach[index]
        start = None if medium is None else medium[index]
        counts = None if tally is None else tally[:, index]
        part, ended = transmittance(
            kernel, transparent, *rays, caster=sight.shadow_casters[k], medium=start, tally=counts
        )
        through[:, index] = part
        unknown.append(index[ended])
    return through, np.concatenate(unknown)


def coplanar_transmittance(
    kernel: Kernel,
    coplanar: CoplanarFaces,
    points: SurfacePoints,
    direction: np.ndarray,
    tally: np.ndarray | None = None,
) -> np.ndarray:
    """The light that faces in the plane of a shadow ray's origin let through, (3, n).

    `tally` (counts, n) is what the rays have counted, where shaders ask. It is part of a departure, see coplanar.py.
    """
    through = np.ones_like(direction)
    met = coplanar.met_by(Left(points.triangle, points.position, np.stack([points.u, points.v])), direction)
    if met.ray.size == 0:
        return through
    position = np.take(points.position, met.ray, axis=1)
    placed, ng, _ = kernel.caster.on_plane(met.triangle, position)
    others = SurfacePoints(kernel.tables, met.triangle, met.u, met.v, placed, ng, -np.take(direction, met.ray, axis=1))
    others.tally = None if tally is None else np.take(tally, met.ray, axis=1)
    passing = kernel.shadow_transparency(others)
    for row, factor in zip(through, passing, strict=True):
        np.multiply.at(row, met.ray, factor)
    return through
