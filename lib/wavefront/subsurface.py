# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: subsurface scattering.

At each hit a path scatters on the surface, or walks below it to where it leaves the object.
With Christensen and Burley's method it leaves by a disk, without a walk (disks.py).
Where it leaves, light is sampled and scattered as by a white diffuse surface, whatever material the face has:
Cycles' model. Walk and exit together are one scattering of the path.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..sampling.sobol import RandomTile, SobolTile
from ..sampling.streams import ENTER, ENTRY, WALK_KEY, walk_dimension
from ..scattering.subsurface import Medium
from ..scattering.walk import Exits, Walks, walk
from ..surfaces.subsurface import DiskEntry, WalkEntry, sample_entry
from ..surfaces.surface import SurfacePoints
from ..vectors import orthonormal_basis, to_local
from .disks import Disks, leave_by_disk
from .kernel import Kernel
from .pass_through import Groups
from .paths import Paths

SHORT_WALKS = "short subsurface walks"
"""The departure that ends walks after MOST_PATHS free paths."""
MOST_PATHS = 256


@dataclass(frozen=True)
class Below:
    """What becomes of the paths of one step.

    `index` (k,) of those that scatter on the surface, their `groups`, and `share` (n,) of all paths that do. `paths`, `points`, `offset`
    and `exit_groups` of those that left again, already weighed. `rays` that the walks traced.
    """

    index: np.ndarray
    groups: Groups
    share: np.ndarray
    paths: Paths
    points: SurfacePoints
    offset: np.ndarray
    exit_groups: Groups
    rays: int


def walk_below(
    kernel: Kernel,
    uniforms: SobolTile | RandomTile,
    paths: Paths,
    points: SurfacePoints,
    groups: Groups,
    step: int,
) -> Below | None:
    """Choose which paths enter, and follow these until they leave.

    The chance follows from what comes out. None where no path can enter.
    """
    if not any(kernel.materials[material].enters for material, _, _ in groups):
        return None

    def pair(decision: int) -> tuple[np.ndarray, np.ndarray]:
        return uniforms.pair(walk_dimension(step, decision), paths.pixel, paths.sample)

    entered = np.zeros(paths.size, bool)
    share, parts, disks = np.ones(paths.size), [], []
    pick, _ = pair(ENTER)
    turn = pair(ENTRY)
    for material, a, b in groups:
        if kernel.materials[material].enters:
            here = points.part(a, b)
            uses = tuple(u[a:b] for u in (pick, *turn))
            entered[a:b], share[a:b], started, near = _enter(kernel, material, here, paths.throughput[:, a:b], *uses)
            parts += [_from(one, a) for one in started]
            disks += [replace(one, index=one.index + a) for one in near]
    first, second = pair(WALK_KEY)
    found, rays = [leave_by_disk(kernel.disks, points, one, first, *turn) for one in disks], 0
    if parts:
        keys = (first * 2.0**32).astype(np.uint64) | (second * 2.0**32).astype(np.uint64) << np.uint64(32)
        walked, rays = _follow(kernel, points, _joined(parts, points), keys)
        found.append(walked)
    exits = Exits(*(np.concatenate([vars(one)[name] for one in found], axis=-1) for name in vars(found[0])))
    rays += sum(one.index.size for one in disks)
    index = np.flatnonzero(~entered)
    counts = [(material, int(np.count_nonzero(~entered[a:b]))) for material, a, b in groups]
    stops = np.cumsum([n for _, n in counts])
    kept = [(material, int(stop - n), int(stop)) for (material, n), stop in zip(counts, stops, strict=True) if n]
    return Below(index, kept, share, *_leave(kernel, paths, exits), rays)


_Started = tuple[np.ndarray, np.ndarray, np.ndarray, Medium]
"""Index of the points, directions into the body, throughput, medium."""


