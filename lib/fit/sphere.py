# SPDX-License-Identifier: GPL-3.0-or-later
"""Observations from an image of one sphere under one sun.

They have what every pixel sees of the sphere, and from where it is lit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..effects.facts import is_zero
from ..errors import EtalonError
from ..film.moments import Moments
from ..scene.camera import PANORAMAS
from ..scene.expressions import Constant
from ..scene.lights import SunLight
from ..scene.materials import Anisotropic
from ..scene.scene import Scene
from ..surfaces.surface import SurfacePoints, SurfaceTables
from ..vectors import cross, dot, normalize
from ..wavefront.camera_rays import camera_rays
from ..wavefront.raycaster import Raycaster
from .observations import Observations

RENDER_NOISE = 1e-4
"""Relative: what Cycles' image differs from its model beyond its stated variance (tests/benchmarks/fit_noise.py).

Measured 3e-5 at alpha 0.64 and 9e-5 at alpha 0.36, for normals of smooth faces that are rounded, and for how pixels are split here.
"""
_ROUND = 0.01
_COARSE = 4
_SPLITS = ((1.0, _COARSE), (1.3, 8), (4.0, 16))
"""From what ratio of a pixel's neighbours on it is split into so many rows and columns."""
_LEAST_COSINE = 0.2
_MOST = 250
_LARGEST_RATIO = 1e6


@dataclass(frozen=True)
class _Sight:
    """What subpixels see.

    It has wi and wo in local frames, (3, m), and the place of the pixel of each, (m,).
    """

    wi: np.ndarray
    wo: np.ndarray
    pixel: np.ndarray


def require_sphere(scene: Scene, name: str | None) -> tuple[SunLight, str]:
    """The sun of a scene with one sphere and one sun without width, and the sphere's name.

    Raises EtalonError that says what must change where the scene has anything else.
    """
    names = [item.name for item in scene.mesh.objects]
    if len(names) != 1:
        raise EtalonError(
            f"{scene.name}: {len(names)} objects are rendered ({', '.join(names[:4])}); hide all but the sphere"
        )
    if name is not None and name != names[0]:
        raise EtalonError(f"--object {name}: the object that is rendered is '{names[0]}'; hide it and show the other")
    suns = [light for light in scene.lights if isinstance(light, SunLight)]
    if len(suns) != 1 or len(scene.lights) != 1 or suns[0].half_angle > 0.0:
        raise EtalonError(
            f"{scene.name}: a fit needs exactly one light, a sun of angle 0; remove the others and set Angle to 0"
        )
    if not is_zero(scene.world.radiance) or scene.world.volume is not None:
        raise EtalonError(
            f"{scene.name}: the world gives light; a fit needs a black one: set the background's Strength to 0"
        )
    if scene.camera.kind in PANORAMAS or scene.camera.aperture is not None:
        raise EtalonError(f"{scene.name}: a fit needs a perspective or orthographic camera without depth of field")
    mesh = scene.mesh
    middle = 0.5 * (mesh.vertices.min(axis=1) + mesh.vertices.max(axis=1))
    radii = np.sqrt(np.square(mesh.vertices - middle[:, None]).sum(axis=0))
    if mesh.triangle_count < 100 or np.ptp(radii) > _ROUND * radii.max() or not mesh.smooth.all():
        raise EtalonError(
            f"'{names[0]}' is not a sphere with smooth faces; add one (100 faces at least) and use Shade Smooth"
        )
    return suns[0], names[0]


def observe_image(scene: Scene, sun: SunLight, moments: Moments, noise: float | None, source: str) -> Observations:
    """Observations of the pixels that lie on the lit sphere whole.

    `moments` are those of Cycles' replicates of the grey image, (height, width): the colours of a pixel share their noise, so
    that one says as much as three.
    Pixels where the light changes fast are split finer. The error of that, that of the midpoint rule on an exponential with the pixel's
    slope, is part of the noise. Raises EtalonError where none is left.
    """
    camera = scene.camera
    image = moments.mean.ravel()
    candidates = np.arange(camera.width * camera.height)
    coarse = _look(scene, sun, candidates, _COARSE)
    whole = candidates[_whole(coarse, len(candidates), _COARSE)]
    if not len(whole) or not (image[whole] > 0.0).any():
        raise EtalonError(
            f"{source}: nothing lit to fit; turn the sun or the camera so that the sphere's lit side is seen"
        )
    ratio = _steepness(image.reshape(camera.height, camera.width)).ravel()[whole]
    parts, kept, blur = [], [], []
    for (least, split), (most, _) in zip(_SPLITS, (*_SPLITS[1:], (np.inf, 0)), strict=True):
        chosen = _some(whole[(ratio >= least) & ((ratio < most) | np.isinf(most))])
        if not len(chosen):
            continue
        seen = _look(scene, sun, chosen, split)
        good = _whole(seen, len(chosen), split)
        inside = good[seen.pixel]
        parts.append((seen.wi[:, inside], seen.wo[:, inside], np.repeat(split, int(good.sum()))))
        kept.append(chosen[good])
        blur.append((np.log(np.minimum(ratio[np.isin(whole, chosen[good])], _LARGEST_RATIO)) / split) ** 2 / 48.0)
    pixels = np.concatenate(kept)
    splits = np.concatenate([p[2] for p in parts])
    counts = np.square(splits)
    errors = moments.standard_error.ravel()[pixels]
    return Observations(
        np.concatenate([p[0] for p in parts], axis=1),
        np.concatenate([p[1] for p in parts], axis=1),
        np.repeat(float(np.mean(sun.irradiance)) / counts, counts),
        np.r_[0, np.cumsum(counts)[:-1]],
        image[pixels][None],
        (np.square(errors) + np.square(np.concatenate(blur) * image[pixels]))[None],
        RENDER_NOISE if noise is None else noise,
        float(moments.least - 1),
        bool(_stretched(scene)),
        source,
    )


