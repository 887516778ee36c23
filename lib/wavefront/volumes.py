# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: volumes that scatter.

Where paths scatter along a segment, from where light is sampled, and phase functions.

Coefficients are coloured. A channel is chosen, and what it gives is weighed by the density of all channels together
(the balance heuristic; Veach 1997, section 9.2.2). Light is sampled from a place of its own on the segment: at a
distance that follows what scatters, or at an angle as seen from the light (equiangular.py), again by the density of
both together. Light sampling and the phase function are weighed against each other by directions alone, as at surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..lights.light import Aimable
from ..scattering import equiangular, henyey_greenstein
from ..scattering.free_path import attenuated_length, depth, distance_density, sample_distance, transmittance
from ..vectors import dot
from .kernel import Kernel
from .light_choice import LightChoice, LightSampling, weigh_light
from .media import AIR, Media
from .paths import Paths
from .raycaster import Hits


@dataclass(frozen=True)
class Segment:
    """The parts of paths up to the next face, where they may scatter.

    `index` (n,) is their place among all paths.
    origin, direction (3, n); length (n,), infinite where no face follows; medium (n,); extinction and scattering
    (3, n), 1/m; throughput (3, n), at the origin.
    """

    index: np.ndarray
    origin: np.ndarray
    direction: np.ndarray
    length: np.ndarray
    medium: np.ndarray
    extinction: np.ndarray
    scattering: np.ndarray
    throughput: np.ndarray

    def after(self, distance: np.ndarray) -> np.ndarray:
        """Points (3, n) at a `distance` (n,) from the origin."""
        return self.origin + distance * self.direction


def find_segments(media: Media, paths: Paths, hits: Hits, limits: tuple[int, int]) -> Segment:
    """The segments of those paths that may scatter before they meet the next face.

    `limits` are those of bounces, as in `Paths.may_scatter`.
    """
    medium = np.where(hits.triangle < 0, AIR, paths.medium)
    turbid = media.scattering.any(axis=(0, 1))
    index = np.flatnonzero(np.take(turbid, medium) & paths.may_scatter(*limits))
    medium = medium[index]
    origin, direction, throughput = (
        np.take(a, index, axis=1) for a in (paths.origin, paths.direction, paths.throughput)
    )
    extinction = np.take(media.extinction, medium, axis=1)
    scattering = np.take(media.scattering.sum(axis=0), medium, axis=1)
    return Segment(index, origin, direction, hits.distance[index], medium, extinction, scattering, throughput)


def _shares(color: np.ndarray) -> np.ndarray:
    """The part (3, n) that each channel has of a colour (3, n); thirds of black."""
    size = np.abs(color)
    total = size.sum(axis=0)
    return np.where(total > 0.0, size / np.where(total > 0.0, total, 1.0), 1.0 / 3.0)


