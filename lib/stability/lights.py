# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue of lights, and of the factors on lobes.

Factors are compensation, coats, reflectances and weights of strategies.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..bsdfs.compensated import multiple_scattering
from ..bsdfs.fresnels import F82, Dielectric
from ..bsdfs.lambert import Lambert
from ..bsdfs.layered import coat_tint
from ..bsdfs.reflected import Reflected
from ..bsdfs.rotated import rotate_in
from ..bsdfs.specular import refract
from ..lights.area import AreaSampler
from ..lights.point import PointSampler
from ..lights.spot import Falloff
from ..lights.triangles import EmissiveTriangles
from ..sampling.mis import cutoff_power_heuristic
from ..sampling.warps import uniform_disk, uniform_sphere
from ..scene.lights import AreaLight, Cone, PointLight
from . import closed_forms, domain, exact_lights, lobes
from .measure import Function

FAMILY = "lights and factors"
_VECTOR = ("x", "y", "z")


def _albedos(rng: np.random.Generator, count: int) -> np.ndarray:
    """A colour and both albedos, down to where all is lost and up to where nothing is."""
    near_one = 1.0 - 10.0 ** rng.uniform(-12.0, 0.0, (3, count))
    return np.where(rng.random((3, count)) < 0.5, near_one, rng.uniform(1e-3, 1.0, (3, count)))


def _coats(rng: np.random.Generator, count: int) -> np.ndarray:
    """An index of at least 1, a tint and a weight, and the cosine of the view."""
    ior = np.maximum(domain.indices(rng, count), 1.0 + 1e-8)
    return np.concatenate([ior, rng.uniform(1e-3, 1.0, (2, count)), domain.cosines(rng, count)])


def _refracted(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([domain.directions(rng, count), domain.indices(rng, count)])


def _reflecting(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([lobes.opposite(rng, count), domain.indices(rng, count)])


def _turned(rng: np.random.Generator, count: int) -> np.ndarray:
    phi = rng.uniform(0.0, 2.0 * np.pi, count)
    return np.concatenate([domain.directions(rng, count), np.stack([np.cos(phi), np.sin(phi)])])


def _pairs(rng: np.random.Generator, count: int) -> np.ndarray:
    return rng.random((2, count))


def _uniforms(rng: np.random.Generator, count: int) -> np.ndarray:
    return domain.uniforms(rng, count, 2)


def _densities(rng: np.random.Generator, count: int) -> np.ndarray:
    """Densities, half of them within a factor of ten of each other."""
    p = 10.0 ** rng.uniform(-20.0, 40.0, count)
    near = p * 10.0 ** rng.uniform(-1.0, 1.0, count)
    return np.stack([p, np.where(rng.random(count) < 0.5, near, 10.0 ** rng.uniform(-20.0, 40.0, count))])


def _places(rng: np.random.Generator, count: int) -> np.ndarray:
    """A light's place seen from a point, 1e-6 to 1e6 metres away."""
    return rng.normal(size=(3, count)) * 10.0 ** rng.uniform(-6.0, 6.0, count)


def _heights(rng: np.random.Generator, count: int) -> np.ndarray:
    """The height over a light's plane, and the distance to a place on it."""
    height = 10.0 ** rng.uniform(-6.0, 4.0, count)
    return np.stack([height, height * (1.0 + 10.0 ** rng.uniform(-8.0, 4.0, count))])


def _facing(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([10.0 ** rng.uniform(-6.0, 4.0, (1, count)), domain.cosines(rng, count)])


def _cones(rng: np.random.Generator, count: int) -> np.ndarray:
    """Directions, most of them in the soft edge of a cone, and the cone's cosine and blend."""
    edge, blend = rng.uniform(0.1, 0.999, count), rng.uniform(0.01, 1.0, count)
    cosine = np.where(rng.random(count) < 0.7, edge + rng.random(count) * (1.0 - edge) * blend, rng.random(count))
    sine, phi = np.sqrt((1.0 - cosine) * (1.0 + cosine)), rng.uniform(0.0, 2.0 * np.pi, count)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine, edge, blend])


def _compensation(a: np.ndarray) -> np.ndarray:
    color, directional, average = a
    albedos = (lambda cosine, alpha: directional), (lambda alpha: average)
    return multiple_scattering(np.ones(color.size), 1.0, color[None], albedos)


def _point(a: np.ndarray) -> np.ndarray:
    found = PointSampler(PointLight("point", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))).sample(-a, a[0], a[0])
    return np.concatenate([found.wi, found.radiance[:1]])


