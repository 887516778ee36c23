# SPDX-License-Identifier: GPL-3.0-or-later
"""Subsurface scattering by a disk: where light leaves an object follows from a profile of the distance alone.

Christensen and Burley 2015, found by probes. As Cycles does it: the profile's density in a plane weighs what a probe meets,
wherever that is, so that off the plane it is no longer a density over the surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..scattering.profiles import DISK_REACH, burley_density, sample_burley
from ..scattering.walk import Exits
from ..surfaces.surface import SurfacePoints
from ..vectors import dot
from .probes import Probes


@dataclass(frozen=True)
class Disks:
    """Light that enters at some of the points, to leave about them.

    `index` (k,) of the points; `spread` (3, k) of the profile, in metres, 0 in channels that do not enter; throughput (3, k).
    """

    index: np.ndarray
    spread: np.ndarray
    throughput: np.ndarray


def leave_by_disk(
    probes: Probes, points: SurfacePoints, disks: Disks, pick: np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> Exits:
    """Return where the light of `disks` leaves; `pick`, `u1`, `u2` (n,) are uniforms of all the points.

    A channel is chosen for the probe, and one of the places that it meets, by what they weigh.
    """
    here = points.at(disks.index)
    own, rest = _choose_channel(disks.spread, u2[disks.index])
    off = sample_burley(own, rest)
    axes, hits = probes.cast(here.triangle, here.position, here.ng, u1[disks.index], off, DISK_REACH * own)
    probe = hits.probe
    away = hits.position - np.take(here.position, probe, axis=1)
    channels = np.count_nonzero(disks.spread > 0.0, axis=0)
    drawn = burley_density(disks.spread, off).sum(axis=0) / np.maximum(channels, 1)
    spread, distance = np.take(disks.spread, probe, axis=1), np.sqrt(dot(away, away))
    weight = burley_density(spread, distance) * (axes.weight(probe, hits.ng) / drawn[probe])
    size = weight.mean(axis=0)
    chosen, chance = _choose_hits(probe, size, pick[disks.index])
    light = np.take(disks.throughput, probe[chosen], axis=1) * np.take(weight, chosen, axis=1) / chance
    return Exits(
        disks.index[probe[chosen]],
        hits.triangle[chosen],
        hits.u[chosen],
        hits.v[chosen],
        np.take(hits.position, chosen, axis=1),
        np.take(hits.ng, chosen, axis=1) * here.side[probe[chosen]],
        light,
    )


def _choose_channel(spread: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the spread (n,) of one of the channels that enter, each as likely, and what is left of the uniform."""
    enters = spread > 0.0
    u = u * np.count_nonzero(enters, axis=0)
    number = np.floor(u)
    chosen = np.argmax(enters & (np.cumsum(enters, axis=0) == number + 1.0), axis=0)
    return spread[chosen, np.arange(u.size)], u - number


def _choose_hits(probe: np.ndarray, size: np.ndarray, pick: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Choose one hit for each probe that meets anything of a `size` (k,) above 0, by the sizes.

    Returns the hits (c,) and the chance of each. `pick` (n,) are uniforms of the probes.
    """
    order = np.argsort(probe, kind="stable")
    probe, size = probe[order], size[order]
    total = np.bincount(probe, size, pick.size)
    upto = np.cumsum(size)
    before = np.concatenate([[0.0], np.cumsum(total)])[probe]
    target = before + pick[probe] * total[probe]
    chosen = np.flatnonzero((upto > target) & (upto - size <= target) & (size > 0.0))
    return order[chosen], size[chosen] / total[probe[chosen]]
