# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop over the stages, until no path is left.

Camera rays come first; then intersect, collect emission, shade and trace shadow rays, again and again.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..effects.names import Stage
from ..effects.transport import ROULETTE_AFTER
from ..sampling.sobol import RandomTile, SobolTile
from ..sampling.streams import (
    BSDF,
    CHOICES,
    FATE,
    LENS,
    LIGHT,
    PIXEL,
    WAVELENGTH,
    bevel_dimension,
    occlusion_dimension,
    step_dimension,
)
from ..sampling.wavelengths import color_weight, sample_wavelength
from ..scene.rays import DEPTH_OF_KIND
from ..surfaces.surface import SurfacePoints
from ..vectors import gather
from .camera_rays import camera_rays, pixel_cone
from .catchers import end_at_catchers
from .coplanar import place_left, with_coplanar_hits, with_other_faces
from .direct_light import DirectLight
from .emitters import Emitters
from .flow import Flow
from .kernel import Kernel
from .light_choice import LightSampling, choose_light
from .origins import SurfaceOrigins
from .pass_through import Groups, split
from .paths import Paths
from .raycaster import Hits, no_hits
from .roulette import survival
from .shade import Shaded, shade_all
from .subsurface import walk_below
from .sums import PixelSums, StageClock
from .volume_stage import VolumeStage


