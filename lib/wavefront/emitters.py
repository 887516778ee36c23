# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: light that rays meet by themselves, weighed against light sampling.

It comes from lights along the way, emissive faces and the sky.
"""

from __future__ import annotations

import numpy as np

from ..effects.names import Effect
from ..film.light_passes import LightPass
from ..lights.light import Meetable
from ..sampling.mis import cutoff_power_heuristic
from ..scattering.free_path import attenuated_length
from ..surfaces.surface import SurfacePoints
from ..vectors import dot, gather
from .casters import PartCaster
from .kernel import Kernel
from .light_choice import LightSampling
from .media import AIR, Media
from .pass_sums import Index
from .paths import Paths
from .raycaster import Hits, Raycaster
from .sums import PixelSums
from .visibility import transmittance


class Emitters:
    """Collects emission along rays into pixel sums."""

    def __init__(self, kernel: Kernel, sampling: LightSampling, sums: PixelSums) -> None:
        self._kernel, self._sampling, self._sums = kernel, sampling, sums
        self._asks_world = kernel.plan.needs(Effect.ENVIRONMENT_WORLD)

    def _weight(self, pdf: np.ndarray, light: int, light_pdf: np.ndarray, cell: np.ndarray | None) -> np.ndarray:
        """The heuristic's weight for directions of density `pdf`.

        Light sampling finds them with the density P(light) light_pdf, the chance being that of the cell (n,) where the path scattered.
        """
        if self._kernel.sight.alone[light]:
            return np.where(np.isinf(pdf), 1.0, 0.0)
        if self._sampling.weighs:
            return cutoff_power_heuristic(pdf, self._kernel.selection.probability(light, cell) * light_pdf)
        if not self._sampling.runs or self._sampling.by_lobes:
            return np.ones_like(pdf)
        return np.where(np.isinf(pdf), 1.0, 0.0)  # only deltas and the camera see what light sampling covers

    def lights_met(self, paths: Paths, hits: Hits) -> None:
        """Light objects in front of the nearest face; they are transparent, so all of them count."""
        kernel = self._kernel
        # A ray that passed transparent faces is still the ray that left the last scattering.
        origin, end, travelled = paths.origin, hits.distance, paths.travelled
        if paths.scatter_origin is not None and travelled is not None:
            origin, end = paths.scatter_origin, hits.distance + travelled
        for k, light in kernel.meetable:
            hidden = not kernel.sight.shows[k]
            if hidden and paths.at_camera:
                continue
            near = light.candidates(origin, paths.direction)
            if paths.ray_class is not None:
                near = near[kernel.sight.sees[paths.ray_class[near], k]]
            if paths.receiver is not None:
                near = near[kernel.sight.lights[paths.receiver[near], k]]
            shadow_of = kernel.sight.shadow_of
            if shadow_of is not None and kernel.sight.hidden_apart[k]:
                near = self._mirrored(paths, light, k, kernel.sight.shadow_casters[shadow_of[k]], near)
            if near.size == 0:
                continue
            start, direction, reach = gather(origin, near), gather(paths.direction, near), end[near]
            distance, radiance = light.intersect(start, direction)
            met = distance < reach
            met |= np.isinf(reach) & np.isinf(distance) & radiance.any(axis=0)
            if travelled is not None:
                met &= distance > travelled[near]
                if hidden and paths.ray_class is None:
                    met &= np.broadcast_to(paths.scatterings, paths.pixel.shape)[near] > 0
            at = np.flatnonzero(met)
            if at.size == 0:
                continue
            index = near[at]
            density = light.pdf(gather(start, at), gather(direction, at), distance[at])
            arriving = gather(radiance, at) * gather(paths.throughput, index)
            weight = self._weight(paths.pdf[index], k, density, _at(paths.cell, index))
            if kernel.coplanar_lights is not None:
                # What light samples of it bring is taken away here as well: in the mean, nothing is left.
                place = gather(start, at) + gather(direction, at) * distance[at]
                weight = weight - kernel.coplanar_lights.hides(k, place, distance[at])
            arriving *= weight
            if kernel.media is not None and paths.medium is not None and travelled is not None:
                # What is between the last face and here is not yet in the throughput.
                arriving *= kernel.media.transmittance(paths.medium[index], distance[at] - travelled[index])
            self._add(paths, index, arriving, LightPass.EMISSION, self._of_light(k))

    def _mirrored(
        self, paths: Paths, light: Meetable, k: int, caster: Raycaster | PartCaster, near: np.ndarray
    ) -> np.ndarray:
        """Add what rays of Dirac lobes see of light `k`, hidden by its blockers only.

        Of the rays at `near`, only those from the camera count.
        """
        kernel, transparent = self._kernel, paths.scatter_origin is not None
        scattered = np.broadcast_to(np.greater(paths.scatterings, 0), paths.pixel.shape)[near]
        sent = near[scattered & np.isinf(paths.pdf[near])]
        if paths.travelled is not None:  # a ray that passed a face has been asked before
            sent = sent[paths.travelled[sent] == 0.0]
        origin, direction = gather(paths.origin, sent), gather(paths.direction, sent)
        distance, radiance = light.intersect(origin, direction)
        met = np.flatnonzero(radiance.any(axis=0))
        rays = gather(origin, met), gather(direction, met), distance[met]
        tally = None if paths.depths is None else paths.tally(np.zeros(paths.size))[:, sent[met]]
        through, unknown = transmittance(kernel, transparent, *rays, caster=caster, tally=tally)
        index = sent[met]
        self._sums.add_unknown(paths.pixel[index[unknown]])
        arriving = gather(radiance, met) * gather(paths.throughput, index) * through
        self._add(paths, index, arriving, LightPass.EMISSION, self._of_light(k))
        return near[~scattered]

    def sky(self, paths: Paths, escaped: np.ndarray) -> None:
        """The world, for the rays at `escaped` that left the scene."""
        kernel = self._kernel
        if paths.ray_class is not None:
            escaped = escaped[kernel.sight.sees_world[paths.ray_class[escaped]]]
        if escaped.size == 0 or (kernel.sky is None and not self._asks_world):
            return
        throughput = gather(paths.throughput, escaped)
        emitter = -1 if self._sums.emitters is None else kernel.emitters.world
        if kernel.media is not None and paths.medium is not None:
            throughput *= kernel.media.transmittance(paths.medium[escaped], np.full(escaped.size, np.inf))
        if kernel.sky is not None:  # no light sampling competes for a constant sky
            self._add(paths, escaped, throughput * kernel.sky, LightPass.ENVIRONMENT, emitter)
            return
        direction = gather(paths.direction, escaped)
        throughput *= kernel.world(direction, kernel.sight.flags_of(paths, escaped))
        if kernel.environment is not None:
            density = kernel.environment.pdf(direction, direction, np.full(escaped.size, np.inf))
            throughput *= self._weight(
                paths.pdf[escaped], kernel.lights.index(kernel.environment), density, _at(paths.cell, escaped)
            )
        self._add(paths, escaped, throughput, LightPass.ENVIRONMENT, emitter)

    def volumes(self, media: Media, medium: np.ndarray, paths: Paths, hits: Hits) -> None:
        """Light that volumes emit on the way to the nearest face; the paths are in `medium` (n,)."""
        if not media.emission.any():
            return
        medium = np.where(hits.triangle < 0, AIR, medium)
        glow = np.take(media.emission, medium, axis=1)
        index = np.flatnonzero(glow.any(axis=0))
        extinction, glow = np.take(media.extinction, medium[index], axis=1), glow[:, index]
        length = attenuated_length(extinction, hits.distance[index])
        arriving = gather(paths.throughput, index) * glow * np.where(glow > 0.0, length, 0.0)
        self._add(paths, index, arriving, LightPass.EMISSION, -1)  # kernel.emitters refuses to tell emitters apart

    def faces(
        self, paths: Paths, points: SurfacePoints, distance: np.ndarray, start: int, stop: int, material: int
    ) -> None:
        """Add the light of emissive faces of one material.

        `points` are the hits from `start` to `stop` of `paths`.
        """
        kernel = self._kernel
        arriving = paths.throughput[:, start:stop] * kernel.materials[material].emission(points)
        if paths.receiver is not None:
            arriving *= kernel.sight.faces_lit(paths.receiver[start:stop], points.triangle)
        pdf, cell = paths.pdf[start:stop], _at(paths.cell, slice(start, stop))
        if kernel.emissive and not np.all(np.isinf(pdf)):
            reach = distance if paths.travelled is None else distance + paths.travelled[start:stop]
            facing = np.abs(dot(points.ng, points.wo))
            for sampler in kernel.emissive:  # each has a density for its own faces, and none for the others
                density = sampler.pdf_of_hit(points.triangle, reach, facing, cell, (points.u, points.v))
                arriving *= self._weight(pdf, kernel.lights.index(sampler), density, cell)
        emitter = -1
        if self._sums.emitters is not None:
            emitter = kernel.emitters.of_objects[kernel.scene.mesh.object_index[points.triangle]]
        self._add(paths, slice(start, stop), arriving, LightPass.EMISSION, emitter)

    def _of_light(self, k: int) -> int:
        """The emitter of light number k, where emitters are told apart."""
        return -1 if self._sums.emitters is None else int(self._kernel.emitters.of_lights[k])

    def _add(
        self, paths: Paths, index: Index, arriving: np.ndarray, seen: LightPass, emitter: np.ndarray | int
    ) -> None:
        """Add light (3, n) that arrives from `emitter`, () or (n,), along the paths at `index`.

        Light that comes straight to the camera belongs to the pass `seen`.
        """
        sums = self._sums
        sums.add(paths.pixel[index], arriving)
        if sums.passes is not None:
            sums.passes.add_emission(paths, index, arriving, seen)
        if sums.bounces is not None:
            sums.bounces.add(paths, index, arriving, 0)
        if sums.emitters is not None:
            sums.emitters.add(paths.pixel[index], arriving, emitter)


def _at(cell: np.ndarray | None, index: Index) -> np.ndarray | None:
    """The cells at `index`, where there are any."""
    return None if cell is None else cell[index]