def _enter(
    kernel: Kernel,
    material: int,
    points: SurfacePoints,
    throughput: np.ndarray,
    pick: np.ndarray,
    u1: np.ndarray,
    u2: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, list[_Started], list[Disks]]:
    """Which points of one material light enters, (n,) bool.

    Also the chance that it does not, (n,), the walks that begin, and what leaves by disks.
    """
    prepared = kernel.materials[material]
    frame = (*orthonormal_basis(points.n), points.n)
    entries, reflected, site = prepared.entries(points, to_local(points.wo, *frame), *frame)
    guesses = [entry.guess for entry in entries]
    total = np.sum(guesses, axis=0) + reflected
    total = np.where(total > 0.0, total, 1.0)
    chances = [guess / total for guess in guesses]
    begin, entered = np.zeros(points.size), np.zeros(points.size, bool)
    started, disks = [], []
    for entry, chance in zip(entries, chances, strict=True):
        index = np.flatnonzero((pick >= begin) & (pick < begin + chance))
        begin = begin + chance
        entered[index] = True
        carried = np.take(throughput, index, axis=1) / chance[index]
        if isinstance(entry, DiskEntry):
            weight, spread = (np.take(one, index, axis=1) for one in (entry.weight, entry.spread))
            disks.append(Disks(index, spread, carried * weight))
        else:
            direction = sample_entry(entry, index, site, u1[index], u2[index])
            started.append(_start(entry, index, direction, carried))
    return entered, np.where(reflected > 0.0, reflected / total, 1.0), started, disks


def _start(entry: WalkEntry, index: np.ndarray, direction: np.ndarray, throughput: np.ndarray) -> _Started:
    """The walks of one closure that lead below the face and carry anything."""
    medium = entry.medium.at(index)
    throughput = throughput * np.take(entry.weight, index, axis=1) * medium.scale
    going = np.flatnonzero(direction.any(axis=0) & throughput.any(axis=0))
    return (
        index[going],
        np.take(direction, going, axis=1),
        np.take(throughput, going, axis=1),
        medium.at(going),
    )


def _from(started: _Started, first: int) -> _Started:
    """The same with points counted from `first` on."""
    return (started[0] + first, *started[1:])


def _joined(parts: list[_Started], points: SurfacePoints) -> Walks:
    index = np.concatenate([part[0] for part in parts])
    direction, throughput = (np.concatenate([part[k] for part in parts], axis=1) for k in (1, 2))
    media = [vars(part[3]) for part in parts]
    medium = Medium(*(np.concatenate([one[name] for one in media], axis=-1) for name in media[0]))
    return Walks(index, np.take(points.position, index, axis=1), direction, throughput, medium)


def _follow(kernel: Kernel, points: SurfacePoints, walks: Walks, keys: np.ndarray) -> tuple[Exits, int]:
    """The walks inside their objects to their ends, and the number of rays."""
    most = MOST_PATHS if SHORT_WALKS in kernel.options.departures else None
    bodies, triangle = kernel.bodies, points.triangle
    ng = np.take(points.ng, walks.index, axis=1)
    inside = replace(walks, origin=bodies.below(triangle[walks.index], walks.origin, ng))

    def closest(
        index: np.ndarray, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        return bodies.closest(triangle[index], origin, direction, reach)

    def is_far(index: np.ndarray, position: np.ndarray) -> np.ndarray:
        return bodies.is_far(triangle[index], position)

    return walk(closest, is_far, inside, keys[walks.index], most)


def _leave(kernel: Kernel, paths: Paths, exits: Exits) -> tuple[Paths, SurfacePoints, np.ndarray, Groups]:
    """Paths at the faces where they leave, sorted by what these do to them."""
    triangle, u, v = exits.triangle, exits.u, exits.v
    exit_of = np.take(kernel.exit_of, np.take(kernel.material_of, triangle))
    order = np.argsort(exit_of, kind="stable")
    leaving = paths.take(exits.index[order])
    leaving.throughput = np.take(exits.throughput, order, axis=1)
    direction = np.take(exits.direction, order, axis=1)
    placed, ng, offset = kernel.caster.on_plane(triangle[order], np.take(exits.position, order, axis=1))
    # The viewer is where the walk leads to, so that normals point out of the body.
    points = SurfacePoints(
        kernel.tables, triangle[order], u[order].astype(np.float64), v[order].astype(np.float64), placed, ng, direction
    )
    materials, starts, counts = np.unique(exit_of[order], return_index=True, return_counts=True)
    groups = [(int(m), int(a), int(a + n)) for m, a, n in zip(materials, starts, counts, strict=True)]
    return leaving, points, offset, groups
