# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop of light tracing.

Choose an emitter, emit a ray, trace it, connect it to the camera and scatter it, until no path is left.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..effects.transport import ROULETTE_AFTER
from ..sampling.sobol import RandomTile, SobolTile
from ..sampling.streams import (
    ADJOINT_BSDF,
    ADJOINT_CHOICES,
    ADJOINT_FATE,
    ADJOINT_LENS,
    EMITTER,
    HEADING,
    PLACE,
    light_step_dimension,
)
from ..scene.rays import CAMERA, has_bits
from ..surfaces.surface import SurfacePoints
from ..vectors import dot, put
from ..wavefront.flow import Flow
from ..wavefront.kernel import Kernel
from ..wavefront.visibility import transmittance
from .adjoint import light_toward, scatter, see_from
from .emitters import Emitters
from .lens import Sight, sight
from .select import Selection
from .splats import Splats

Groups = list[tuple[int, int, int]]


@dataclass
class LightPaths:
    """Light under way; all arrays over the same n paths.

    group, sample: by which uniforms are drawn, intp. origin, direction (3, n); weight (3, n), W; start (n,), its largest colour when the path
    began. scatterings, passed (n,): how often it has scattered, and passed transparent faces. history (n,): what a selection
    remembers of it. brightness (n,): of the emitter, as in `Emitted`.
    """

    group: np.ndarray
    sample: np.ndarray
    origin: np.ndarray
    direction: np.ndarray
    weight: np.ndarray
    start: np.ndarray
    scatterings: np.ndarray
    passed: np.ndarray
    history: np.ndarray
    brightness: np.ndarray

    @property
    def size(self) -> int:
        """Number of paths."""
        return self.group.shape[0]

    def take(self, index: np.ndarray) -> LightPaths:
        """The paths at `index`, as copies."""
        return LightPaths(**{k: np.take(a, index, axis=-1) for k, a in vars(self).items()})

    @staticmethod
    def joined(parts: list[LightPaths]) -> LightPaths:
        """All the paths, one part after the other."""
        return LightPaths(**{k: np.concatenate([vars(p)[k] for p in parts], axis=-1) for k in vars(parts[0])})