def _area(a: np.ndarray) -> np.ndarray:
    light = AreaLight(
        "area", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), "RECTANGLE", (1.0, 1.0, 1.0), np.pi
    )
    origin = np.stack([np.zeros_like(a[0]), np.zeros_like(a[0]), a[0]])
    return AreaSampler(light).pdf(origin, origin, a[1])


def _triangle(a: np.ndarray) -> np.ndarray:
    corner, edges = np.zeros((3, 1)), np.eye(3)[:, :2]
    triangle = EmissiveTriangles(corner, edges[:, :1], edges[:, 1:], np.zeros(1, np.intp), np.ones(1))
    return triangle.pdf_of_hit(np.zeros(a.shape[1], np.intp), a[0], a[1])


def _falloff(a: np.ndarray) -> np.ndarray:
    cones = (Cone((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), edge, blend) for edge, blend in a[3:].T)
    return np.concatenate([Falloff(cone)(wi[:, None]) for cone, wi in zip(cones, a[:3].T, strict=True)])


def lights_and_factors() -> list[Function]:
    """All functions of lights and factors.

    Each row is a title, the arguments, where they are drawn, the kernel and the truth.
    """
    pair = tuple(f"{w}.{c}" for w in ("wi", "wo") for c in _VECTOR)
    lambert = Lambert()
    rows: list[tuple[str, tuple[str, ...], Callable, Callable, Callable]] = [
        ("multiple scattering", ("color", "E", "Eavg"), _albedos, _compensation, exact_lights.multiple_scattering),
        (
            "tint of a coat",
            ("ior", "tint", "weight", "cos"),
            _coats,
            lambda a: coat_tint(a[0], a[1][None], a[2], a[3])[0],
            exact_lights.coat_tint,
        ),
        ("refraction", (*_VECTOR, "eta"), _refracted, lambda a: refract(a[:3], a[3])[0], exact_lights.refract),
        (
            "Lambert below a dielectric's reflectance",
            (*pair, "eta"),
            _reflecting,
            lambda a: Reflected(lambert, a[3:6], Dielectric(a[6])).evaluate(a[:3])[0][0],
            exact_lights.reflected,
        ),
        ("turned frame", (*_VECTOR, "cos", "sin"), _turned, lambda a: rotate_in(a[:3], *a[3:]), exact_lights.rotated),
        (
            "power heuristic with a cutoff",
            ("p", "q"),
            _densities,
            lambda a: cutoff_power_heuristic(*a),
            exact_lights.cutoff_power_heuristic,
        ),
        ("uniform disk", ("u1", "u2"), _uniforms, lambda a: np.stack(uniform_disk(*a)), exact_lights.uniform_disk),
        ("uniform sphere", ("u1", "u2"), _uniforms, lambda a: uniform_sphere(*a), exact_lights.uniform_sphere),
        ("point light", _VECTOR, _places, _point, exact_lights.point_light),
        ("density, area light by area", ("height", "distance"), _heights, _area, exact_lights.area_density),
        ("density, emissive triangle", ("distance", "cos"), _facing, _triangle, exact_lights.triangle_density),
        ("falloff of a spot", (*_VECTOR, "cos edge", "blend"), _cones, _falloff, exact_lights.falloff),
    ]
    mean_of_f82 = Function(
        FAMILY,
        "mean of F82",
        ("f0", "tint"),
        _pairs,
        lambda a: F82(*a).average,
        exact_lights.f82_average,
        closed_forms.BOUND,
        # What the subtraction of the two means makes of their errors.
        slack=lambda a: (a[0] + (1.0 - a[0]) / 21.0) / np.maximum(F82(*a).average, 1e-300),
        excuse="a difference of two means, as the curve itself is one of two curves",
    )
    return [*(Function(FAMILY, *row, closed_forms.BOUND) for row in rows), mean_of_f82]