class Tracer:
    """Traces the samples of one tile."""

    def __init__(self, kernel: Kernel, uniforms: SobolTile | RandomTile, sums: PixelSums, clock: StageClock) -> None:
        self._kernel, self._uniforms, self._sums, self._clock = kernel, uniforms, sums, clock
        self._flow, self._sampling = Flow.of(kernel), LightSampling.of(kernel)
        self._emitters = Emitters(kernel, self._sampling, sums)
        self._direct = DirectLight(kernel, self._flow, sums, clock)
        self._volumes = None
        if kernel.media is not None:
            self._volumes = VolumeStage(
                kernel, kernel.media, self._flow, self._sampling, uniforms, sums, self._emitters, self._direct
            )
        self._rays = 0

    @property
    def rays(self) -> int:
        """How many rays were traced."""
        return self._rays + self._direct.rays

    def trace(self, column: np.ndarray, row: np.ndarray, pixel: np.ndarray, sample: np.ndarray) -> None:
        """Follow one path for each (pixel, sample).

        `column` and `row` (p,) are where the tile's pixels are in the image.
        """
        paths, reach = self._from_camera(column, row, pixel, sample)
        step = 0
        while paths.size:
            hits = self._hits(paths, reach, step)
            self._emitters.lights_met(paths, hits)
            self._emitters.sky(paths, np.flatnonzero(hits.triangle < 0))
            self._clock.lap(Stage.EMISSION)
            scattered = None
            if self._volumes is not None and paths.medium is not None:
                paths, hits, scattered = self._volumes.pass_through(paths, paths.medium, hits, step)
                self._clock.lap(Stage.VOLUMES)
            if self._kernel.catchers is not None:
                paths, hits = end_at_catchers(self._kernel.catchers, paths, hits)
            paths = self._scatter(paths, hits, step)
            if scattered is not None:
                paths = Paths.joined(paths, scattered)
            reach = None
            step += 1

    def _is_last(self, step: int) -> bool:
        """Whether no path scatters at this step."""
        return step > self._flow.most_bounces and not self._flow.transparent

    def _hits(self, paths: Paths, reach: np.ndarray | None, step: int) -> Hits:
        """What the rays meet, as far as it is not known beforehand and matters."""
        kernel = self._kernel
        if step and not self._flow.second_hits:
            return no_hits(np.zeros(paths.size, bool))
        if self._is_last(step) and not self._flow.last_hits:
            hits = no_hits(self._hidden(paths))
        elif step == 0:
            hits = kernel.sight.camera.closest(paths.origin, paths.direction, reach)
        elif paths.ray_class is not None:
            hits = kernel.sight.closest(paths.ray_class, paths.origin, paths.direction)
        else:
            hits = kernel.caster.closest(paths.origin, paths.direction)
            if self._flow.hides and self._flow.transparent:
                hits = self._with_camera_hits(paths, hits)
        if step and kernel.coplanar is not None:
            hits = with_coplanar_hits(kernel.coplanar, paths, hits)
        if kernel.other_faces is not None:
            hits = with_other_faces(kernel.other_faces, paths, hits)
        self._rays += paths.size
        self._clock.lap(Stage.INTERSECT)
        return hits

    def _hidden(self, paths: Paths) -> np.ndarray:
        """Whether the rays meet anything, (n,) bool."""
        if paths.ray_class is not None:
            return self._kernel.sight.occluded(paths.ray_class, paths.origin, paths.direction)
        return self._kernel.caster.occluded(paths.origin, paths.direction, np.full(paths.size, np.inf))

    def _with_camera_hits(self, paths: Paths, hits: Hits) -> Hits:
        """The hits, with those of camera rays that passed transparent faces replaced.

        Such rays still do not meet objects that are hidden from the camera.
        """
        index = np.flatnonzero(paths.scatterings == 0)
        origin, direction = gather(paths.origin, index), gather(paths.direction, index)
        return hits.replaced(index, self._kernel.sight.camera.closest(origin, direction))

    def _pair(self, dimension: int, paths: Paths) -> tuple[np.ndarray, np.ndarray]:
        return self._uniforms.pair(dimension, paths.pixel, paths.sample)

    def _from_camera(
        self, column: np.ndarray, row: np.ndarray, pixel: np.ndarray, sample: np.ndarray
    ) -> tuple[Paths, np.ndarray]:
        camera = self._kernel.scene.camera
        dx, dy = self._uniforms.pair(PIXEL, pixel, sample)
        lens = self._uniforms.pair(LENS, pixel, sample) if self._flow.has_lens else None
        x = gather(column, pixel) + dx
        y = gather(camera.height - 1.0 - row, pixel) + dy
        rays = camera_rays(camera, x, y, lens)
        if rays.index is not None:
            pixel, sample = pixel[rays.index], sample[rays.index]
        count = pixel.shape[0]
        paths = Paths(
            pixel, sample, rays.origin, rays.direction, np.ones((3, count)), np.full(count, np.inf), at_camera=True
        )
        if self._flow.transparent:
            paths.scatter_origin, paths.travelled = rays.origin, np.zeros(count)
            paths.scatterings, paths.passed = np.zeros(count, np.int64), np.zeros(count, np.int64)
        if self._kernel.sight.class_of is not None:
            paths.ray_class = np.zeros(count, np.intp)
        if self._flow.counts:
            paths.depths = np.zeros((3, count))
        if self._flow.bevels:
            paths.least_pdf = np.full(count, np.inf)
        if self._flow.pixel_widths:
            seen = slice(None) if rays.index is None else rays.index
            paths.footprint, paths.spread = pixel_cone(camera, x[seen], y[seen])
        if self._kernel.coplanar is not None:
            paths.left, paths.left_uv = np.full(count, -1, np.int32), np.zeros((2, count))
        if self._kernel.sight.receiver_of is not None:
            paths.receiver = np.full(count, -1, np.intp)
        if self._kernel.media is not None:
            paths.medium = self._kernel.media.around(rays.origin)
            paths.in_volumes = np.zeros(count, np.int64) if self._flow.volumes_scatter else None
        if self._flow.disperses:
            paths.wavelength = sample_wavelength(self._uniforms.pair(WAVELENGTH, pixel, sample)[0])
            paths.awaits_color = np.ones(count, bool)
        if self._sampling.runs:
            paths.cell = self._kernel.selection.everywhere(count)
        self._clock.lap(Stage.CAMERA)
        return paths, rays.reach

    def _scatter(self, paths: Paths, hits: Hits, step: int) -> Paths:
        """All that happens at the hits; the paths that go on from them."""
        if self._is_last(step) and not self._flow.emission:
            return paths.take(np.empty(0, np.intp))
        order, groups = self._by_material(hits)
        if order.size == 0:
            return paths.take(order)
        paths = paths.take(order)
        triangle, distance = gather(hits.triangle, order), gather(hits.distance, order)
        placed, ng, offset = self._kernel.caster.on_plane(triangle, paths.origin + paths.direction * distance)
        u, v = (gather(x, order).astype(np.float64) for x in (hits.u, hits.v))
        points = SurfacePoints(self._kernel.tables, triangle, u, v, placed, ng, -paths.direction)
        points.flags = self._kernel.sight.flags_of(paths)
        if self._flow.counts:
            points.tally = paths.tally(distance)
        if paths.footprint is not None and paths.spread is not None:
            paths.footprint = points.footprint = paths.footprint + paths.spread * distance
        if self._flow.occludes:
            points.occluders = self._kernel.occluders.at_step(step) if self._kernel.occluders is not None else None
            points.chance = np.stack([*self._pair(occlusion_dimension(step), paths), offset])
        if paths.least_pdf is not None:
            points.bevels = self._kernel.bevels.at_step(step) if self._kernel.bevels is not None else None
            points.bevel_chance = np.stack([self._pair(bevel_dimension(step), paths)[0], paths.least_pdf])
        self._clock.lap(Stage.SURFACE)
        for material, start, stop in groups:
            if self._kernel.materials[material].unknown:
                self._count_unknown(paths, start, stop)
            elif self._kernel.materials[material].emits:
                self._emitters.faces(paths, points.part(start, stop), distance[start:stop], start, stop, material)
        self._clock.lap(Stage.EMISSION)
        return self._next(paths, points, distance, offset, groups, step)

    def _count_unknown(self, paths: Paths, start: int, stop: int) -> None:
        """Count the paths that end in an unsupported material.

        Where the kernel is passive, only those that come straight from the camera count.
        """
        pixel = paths.pixel[start:stop]
        if self._kernel.is_passive:
            pixel = pixel[np.broadcast_to(paths.scatterings, paths.pixel.shape)[start:stop] == 0]
        self._sums.add_unknown(pixel)

    def _by_material(self, hits: Hits) -> tuple[np.ndarray, Groups]:
        """Indices of the hits, sorted by material.

        Also each material's (index, start, stop) in that order.
        """
        if not self._flow.several_materials:
            order = np.flatnonzero(hits.triangle >= 0)
            return order, [(int(self._kernel.material_of[0]), 0, order.size)] if order.size else []
        material = np.take(self._kernel.material_of, hits.triangle)  # of a miss, the last entry: -1
        order = np.argsort(material, kind="stable")
        edges = np.searchsorted(gather(material, order), np.arange(len(self._kernel.materials) + 1)).tolist()
        groups = [(k, a - edges[0], b - edges[0]) for k, (a, b) in enumerate(pairwise(edges)) if b > a]
        return order[edges[0] :], groups

    def _next(
        self,
        paths: Paths,
        points: SurfacePoints,
        distance: np.ndarray,
        offset: np.ndarray,
        groups: Groups,
        step: int,
    ) -> Paths:
        """Pass through or scatter at the hits; the paths that go on."""
        if paths.passed is None:
            if self._is_last(step):
                return paths.take(np.empty(0, np.intp))
            return self._shade_or_walk(paths, points, offset, groups, step)
        uniform, _ = self._pair(step_dimension(step, FATE), paths)
        may_pass = paths.passed < max(self._kernel.scene.transport.transparent_max_bounces, 1)
        parted = split(
            self._kernel, paths, may_pass, points, distance, offset, groups, uniform, self._flow.most_bounces
        )
        self._clock.lap(Stage.PASS_THROUGH)
        if parted.index.size == 0:
            return parted.passing
        scattering = paths.take(parted.index)
        scattering.throughput /= parted.share[parted.index]
        following = self._shade_or_walk(scattering, points.at(parted.index), offset[parted.index], parted.groups, step)
        return Paths.joined(parted.passing, following)

    def _shade_or_walk(
        self, paths: Paths, points: SurfacePoints, offset: np.ndarray, groups: Groups, step: int
    ) -> Paths:
        """Scatter at the hits, or walk below them and scatter where the walks leave.

        Returns the paths that go on.
        """
        below = walk_below(self._kernel, self._uniforms, paths, points, groups, step) if self._flow.subsurface else None
        if below is None:
            return self._shade(paths, points, offset, groups, step)
        self._rays += below.rays
        self._clock.lap(Stage.SUBSURFACE)
        leaving = self._shade(below.paths, below.points, below.offset, below.exit_groups, step)
        reflecting = paths.take(below.index)
        reflecting.throughput /= below.share[below.index]
        here = points.at(below.index), offset[below.index], below.groups
        return Paths.joined(self._shade(reflecting, *here, step), leaving)

    def _shade(self, paths: Paths, points: SurfacePoints, offset: np.ndarray, groups: Groups, step: int) -> Paths:
        """Light sampling and BSDF sampling at all hits; the scattered paths."""
        kernel = self._kernel
        goes_on = self._flow.samples_lobes and (
            self._flow.last_rays or self._flow.transparent or step < self._flow.most_bounces
        )
        if not goes_on and not self._sampling.runs:
            return paths.take(np.empty(0, np.intp))
        if paths.wavelength is not None and paths.awaits_color is not None:
            points.wavelength = paths.wavelength
            self._take_color(paths.throughput, paths.wavelength, paths.awaits_color, groups)
        # A single lobe and a single light leave nothing to pick; a zero serves as well then.
        pick = choice = np.zeros(paths.size)
        if self._flow.has_choices:
            pick, choice = self._pair(step_dimension(step, CHOICES), paths)
        light = None
        if self._sampling.runs:
            position, uniforms = points.position, self._pair(step_dimension(step, LIGHT), paths)
            cell = kernel.selection.cells(position)
            light = choose_light(kernel, self._sampling.selects, position, cell, choice, *uniforms)
            light = light.within_bounces(kernel, paths.scatterings)
            if kernel.sight.receiver_of is not None:
                receiver = np.take(kernel.sight.receiver_of, points.triangle)
                light = light.where(kernel.sight.lights[receiver, light.number])
        self._clock.lap(Stage.LIGHTS)
        uniforms = (pick, *self._pair(step_dimension(step, BSDF), paths)) if goes_on else None
        passes = self._sums.passes
        parts = passes is not None and passes.parts and bool(np.any(np.equal(paths.scatterings, 0)))
        shaded = self._selected(paths, shade_all(kernel, self._sampling, points, groups, light, uniforms, parts))
        self._clock.lap(Stage.SHADE)
        origins = SurfaceOrigins(kernel, points, offset, paths.medium)
        if light is not None and shaded.direct is not None:
            self._direct.add(paths, origins, light, shaded.direct, shaded.direct_shares)
        if not goes_on:
            return paths.take(np.empty(0, np.intp))
        if passes is not None:
            passes.remember(paths, shaded.shares)
        fate = (
            self._pair(step_dimension(step, FATE), paths)[1] if self._flow.roulette and step >= ROULETTE_AFTER else None
        )
        return self._advance(paths, origins, shaded, None if light is None else light.cell, fate)

    def _selected(self, paths: Paths, shaded: Shaded) -> Shaded:
        """What counts of it: all, unless another estimator takes a part of the paths."""
        return shaded

    def _take_color(self, throughput: np.ndarray, wavelength: np.ndarray, awaits: np.ndarray, groups: Groups) -> None:
        """Give paths the colour of their wavelength at their first dispersive material.

        That is one whose index depends on the wavelength.
        """
        for material, start, stop in groups:
            if self._kernel.materials[material].disperses:
                index = start + np.flatnonzero(awaits[start:stop])
                throughput[:, index] *= color_weight(wavelength[index])
                awaits[index] = False

    def _advance(
        self, paths: Paths, origins: SurfaceOrigins, shaded: Shaded, cell: np.ndarray | None, fate: np.ndarray | None
    ) -> Paths:
        """The paths that go on along wi: their throughput is not zero and roulette spares them.

        `cell` (n,) is where their light was chosen. `fate` are the uniforms of Russian roulette.
        """
        wi, weight, pdf = shaded.onward
        throughput = weight * paths.throughput
        going = throughput.any(axis=0)
        if self._flow.transparent and not self._flow.last_rays:
            going &= paths.scatterings < self._flow.most_bounces
        if fate is not None:
            # Colours of the spectrum may be negative.
            chance = survival(np.abs(throughput) if self._flow.disperses else throughput)
            going &= ~(fate >= chance)  # what is not finite goes on, to be counted
        index = np.flatnonzero(going)
        throughput = gather(throughput, index)
        if fate is not None:
            throughput /= chance[index]
        following = Paths(
            gather(paths.pixel, index),
            gather(paths.sample, index),
            gather(origins.towards(wi), index),
            gather(wi, index),
            throughput,
            gather(pdf, index),
        )
        if paths.wavelength is not None and paths.awaits_color is not None:
            following.wavelength, following.awaits_color = paths.wavelength[index], paths.awaits_color[index]
        if self._kernel.sight.class_of is not None:
            classes = shaded.ray_class
            following.ray_class = np.ones(index.size, np.intp) if classes is None else gather(classes, index)
        if paths.depths is not None:
            following.depths = gather(paths.depths, index)
        if following.depths is not None and following.ray_class is not None:
            # Where shaders ask, classes are kinds.
            following.depths[np.take(DEPTH_OF_KIND, following.ray_class), np.arange(index.size)] += 1
        if paths.least_pdf is not None:
            following.least_pdf = np.minimum(paths.least_pdf, pdf)[index]
        if paths.footprint is not None and paths.spread is not None:
            following.footprint, following.spread = paths.footprint[index], paths.spread[index]
        if self._kernel.coplanar is not None:
            following.left, following.left_uv = place_left(origins.points, index)
        following.medium = origins.medium(index, following.direction)
        if paths.in_volumes is not None:
            following.in_volumes = paths.in_volumes[index]
        if cell is not None:
            following.cell = cell[index]
        if self._kernel.sight.receiver_of is not None:
            following.receiver = np.take(self._kernel.sight.receiver_of, origins.points.triangle[index])
        if paths.passed is not None:
            following.scatter_origin = following.origin
            following.travelled, following.passed = np.zeros(index.size), paths.passed[index]
        counts = paths.scatterings
        following.scatterings = (counts[index] if isinstance(counts, np.ndarray) else counts) + 1
        self._clock.lap(Stage.ADVANCE)
        return following
