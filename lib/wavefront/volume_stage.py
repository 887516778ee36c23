# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: volumes; paths on their way to the next face lose light, gain some, and scatter."""

from __future__ import annotations

import numpy as np

from ..effects.transport import ROULETTE_AFTER
from ..sampling.sobol import RandomTile, SobolTile
from ..sampling.streams import (
    VOLUME_CHOICES,
    VOLUME_FATE,
    VOLUME_FLIGHT,
    VOLUME_LIGHT,
    VOLUME_PHASE,
    VOLUME_PLACE,
    volume_step_dimension,
)
from .direct_light import DirectLight
from .emitters import Emitters
from .flow import Flow
from .kernel import Kernel
from .light_choice import LightSampling, choose_light
from .media import Media
from .origins import VolumeOrigins
from .paths import Paths
from .raycaster import Hits
from .roulette import survival
from .sums import PixelSums
from .volumes import Flight, Phases, Pivots, Segment, find_segments, fly, scatter_light


class VolumeStage:
    """What volumes do to the paths of one tile."""

    def __init__(
        self,
        kernel: Kernel,
        media: Media,
        flow: Flow,
        sampling: LightSampling,
        uniforms: SobolTile | RandomTile,
        sums: PixelSums,
        emitters: Emitters,
        direct: DirectLight,
    ) -> None:
        self._kernel, self._media, self._flow = kernel, media, flow
        self._sampling, self._uniforms = sampling, uniforms
        self._sums, self._emitters, self._direct = sums, emitters, direct
        self._limits = flow.most_bounces, kernel.scene.transport.volume_bounces
        self._pivots = Pivots(kernel) if sampling.runs and flow.volumes_scatter else None

    def pass_through(self, paths: Paths, medium: np.ndarray, hits: Hits, step: int) -> tuple[Paths, Hits, Paths | None]:
        """Follow the paths in `medium` (n,) to the next face.

        Returns the paths that reach it, with what is left of their light; their hits; the paths that scatter before it.
        """
        self._emitters.volumes(self._media, medium, paths, hits)
        factor = self._media.transmittance(medium, hits.distance)
        scattered = None
        if self._flow.volumes_scatter:
            segment = find_segments(self._media, paths, hits, self._limits)
            if segment.index.size:
                turbid = paths.take(segment.index)
                if self._pivots is not None:
                    self._sample_lights(self._pivots, turbid, segment, step)
                flight = fly(segment, *self._pair(step, VOLUME_FLIGHT, turbid))
                factor[:, segment.index] = flight.weight
                scattered = self._scatter(turbid, segment, flight, step)
        paths.throughput *= factor
        if scattered is None:
            return paths, hits, None
        stays = np.ones(paths.size, bool)
        stays[segment.index[flight.scatters]] = False
        index = np.flatnonzero(stays)
        return paths.take(index), hits.at(index), scattered

    def _pair(self, step: int, decision: int, paths: Paths) -> tuple[np.ndarray, np.ndarray]:
        return self._uniforms.pair(volume_step_dimension(step, decision), paths.pixel, paths.sample)

    def _sample_lights(self, pivots: Pivots, paths: Paths, segment: Segment, step: int) -> None:
        """Light that one place on each segment scatters back along the ray."""
        kernel = self._kernel
        choice, _ = self._pair(step, VOLUME_CHOICES, paths)
        number = np.zeros(paths.size, np.intp)
        cell = kernel.selection.everywhere(paths.size)  # the light is chosen before its place on the segment
        if self._sampling.selects:
            number, _ = kernel.selection.choose(choice, cell)
        distance, weight = pivots.place(segment, number, *self._pair(step, VOLUME_PLACE, paths))
        position = segment.after(distance)
        light = choose_light(
            kernel, self._sampling.selects, position, cell, choice, *self._pair(step, VOLUME_LIGHT, paths)
        ).within_bounces(kernel, paths.scatterings)
        phases = Phases(self._media, segment.medium, segment.direction, segment.throughput)
        direct = scatter_light(self._sampling, phases, light) * weight
        self._direct.add(paths, VolumeOrigins(position, segment.medium), light, direct, self._shares(paths.size))

    def _shares(self, size: int) -> np.ndarray | None:
        """The shares of the families of lobes in light that volumes scatter: all zero.

        This leaves all of it to the last family, the volumes'.
        """
        passes = self._sums.passes
        return np.zeros((len(self._kernel.families) - 1, 3, size)) if passes is not None and passes.parts else None

    def _scatter(self, paths: Paths, segment: Segment, flight: Flight, step: int) -> Paths | None:
        """The paths that scatter, set out in new directions; None where none does."""
        index = np.flatnonzero(flight.scatters)
        if index.size == 0:
            return None
        following = paths.take(index)
        if self._sums.passes is not None:
            self._sums.passes.remember(following, self._shares(index.size))
        throughput = following.throughput * flight.weight[:, index]
        medium, direction = segment.medium[index], np.take(segment.direction, index, axis=1)
        phases = Phases(self._media, medium, direction, throughput)
        pick, fate = self._pair(step, VOLUME_FATE, following)
        wi, weight, density = phases.sample(pick, *self._pair(step, VOLUME_PHASE, following))
        throughput *= weight
        following.origin = following.scatter_origin = np.take(segment.after(flight.distance), index, axis=1)
        following.direction, following.pdf, following.medium = wi, density, medium
        following.travelled = np.zeros(index.size)
        if following.least_pdf is not None:
            following.least_pdf = np.minimum(following.least_pdf, density)
        if following.cell is not None:
            following.cell = self._kernel.selection.everywhere(index.size)
        if following.in_volumes is not None:
            following.in_volumes += 1
        following.scatterings += 1
        following.at_camera = False
        if following.ray_class is not None:
            following.ray_class = np.ones(index.size, np.intp)
        for name in ("left", "receiver"):
            if getattr(following, name) is not None:
                setattr(following, name, np.full(index.size, -1, getattr(following, name).dtype))
        going = throughput.any(axis=0) & self._flow.samples_lobes
        if self._flow.roulette and step >= ROULETTE_AFTER:
            chance = survival(np.abs(throughput))
            going &= ~(fate >= chance)  # what is not finite goes on, to be counted
            throughput /= np.where(chance > 0.0, chance, 1.0)
        following.throughput = throughput
        return following.take(np.flatnonzero(going))