class LightTracer:
    """Traces paths from the lights.

    The mean radiance of a pixel is the sum of its contributions over the number of paths.

    Counts bounces as path tracing does: a path scatters at most max_bounces + 1 times, the connection's vertex
    included. A `selection` says which of the light counts.
    """

    def __init__(
        self,
        kernel: Kernel,
        emitters: Emitters,
        uniforms: SobolTile | RandomTile,
        selection: Selection,
    ) -> None:
        self._kernel, self._emitters, self._uniforms, self._selection = kernel, emitters, uniforms, selection
        self._flow = Flow.of(kernel)
        self._hidden = np.array([not has_bits(thing.rays, CAMERA) for thing in kernel.scene.mesh.objects] or [False])
        self.rays = 0

    def trace(self, group: np.ndarray, sample: np.ndarray) -> Splats:
        """Follow one path for each (group, sample)."""
        paths = self._emit(group, sample)
        splats, step = [Splats.none()], 0
        while paths.size:
            paths, points, offset, groups = self._meet(paths)
            splats.append(self._connect(paths, points, offset, groups, step))
            paths = self._go_on(paths, points, offset, groups, step)
            paths = self._end_weak(paths, step)
            step += 1
        return Splats.joined(splats)

    def _pair(self, dimension: int, paths: LightPaths) -> tuple[np.ndarray, np.ndarray]:
        return self._uniforms.pair(dimension, paths.group, paths.sample)

    def _emit(self, group: np.ndarray, sample: np.ndarray) -> LightPaths:
        choice, place, heading = (self._uniforms.pair(k, group, sample) for k in (EMITTER, PLACE, HEADING))
        ray = self._emitters.emit(choice[0], place, heading)
        count = np.zeros(group.size, np.intp)
        start = np.abs(ray.weight).max(axis=0)
        paths = LightPaths(
            group, sample, ray.origin, ray.direction, ray.weight, start, count, count, count, ray.brightness
        )
        counts = (start != 0.0) & self._selection.starts(ray.origin, ray.direction)
        return paths.take(np.flatnonzero(counts))

    def _meet(self, paths: LightPaths) -> tuple[LightPaths, SurfacePoints, np.ndarray, Groups]:
        """Return the paths that meet a face, sorted by material.

        Also returns the points as seen from the light, the offsets and the groups.
        """
        hits = self._kernel.caster.closest(paths.origin, paths.direction)
        self.rays += paths.size
        material = np.take(self._kernel.material_of, hits.triangle)  # of a miss, the last entry: -1
        order = np.argsort(material, kind="stable")
        edges = np.searchsorted(np.take(material, order), np.arange(len(self._kernel.materials) + 1)).tolist()
        groups = [(k, a - edges[0], b - edges[0]) for k, (a, b) in enumerate(pairwise(edges)) if b > a]
        order = order[edges[0] :]
        paths = paths.take(order)
        triangle, u, v = (np.take(x, order) for x in (hits.triangle, hits.u, hits.v))
        place = paths.origin + paths.direction * np.take(hits.distance, order)
        placed, ng, offset = self._kernel.caster.on_plane(triangle, place)
        points = SurfacePoints(
            self._kernel.tables, triangle, u.astype(np.float64), v.astype(np.float64), placed, ng, -paths.direction
        )
        return paths, points, offset, groups

    def _connect(
        self, paths: LightPaths, points: SurfacePoints, offset: np.ndarray, groups: Groups, step: int
    ) -> Splats:
        """What the points send straight to the camera."""
        lens = self._pair(light_step_dimension(step, ADJOINT_LENS), paths) if self._flow.has_lens else None
        seen = sight(self._kernel.scene.camera, points.position, lens)
        value = self._sent(paths, points, groups, seen)
        value *= np.take(paths.weight, seen.index, axis=1) * seen.importance
        lit = np.flatnonzero(value.any(axis=0))
        if lit.size == 0:
            return Splats.none()
        at, direction = seen.index[lit], np.take(seen.direction, lit, axis=1)
        ng = np.take(points.ng, at, axis=1)
        origin = np.take(points.position, at, axis=1) + ng * np.copysign(offset[at], dot(ng, direction))
        arriving = value[:, lit] * self._visible(origin, direction, seen.reach[lit])
        arrived = np.flatnonzero(arriving.any(axis=0))
        at = at[arrived]
        return Splats(seen.pixel[lit[arrived]], arriving[:, arrived], paths.brightness[at], paths.group[at])

    def _sent(self, paths: LightPaths, points: SurfacePoints, groups: Groups, seen: Sight) -> np.ndarray:
        """Return `light_toward` the camera for the points in sight, (3, k).

        It is 0 where the camera does not see the object.
        """
        shown = ~self._hidden[self._kernel.scene.mesh.object_index[points.triangle[seen.index]]]
        value = np.zeros((3, seen.index.size))
        for material, start, stop in groups:
            prepared = self._kernel.materials[material]
            here = np.flatnonzero((seen.index >= start) & (seen.index < stop) & shown)
            if not prepared.scatters or here.size == 0:
                continue
            at = seen.index[here]
            counted = self._selection.connected(prepared, points.at(at), paths.history[at])
            if counted is not None:
                some = np.flatnonzero(counted.any(axis=0))
                here, at, counted = here[some], at[some], counted[:, some]
            put(value, here, light_toward(prepared, points.at(at), np.take(seen.direction, here, axis=1), counted))
        return value

    def _visible(self, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """What part of the light arrives at the camera, (1, n) or (3, n)."""
        if not (self._flow.second_hits or self._flow.asks_visibility):
            return np.ones((1, reach.size))
        self.rays += reach.size
        return transmittance(self._kernel, self._flow.transparent, origin, direction, reach, to_camera=True)[0]

    def _go_on(
        self, paths: LightPaths, points: SurfacePoints, offset: np.ndarray, groups: Groups, step: int
    ) -> LightPaths:
        """The paths that pass the faces or are scattered, on their way."""
        pick, _ = self._pair(light_step_dimension(step, ADJOINT_CHOICES), paths)
        heading = self._pair(light_step_dimension(step, ADJOINT_BSDF), paths)
        fate, _ = self._pair(light_step_dimension(step, ADJOINT_FATE), paths)
        parts = [paths.take(np.empty(0, np.intp))]
        for material, start, stop in groups:
            index = np.arange(start, stop)
            if self._kernel.materials[material].transparent:
                passes, part = self._pass(paths, points, offset, material, index, fate)
                parts.append(part)
                index = index[~passes]
            index = index[paths.scatterings[index] < self._flow.most_bounces]
            if self._kernel.materials[material].scatters and index.size:
                uniforms = pick[index], heading[0][index], heading[1][index]
                parts.append(self._scatter(paths.take(index), points.at(index), offset[index], material, uniforms))
        return LightPaths.joined(parts)

    def _pass(
        self,
        paths: LightPaths,
        points: SurfacePoints,
        offset: np.ndarray,
        material: int,
        index: np.ndarray,
        fate: np.ndarray,
    ) -> tuple[np.ndarray, LightPaths]:
        """Return which of the paths at `index` pass straight on (k,), and those paths.

        `fate` decides. Those that pass are on the far side; the others weigh more.

        Faces are passed as a camera path would see them, at most max(transparent_max_bounces, 1) of them.
        """
        prepared = self._kernel.materials[material]
        seen = see_from(points.at(index), np.take(paths.direction, index, axis=1))
        factor = np.broadcast_to(prepared.transparency(seen), (3, index.size))
        through = np.abs(factor).mean(axis=0)
        total = through + prepared.scattered_share(seen)
        chance = np.divide(through, total, out=np.zeros(index.size), where=total > 0.0)
        passes = fate[index] < chance
        paths.weight[:, index[~passes]] /= 1.0 - chance[~passes]
        most = max(self._kernel.scene.transport.transparent_max_bounces, 1)
        going = np.flatnonzero(passes & (paths.passed[index] < most))
        part = paths.take(index[going])
        part.weight *= factor[:, going] / chance[going]
        part.origin = seen.position[:, going] + seen.ng[:, going] * offset[index[going]]
        part.passed += 1
        return passes, part

    def _scatter(
        self,
        paths: LightPaths,
        points: SurfacePoints,
        offset: np.ndarray,
        material: int,
        uniforms: tuple[np.ndarray, np.ndarray, np.ndarray],
    ) -> LightPaths:
        prepared = self._kernel.materials[material]
        allowed = self._selection.allowed(prepared, points, paths.history)
        if allowed is not None:
            some = np.flatnonzero(allowed.any(axis=0))
            paths, points, offset, allowed = paths.take(some), points.at(some), offset[some], allowed[:, some]
            uniforms = uniforms[0][some], uniforms[1][some], uniforms[2][some]
        onward = scatter(prepared, points, uniforms, allowed)
        paths.weight = paths.weight * onward.weight
        paths.history = self._selection.remember(prepared, points, paths.history, onward.lobe)
        paths.direction = onward.direction
        paths.origin = points.position + points.ng * np.copysign(offset, dot(points.ng, onward.direction))
        paths.scatterings = paths.scatterings + 1
        return paths.take(np.flatnonzero(paths.weight.any(axis=0)))

    def _end_weak(self, paths: LightPaths, step: int) -> LightPaths:
        """Russian roulette by what is left of a path's light, as path tracing has it."""
        if not self._flow.roulette or step < ROULETTE_AFTER or paths.size == 0:
            return paths
        _, fate = self._pair(light_step_dimension(step, ADJOINT_CHOICES), paths)
        left = np.sqrt(np.abs(paths.weight).max(axis=0) / paths.start)
        index = np.flatnonzero(~(fate >= left))  # what is not finite goes on, to be counted
        survivors = paths.take(index)
        survivors.weight /= np.minimum(left[index], 1.0)
        return survivors
