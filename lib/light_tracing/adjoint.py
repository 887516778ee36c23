# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: scattering of paths from the lights, towards the camera.

Directions are sampled from the light's side, and weighted by what a camera path would see.

The weight of every direction comes from the same lobes as in path tracing, made for the direction to the camera.
Lobes under layers, normals that interpolate or are tilted, and interfaces that bend are not symmetric (Veach 1997,
sections 5.2 and 5.3). The weight is

    f(light, on) |light.n|  |on.ng| / |light.ng|  over the density of `on`,

which holds the correction for shading normals (section 5.3). The factor eta^2 of refraction (section 5.2) comes from
f itself, and for Dirac lobes, which have no f, from `widening`, the ratio of solid angles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..bsdfs.mixture import Mixture
from ..bsdfs.tilted import Tilted
from ..sampling.warps import cosine_hemisphere
from ..surfaces.materials import PreparedMaterial
from ..surfaces.surface import SurfacePoints
from ..vectors import dot, orthonormal_basis, put, to_local, to_world

Uniforms = tuple[np.ndarray, np.ndarray, np.ndarray]
"""A uniform that picks the lobe and two for the direction, (n,) each."""

# Every lobe gets at least this part of an even share: what weighs nothing towards the light may weigh something towards the camera.
EVEN = 0.1
# Where normals differ, the part of directions that are sampled about the face's own: no lobe need reach all that camera paths see.
ABOUT_FACE = 0.125


@dataclass(frozen=True)
class Onward:
    """Sampled directions (3, n) of the world, their weight (3, n), and the lobe (n,).

    The lobe is the one that was picked, -1 for directions about the face's normal.
    """

    direction: np.ndarray
    weight: np.ndarray
    lobe: np.ndarray


def see_from(points: SurfacePoints, wo: np.ndarray) -> SurfacePoints:
    """The same points, seen from `wo` (3, n)."""
    return SurfacePoints(
        points.tables, points.triangle, points.u, points.v, points.position, points.ng * points.side, wo
    )


def mixture_of(material: PreparedMaterial, points: SurfacePoints) -> tuple[Mixture, tuple[np.ndarray, ...]]:
    """The lobes for the points' own wo, and the frame (t, s, n) in which they stand."""
    frame = (*orthonormal_basis(points.n), points.n)
    return material.mixture(points, to_local(points.wo, *frame), *frame), frame


def light_toward(
    material: PreparedMaterial, points: SurfacePoints, wo: np.ndarray, counted: np.ndarray | None = None
) -> np.ndarray:
    """Return the scattering f(light, wo) |light.n| |wo.ng| / |light.ng|, (3, n).

    The points are seen from the light.

    `counted` (lobes, n) says which lobes count; None for all. Dirac lobes never do.
    """
    here = see_from(points, wo)
    mixture, frame = mixture_of(material, here)
    value = _finite_value(mixture, to_local(points.wo, *frame), counted)
    return value * _cosines(points, here, frame)


def scatter(
    material: PreparedMaterial, points: SurfacePoints, uniforms: Uniforms, allowed: np.ndarray | None = None
) -> Onward:
    """Sample directions in which light goes on from points that are seen from it.

    Without `allowed` the weight counts all lobes that could have given the direction (one-sample model, Veach 1997, section 9.2.4). With it,
    (lobes, n) bool, one of the allowed lobes is picked and counted alone, so that paths can be told apart by their lobes.
    """
    mixture, frame = mixture_of(material, points)
    apart = allowed is not None
    chances = _chances(mixture, points, allowed)
    lobe = (uniforms[0] >= np.cumsum(chances, axis=0)[:-1]).sum(axis=0)
    local, dirac, kept = _draw(mixture, points, frame, lobe, uniforms[1:])
    density = _density(mixture, points, local, frame, chances, lobe, apart)
    onward = to_world(local, *frame)
    here = see_from(points, onward)
    seen, seen_frame = mixture_of(material, here)
    counted = np.arange(len(mixture.lobes))[:, None] == lobe if apart else None
    weight = _finite_value(seen, to_local(points.wo, *seen_frame), counted)
    weight *= np.divide(1.0, density, out=np.zeros_like(density), where=density > 0.0)
    for k, one in enumerate(mixture.lobes):
        if one.delta:
            at = np.flatnonzero(lobe == k)
            color = np.broadcast_to(seen.colors[k], weight.shape)
            above = to_local(onward, *seen_frame)[2, at] > 0.0
            put(weight, at, color[:, at] * dirac[:, at] * (above / chances[k, at]))
    weight *= _cosines(points, here, seen_frame) * kept
    return Onward(onward, weight, np.where(lobe < len(mixture.lobes), lobe, -1))


