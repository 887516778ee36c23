# SPDX-License-Identifier: GPL-3.0-or-later
"""Entry of light below surfaces.

It says what enters by each closure, into what medium, and in which direction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..microfacets.ggx import GGX
from ..sampling.warps import cosine_hemisphere
from ..scattering.subsurface import BY_DISK, LEAST_RADIUS, Medium, make_medium
from ..scene.expressions import Expression
from ..scene.materials import Subsurface
from ..textures.fold import is_constant
from ..vectors import dot, orthonormal_basis, to_local, to_world
from .lobes import Site

# Cycles' bounds of the index (bssrdf_setup).
_LEAST_IOR, _LARGEST_IOR = 1.01, 3.8
_GGX = GGX()


@dataclass(frozen=True)
class Entry:
    """What enters by one closure at n points.

    weight (3, n): the share of the light that reaches the closure, in the channels that have a colour and a radius; guess (n,): how large it is
    beside what is reflected.
    """

    weight: np.ndarray
    guess: np.ndarray


@dataclass(frozen=True)
class WalkEntry(Entry):
    """What enters to walk in a medium.

    Walks bring all of a path's light or none, so that the guess goes by the root of what comes out again.
    """

    closure: Subsurface
    medium: Medium
    alpha: np.ndarray
    ior: np.ndarray
    normal: np.ndarray


@dataclass(frozen=True)
class DiskEntry(Entry):
    """What leaves again about the points by Burley's profile of the `spread` (3, n), in metres; 0 in channels that do not enter."""

    spread: np.ndarray


def make_entry(weight: Expression, closure: Subsurface, site: Site) -> WalkEntry | DiskEntry:
    """What enters by `closure` at the points of `site`."""
    size = site.points.size
    share, color, radius = (
        np.broadcast_to(np.maximum(np.atleast_1d(site.read(x)), 0.0), (3, size))
        for x in (weight, closure.color, closure.radius)
    )
    deep = radius >= LEAST_RADIUS
    if closure.mapping == BY_DISK:
        leaves = share * color * deep
        return DiskEntry(leaves, leaves.mean(axis=0), np.where(deep, radius / (4.0 * np.pi), 0.0))
    g, ior, alpha = (np.broadcast_to(site.read(x), (size,)) for x in (closure.anisotropy, closure.ior, closure.alpha))
    ior = np.clip(ior, _LEAST_IOR, _LARGEST_IOR)
    enters = share * ((color > 0.0) & deep)
    medium = make_medium(closure.mapping, color, radius, g, ior)
    normal = site.n if closure.normal is None else np.broadcast_to(site.read(closure.normal), site.n.shape)
    guess = (enters * np.sqrt(np.minimum(color, 1.0))).mean(axis=0)
    return WalkEntry(enters, guess, closure, medium, np.clip(alpha, 0.0, 1.0), ior, normal)


def sample_entry(entry: WalkEntry, index: np.ndarray, site: Site, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """Return directions (3, k) into the body at the points `index` (k,), in world space.

    They are zero where none leads below the face.

    They refract the viewer's direction at a visible GGX normal. Their light is not weighted: the entry says only where
    light goes.
    """
    n = np.take(entry.normal, index, axis=1)
    t, s = orthonormal_basis(n)
    wo = to_local(np.take(site.points.wo, index, axis=1), t, s, n)
    if entry.closure.softly:
        soft = u1 < 0.5
        u1 = np.where(soft, 2.0 * u1, 2.0 * u1 - 1.0)
        diffuse = cosine_hemisphere(u1, u2)
        diffuse[2] *= -1.0
        down = np.where(soft, diffuse, refract_below(wo, 1.0, entry.ior[index], u1, u2))
    else:
        down = refract_below(wo, entry.alpha[index], entry.ior[index], u1, u2)
    direction = to_world(down, t, s, n)
    return direction * (dot(direction, np.take(site.points.ng, index, axis=1)) < 0.0)


def refract_below(
    wo: np.ndarray, alpha: np.ndarray | float, ior: np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> np.ndarray:
    """Refract `wo` (3, n) at a visible GGX normal into the index `ior` > 1.

    The result (3, n) is local, and zero where `wo` is not above the surface.

    Snell's law at the normal m: -wo / ior + (wo.m / ior - sqrt(1 - (1 - (wo.m)^2) / ior^2)) m.
    """
    m = _GGX.sample_visible(wo, alpha, alpha, u1, u2)
    cosine, eta = dot(wo, m), 1.0 / ior
    along = eta * cosine - np.sqrt(1.0 - np.square(eta) * (1.0 - np.square(cosine)))
    return (along * m - eta * wo) * (wo[2] > 0.0)


def may_be_shallow(closure: Subsurface) -> bool:
    """Whether a channel may have no radius anywhere."""
    radius = closure.radius
    return not is_constant(radius) or bool(np.any(np.asarray(radius.value) < LEAST_RADIUS))