def _stretched(scene: Scene) -> list[Anisotropic]:
    """The lobes of the sphere whose anisotropy is not zero."""
    closures = [lobe.closure for material in scene.materials for lobe in material.lobes]
    return [one for one in closures if isinstance(one, Anisotropic) and one.is_anisotropic]


def _some(pixels: np.ndarray) -> np.ndarray:
    """At most `_MOST` of the pixels, evenly spread: more say little and take long."""
    return pixels if len(pixels) <= _MOST else pixels[np.linspace(0, len(pixels) - 1, _MOST).astype(int)]


def _steepness(image: np.ndarray) -> np.ndarray:
    """By what factor the light differs among a pixel and its eight neighbours.

    It is at least 1, (height, width).
    """
    padded = np.pad(image, 1, mode="edge")
    height, width = image.shape
    near = [padded[i : i + height, j : j + width] for i in range(3) for j in range(3)]
    least, most = np.min(near, axis=0), np.max(near, axis=0)
    return np.where(least > 0.0, most / np.where(least > 0.0, least, 1.0), np.inf)


def _look(scene: Scene, sun: SunLight, pixels: np.ndarray, split: int) -> _Sight:
    """What `split` x `split` subpixels of each pixel see of the sphere.

    Those that miss it or see it unlit have wi.z = 0.
    """
    camera = scene.camera
    row, column = np.divmod(pixels, camera.width)
    step = (np.arange(split) + 0.5) / split
    dx, dy = (a.ravel() for a in np.meshgrid(step, step))
    x, y = (column[:, None] + dx).ravel(), (camera.height - 1.0 - row[:, None] + dy).ravel()
    rays = camera_rays(camera, x, y, None)
    origin = np.broadcast_to(rays.origin, rays.direction.shape)
    caster = Raycaster(scene.mesh)
    hits = caster.closest(origin, rays.direction, rays.reach)
    met = np.flatnonzero(hits.triangle >= 0)
    direction = rays.direction[:, met]
    placed, ng, _ = caster.on_plane(hits.triangle[met], origin[:, met] + direction * hits.distance[met])
    points = SurfacePoints(
        SurfaceTables(scene.mesh),
        hits.triangle[met],
        hits.u[met].astype(float),
        hits.v[met].astype(float),
        placed,
        ng,
        -direction,
    )
    toward = normalize(np.asarray(sun.direction, float)[:, None])
    tangent, bitangent = _frame(scene, points)
    wi, wo = (np.stack([dot(tangent, w), dot(bitangent, w), dot(points.n, w)]) for w in (toward, -direction))
    lit = (dot(points.ng, toward) > 0.0) & (wo[2] > _LEAST_COSINE) & (wi[2] > _LEAST_COSINE)
    all_wi, all_wo = np.zeros(rays.direction.shape), np.zeros(rays.direction.shape)
    all_wi[:, met], all_wo[:, met] = np.where(lit, wi, 0.0), wo
    return _Sight(all_wi, all_wo, np.repeat(np.arange(len(pixels)), split * split))


def _frame(scene: Scene, points: SurfacePoints) -> tuple[np.ndarray, np.ndarray]:
    """Tangent and bitangent of the material's first stretched lobe, or any."""
    for closure in _stretched(scene):
        if not isinstance(closure.rotation, Constant):
            raise EtalonError(
                f"{scene.name}: the rotation of the anisotropy varies over the sphere; unlink it for a fit"
            )
        return points.tangent(closure.tangent, np.asarray(closure.rotation.number))
    axis = np.where(np.abs(points.n[2]) < 0.9, np.array([[0.0], [0.0], [1.0]]), np.array([[1.0], [0.0], [0.0]]))
    tangent = normalize(cross(axis, points.n))
    return tangent, cross(points.n, tangent)


def _whole(seen: _Sight, count: int, split: int) -> np.ndarray:
    """Whether all subpixels of a pixel see the lit sphere, (count,) bool.

    They may see it neither grazing nor under grazing light.
    """
    return np.bincount(seen.pixel, seen.wi[2] > 0.0, minlength=count) == split * split
