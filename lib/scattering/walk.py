# SPDX-License-Identifier: GPL-3.0-or-later
"""Random walks in homogeneous media inside of bodies.

They go from a face to the face where they leave.

Free paths are exponential, and one colour channel, chosen by what each carries, says how long they are; all channels
count by the balance heuristic (Wilkie et al. 2014). Nothing bounds the number of scatterings but roulette, which
leaves the mean as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..sampling.sobol import hash64
from .henyey_greenstein import sample
from .subsurface import Medium

# Beyond so many scatterings walks end at random: of those that get to n, _LONG / n are followed. As n^(-1/2) of the walks in a
# half space that absorbs nothing get to n, their number and the variance of their weights both stay bounded for the albedos there are.
_LONG = 128
# From this free path on, counted from 0, Cycles takes scattering for isotropic.
_SIMILAR_FROM = 10
# The chance to go on where hardly anything comes back.
_FAR_SURVIVAL = 0.9
_STEP = np.uint64(0x9E3779B97F4A7C15)
_LOWER = np.uint64(0xFFFFFFFF)

Closest = Callable[
    [np.ndarray, np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
]
"""Rays of walks (index, origin, direction, reach) -> triangle, -1 for none, distance, u, v of the first face of the body that they meet."""

IsFar = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Walks (index, position) -> whether they are so far from the body that hardly anything comes back from there, (n,) bool."""


@dataclass(frozen=True)
class Walks:
    """Walks under way or at their ends; arrays over the same n of them.

    `index` (n,) is the number with which each began; origin, direction, throughput (3, n); medium of each.
    """

    index: np.ndarray
    origin: np.ndarray
    direction: np.ndarray
    throughput: np.ndarray
    medium: Medium

    def at(self, index: np.ndarray) -> Walks:
        """The walks `index`."""
        arrays = {name: np.take(a, index, axis=-1) for name, a in vars(self).items() if name != "medium"}
        return Walks(**arrays, medium=self.medium.at(index))


@dataclass(frozen=True)
class Exits:
    """Where walks leave the body.

    The fields are the index (n,) of the walk, triangle, u, v (n,), position, direction of travel, throughput (3, n).
    """

    index: np.ndarray
    triangle: np.ndarray
    u: np.ndarray
    v: np.ndarray
    position: np.ndarray
    direction: np.ndarray
    throughput: np.ndarray


def walk(closest: Closest, is_far: IsFar, walks: Walks, keys: np.ndarray, most: int | None = None) -> tuple[Exits, int]:
    """Follow walks that have just entered until they leave.

    Returns the exits, and how many rays were traced.

    `keys` (n,) uint64 seed the random numbers of each walk. A walk that meets no face goes on: the body may be open,
    and the medium has no other bound; where it `is_far`, it ends at random. `most` ends walks after so many free
    paths, and takes long ones for isotropic as Cycles does.
    """
    level = walks.throughput.max(axis=0)
    exits, rays, step = [], 0, 0
    while walks.index.size and (most is None or step < most):
        if most is not None and step == _SIMILAR_FROM:
            walks = replace(walks, medium=similar(walks.medium))
        u = _uniforms(keys, step)
        length, channel_pdf = sample_free_path(walks, u[0])
        triangle, distance, hit_u, hit_v = closest(walks.index, walks.origin, walks.direction, length)
        rays += walks.index.size
        left = triangle >= 0
        length = np.where(left, distance, length)
        throughput = walks.throughput * free_path_weight(walks.medium, length, left, channel_pdf)
        position = walks.origin + walks.direction * length
        out, on = np.flatnonzero(left), np.flatnonzero(~left)
        part = walks.at(out)
        exits.append(
            Exits(
                part.index,
                triangle[out],
                hit_u[out],
                hit_v[out],
                np.take(position, out, axis=1),
                part.direction,
                np.take(throughput, out, axis=1),
            )
        )
        chance = _survival(np.take(throughput, on, axis=1), level[on], step)
        chance *= np.where(is_far(walks.index[on], np.take(position, on, axis=1)), _FAR_SURVIVAL, 1.0)
        kept = np.flatnonzero(u[1, on] < chance)
        on, chance = on[kept], chance[kept]
        walks = replace(walks, origin=position, throughput=throughput).at(on)
        keys, level = keys[on], level[on]
        scattered = sample(walks.direction, walks.medium.anisotropy, u[2, on], u[3, on])
        walks = replace(walks, direction=scattered, throughput=walks.throughput / chance)
        step += 1
    return _joined(exits), rays