def _pick(shares: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Index (n,) among `shares` (k, n), which sum to 1, by uniforms (n,).

    An entry without a share is never chosen.
    """
    bounds = np.cumsum(shares, axis=0)
    return (u * bounds[-1] >= bounds[:-1]).sum(axis=0)


def _at(values: np.ndarray, channel: np.ndarray) -> np.ndarray:
    return np.take_along_axis(values, channel[None], axis=0)[0]


@dataclass(frozen=True)
class Flight:
    """Which paths scatter (n,) bool, and after what distance (n,).

    `weight` (3, n) multiplies their throughput. For those that scatter, the scattering coefficient (1/m) is still to be
    multiplied.
    """

    scatters: np.ndarray
    distance: np.ndarray
    weight: np.ndarray


def fly(segment: Segment, u1: np.ndarray, u2: np.ndarray) -> Flight:
    """Have paths scatter along their segments or reach the ends.

    The uniforms are for the channel and for the distance.
    A channel scatters with the chance of its albedo times what it extinguishes on the way, so that no path is absorbed
    by chance.
    """
    shares, tau = _shares(segment.throughput), depth(segment.extinction, segment.length)
    dense = segment.extinction > 0.0
    albedo = np.divide(segment.scattering, segment.extinction, out=np.zeros(tau.shape), where=dense)
    chance = albedo * -np.expm1(-tau)
    channel = _pick(shares, u1)
    own = _at(chance, channel)
    scatters = u2 < own
    extinction = np.where(scatters, _at(segment.extinction, channel), 1.0)
    place = np.where(scatters, u2 / np.where(scatters, own, 1.0), 0.0)
    distance = np.where(scatters, sample_distance(extinction, segment.length, place), segment.length)
    through = np.exp(-np.where(scatters, depth(segment.extinction, distance), tau))
    density = (shares * np.where(scatters, segment.scattering * through, 1.0 - chance)).sum(axis=0)
    weight = np.divide(through, density, out=np.zeros(through.shape), where=density > 0.0)
    return Flight(scatters, distance, weight)


class Pivots:
    """The middles of lights that have a place of their own, from which segments are seen."""

    def __init__(self, kernel: Kernel) -> None:
        extents = [light.extent if isinstance(light, Aimable) else None for light in kernel.lights]
        self._placed = np.array([extent is not None for extent in extents], bool)
        self._center = np.hstack([np.zeros((3, 1)) if extent is None else extent.center for extent in extents])

    def place(
        self, segment: Segment, number: np.ndarray, u1: np.ndarray, u2: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distances (n,) at which to sample the lights `number` (n,).

        Also what is left of their light over the density there, (3, n).
        """
        turbid = segment.scattering > 0.0
        scattered = np.where(turbid, segment.scattering, 0.0) * np.where(
            turbid, attenuated_length(np.where(turbid, segment.extinction, 1.0), segment.length), 0.0
        )
        shares = _shares(segment.throughput * scattered)
        half = np.where(self._placed[number], 0.5, 0.0)
        strategy = _pick(np.concatenate([shares * (1.0 - half), half[None]]), u1)
        by_angle = strategy == 3
        extinction = np.where(by_angle, 1.0, _at(segment.extinction, np.minimum(strategy, 2)))
        part = equiangular.make_span(
            segment.origin, segment.direction, segment.length, np.take(self._center, number, axis=1)
        )
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # of segments without length, and of lights that are nowhere
            distance = np.where(by_angle, equiangular.sample(part, u2), sample_distance(extinction, segment.length, u2))
            distance = np.clip(distance, 0.0, segment.length)
            density = (shares * distance_density(segment.extinction, segment.length, distance)).sum(axis=0)
            density = np.where(half > 0.0, 0.5 * density + 0.5 * equiangular.density(part, distance), density)
        left = transmittance(segment.extinction, distance)
        return distance, np.divide(left, density, out=np.zeros(left.shape), where=density > 0.0)


class Phases:
    """The phase functions of the `medium` (n,), each picked by what it scatters.

    The light flies along `direction` (3, n).
    """

    def __init__(self, media: Media, medium: np.ndarray, direction: np.ndarray, throughput: np.ndarray) -> None:
        self._anisotropies, self._direction = media.anisotropies, direction
        self._scattering = np.take(media.scattering, medium, axis=2)
        weight = (np.abs(throughput) * self._scattering).sum(axis=1)
        total = weight.sum(axis=0)
        self._shares = np.where(total > 0.0, weight / np.where(total > 0.0, total, 1.0), 1.0 / len(weight))

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The light scattered towards `wi` (3, n), in 1/m per steradian, (3, n).

        Also the density of `sample` there, (n,).
        """
        cosine = dot(self._direction, wi)
        value, density = np.zeros(wi.shape), np.zeros(cosine.shape)
        for k, g in enumerate(self._anisotropies):
            one = henyey_greenstein.evaluate(cosine, np.asarray(g))
            value += self._scattering[k] * one
            density += self._shares[k] * one
        return value, density

    def sample(self, u: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Sample directions (3, n): one uniform picks a phase function, two give the direction.

        Returns them, `evaluate` over the density (3, n), and the density.
        """
        g = np.take(np.array(self._anisotropies), _pick(self._shares, u))
        wi = henyey_greenstein.sample(self._direction, g, u1, u2)
        value, density = self.evaluate(wi)
        return wi, value / density, density


def scatter_light(sampling: LightSampling, phases: Phases, light: LightChoice) -> np.ndarray:
    """Sampled light that is scattered back along the rays, (3, n).

    It is weighed against the phase functions' own samples.
    """
    value, density = phases.evaluate(light.sample.wi)
    return value * weigh_light(sampling, light, density) * light.sample.radiance