def _cosines(points: SurfacePoints, here: SurfacePoints, frame: tuple[np.ndarray, ...]) -> np.ndarray:
    """Return the ratio |wo.ng| / |light.ng|, (n,).

    It is 0 where the normals see the light on different sides, because path tracing counts nothing there.
    """
    light = points.wo
    facing = dot(here.ng, light)
    agrees = dot(frame[2], light) * facing > 0.0
    ratio = np.abs(dot(here.ng, here.wo)) / np.where(agrees, np.abs(facing), 1.0)
    return np.where(agrees, ratio, 0.0)


def _finite_value(mixture: Mixture, light: np.ndarray, counted: np.ndarray | None) -> np.ndarray:
    """Sum of colour f |light.n| over the lobes that count, Dirac ones left out, (3, n)."""
    value = np.zeros_like(light)
    for k, (lobe, color) in enumerate(zip(mixture.lobes, mixture.colors, strict=True)):
        if not lobe.delta:
            one = color * lobe.evaluate(light)[0]
            value += one if counted is None else np.where(counted[k], one, 0.0)
    return value


def _chances(mixture: Mixture, points: SurfacePoints, allowed: np.ndarray | None) -> np.ndarray:
    """Chance of each lobe, and of a direction about the face's normal, (lobes + 1, n)."""
    count = len(mixture.lobes)
    chances = np.zeros((count + 1, points.size))
    for k, (lobe, color) in enumerate(zip(mixture.lobes, mixture.colors, strict=True)):
        chances[k] = np.abs(color).mean(axis=0) * lobe.estimate
    if allowed is not None:
        chances[:count] *= allowed
    total = chances.sum(axis=0)
    chances /= np.where(total > 0.0, total, 1.0)
    if count > 1:
        even = np.ones((count, 1)) if allowed is None else allowed
        chances[:count] *= 1.0 - EVEN
        chances[:count] += EVEN * even / np.maximum(even.sum(axis=0), 1)
    if allowed is None and (not points.tables.all_flat or any(isinstance(lobe, Tilted) for lobe in mixture.lobes)):
        chances *= 1.0 - ABOUT_FACE
        chances[count] = ABOUT_FACE
    return chances


def _draw(
    mixture: Mixture,
    points: SurfacePoints,
    frame: tuple[np.ndarray, ...],
    lobe: np.ndarray,
    uniforms: tuple[np.ndarray, np.ndarray],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sample local directions (3, n) of the picked lobes.

    Also returns the weight times the widening, (3, n), of Dirac lobes, 0 for others; and which directions count (n,).

    What a lobe samples with weight 0 does not count: reflection that ends below the surface is not refraction, although it
    looks like it.
    """
    local, dirac = np.zeros((3, points.size)), np.zeros((3, points.size))
    kept = np.ones(points.size, bool)
    for k, one in enumerate((*mixture.lobes, None)):
        at = np.flatnonzero(lobe == k)
        if at.size == 0:
            continue
        u1, u2 = (u[at] for u in uniforms)
        if one is None:
            put(local, at, _about_face(points.at(at), tuple(axis[:, at] for axis in frame), u1, u2))
            continue
        piece = one.part(at)
        wi, weight, _ = piece.sample(u1, u2)
        put(local, at, wi)
        kept[at] = (weight != 0.0).any(axis=0)
        if one.delta:
            put(dirac, at, np.broadcast_to(weight * piece.widening(wi), wi.shape))
    return local, dirac, kept


def _about_face(points: SurfacePoints, frame: tuple[np.ndarray, ...], u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """Directions by the cosine about the face's normal, on either side by half, in the frame."""
    turn, side = np.modf(2.0 * u1)
    normal = np.where(side > 0.0, -points.ng, points.ng)
    return to_local(to_world(cosine_hemisphere(turn, u2), *orthonormal_basis(normal), normal), *frame)


def _density(
    mixture: Mixture,
    points: SurfacePoints,
    local: np.ndarray,
    frame: tuple[np.ndarray, ...],
    chances: np.ndarray,
    lobe: np.ndarray,
    apart: bool,
) -> np.ndarray:
    """Return the density per steradian of the sampled directions (n,).

    It is that of all lobes together, or that of the picked one; 0 for Dirac lobes.

    A lobe counts where it has a value, as it keeps only what it samples with weight.
    """
    density = np.zeros(points.size)
    is_dirac = np.zeros(points.size, bool)
    for k, one in enumerate(mixture.lobes):
        picked = lobe == k
        if one.delta:
            is_dirac |= picked
        else:
            value, pdf = one.evaluate(local)
            counts = (value != 0.0).any(axis=0)
            density += chances[k] * pdf * (counts & picked if apart else counts)
    if not apart and chances[-1].any():
        cosine = np.abs(dot(to_local(points.ng, *frame), local))
        density += chances[-1] * cosine * (0.5 / np.pi)
    return np.where(is_dirac, 0.0, density)