def similar(medium: Medium) -> Medium:
    """Return the isotropic medium that scatters light as far by the similarity relation.

    It has sigma_s (1 - g) in place of sigma_s.
    """
    scattering = medium.albedo * medium.extinction * (1.0 - medium.anisotropy)
    extinction = medium.extinction * (1.0 - medium.albedo) + scattering
    return replace(
        medium, extinction=extinction, albedo=scattering / extinction, anisotropy=np.zeros_like(medium.anisotropy)
    )


def sample_free_path(walks: Walks, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sample a length (n,), exponential in a channel that `u` also chooses.

    The second result is the chances (3, n) of the channels.
    """
    carried = walks.throughput * walks.medium.albedo
    total = carried.sum(axis=0)
    chance = carried / np.where(total > 0.0, total, 1.0)
    first, second = chance[0], chance[0] + chance[1]
    channel = (u >= first).astype(np.intp) + (u >= second)
    low = np.choose(channel, (0.0, first, second))
    width = np.take_along_axis(chance, channel[None], axis=0)[0]
    again = np.clip((u - low) / np.where(width > 0.0, width, 1.0), 0.0, 1.0 - 2.0**-53)
    extinction = np.take_along_axis(walks.medium.extinction, channel[None], axis=0)[0]
    return -np.log1p(-again) / extinction, chance


def free_path_weight(medium: Medium, length: np.ndarray, left: np.ndarray, chance: np.ndarray) -> np.ndarray:
    """What each channel carries over its density, (3, n), after a free path of `length` (n,).

    Transmittance over the chance to get so far where the path `left` the body (n,) bool, else transmittance times scattering over the
    density of the length; the densities are means over the channels with their `chance` (3, n).
    """
    transmittance = np.exp(-medium.extinction * length)
    density = np.where(left, transmittance, medium.extinction * transmittance)
    mean = (chance * density).sum(axis=0)
    return np.where(left, 1.0, medium.albedo) * density / np.where(mean > 0.0, mean, 1.0)


def _survival(throughput: np.ndarray, level: np.ndarray, step: int) -> np.ndarray:
    """Return the chance to go on, (n,).

    It follows from what is left of the first throughput's `level`, and is less than 1 in long walks.
    """
    left = throughput.max(axis=0) / np.where(level > 0.0, level, 1.0)
    chance = np.clip(left, 0.0, 1.0)
    return chance * (step / (step + 1.0)) if step >= _LONG else chance


def _uniforms(keys: np.ndarray, step: int) -> np.ndarray:
    """Four uniforms in (0, 1) for each walk, (4, n)."""
    with np.errstate(over="ignore"):
        bits = [hash64(keys + _STEP * np.uint64(2 * step + k + 1)) for k in range(2)]
    halves = [half for word in bits for half in (word & _LOWER, word >> np.uint64(32))]
    return np.stack(halves).astype(np.float64) * 2.0**-32 + 2.0**-33


def _joined(parts: list[Exits]) -> Exits:
    names = ("index", "triangle", "u", "v", "position", "direction", "throughput")
    if not parts:
        nothing, vectors = np.empty(0), np.empty((3, 0))
        return Exits(nothing.astype(np.intp), nothing.astype(np.intp), nothing, nothing, vectors, vectors, vectors)
    return Exits(*(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in names))
