# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue of closed forms: distributions, masking, Fresnel, densities, solid angles."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..bsdfs.fresnels import F82
from ..bsdfs.microfacet import MicrofacetReflection
from ..lights.sphere import SphereSampler
from ..lights.spherical_rectangle import SphericalRectangle
from ..lights.spread import Spread
from ..lights.sun import SunSampler
from ..microfacets import densities, fresnel, masking
from ..microfacets.beckmann import Beckmann, smith_lambda_rational
from ..microfacets.distribution import Distribution
from ..microfacets.ggx import GGX
from ..microfacets.scale_mixture import ExponentialPower, ShiftedGamma
from ..microfacets.student_t import StudentT
from ..sampling.mis import power_heuristic
from ..scene.lights import SphereLight, SunLight
from . import cycles_single, domain, exact, single
from .measure import Function, Single, Truth

BOUND = 8.0
FAMILY = "closed form"
STUDENT_SHAPES = (1.6, 2.5, 1e4)
_WHITE = (1.0, 1.0, 1.0)
_VECTOR = ("x", "y", "z")
_ALPHAS = ("alpha_x", "alpha_y")
_THREE = tuple(f"{w}.{c}" for w in ("wi", "wo", "m") for c in _VECTOR)

Draw = Callable[[np.random.Generator, int], np.ndarray]


def _normals(rng: np.random.Generator, count: int) -> np.ndarray:
    alpha = domain.alphas(rng, count)
    return np.concatenate([domain.lobe_normals(rng, alpha), alpha])


def _views(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([domain.directions(rng, count), domain.alphas(rng, count)])


def _slopes(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw views and a from 0.03 to 30.

    In a third of the views the surface is seen where Beckmann's exponential still counts.
    """
    views = _views(rng, count)
    x, y, _, alpha_x, alpha_y = views
    wanted = 10.0 ** rng.uniform(-1.5, 1.5, count) * np.sqrt((alpha_x * x) ** 2 + (alpha_y * y) ** 2)
    sine = np.sqrt(x * x + y * y)
    chosen = (rng.random(count) < 1.0 / 3.0) & (sine > 0.0)
    length = np.hypot(sine, wanted)
    views[:3] = np.where(chosen, np.stack([x, y, wanted]) / np.where(chosen, length, 1.0), views[:3])
    return views


def _pairs(rng: np.random.Generator, count: int) -> np.ndarray:
    """wi, wo and the half vector between them."""
    wi, wo = domain.directions(rng, count), domain.directions(rng, count)
    m = wi + wo
    return np.concatenate([wi, wo, m / np.sqrt((m * m).sum(axis=0))])


def _lambdas(rng: np.random.Generator, count: int) -> np.ndarray:
    return 10.0 ** rng.uniform(-20.0, 14.0, (2, count))


def dielectrics(rng: np.random.Generator, count: int) -> np.ndarray:
    """Cosines and indices, some of them next to the critical angle."""
    cosine, eta = domain.cosines(rng, count), domain.indices(rng, count)
    critical = np.sqrt(np.maximum((1.0 - eta) * (1.0 + eta), 0.0)) * (
        1.0 + 10.0 ** rng.uniform(-15.0, -1.0, (1, count))
    )
    near = (rng.random((1, count)) < 0.2) & (critical > 0.0) & (critical < 1.0)
    return np.concatenate([np.where(near, critical, cosine), eta])


def _metals(rng: np.random.Generator, count: int) -> np.ndarray:
    k = 10.0 ** rng.uniform(-8.0, 1.0, (1, count))
    return np.concatenate([domain.cosines(rng, count), domain.indices(rng, count), k])


def _f0(rng: np.random.Generator, count: int) -> np.ndarray:
    near_one = 1.0 - 10.0 ** rng.uniform(-8.0, 0.0, (1, count))
    f0 = np.where(rng.random((1, count)) < 0.3, near_one, 10.0 ** rng.uniform(-16.0, 0.0, (1, count)))
    return np.concatenate([domain.cosines(rng, count), f0])


def _visible(rng: np.random.Generator, count: int) -> np.ndarray:
    """A normal, a viewer that sees it from the front, D and Lambda."""
    m, wo = domain.directions(rng, count), domain.directions(rng, count)
    wo[:2] *= np.where((wo * m).sum(axis=0) < 0.0, -1.0, 1.0)
    d, lambda_o = 10.0 ** rng.uniform(-12.0, 11.0, (1, count)), 10.0 ** rng.uniform(-20.0, 14.0, (1, count))
    return np.concatenate([m, wo, d, lambda_o])


def _facing(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([domain.directions(rng, count), domain.directions(rng, count)])


def _heuristic(rng: np.random.Generator, count: int) -> np.ndarray:
    """Densities from a sky's to far beyond a mirror's."""
    return 10.0 ** rng.uniform(-20.0, 60.0, (2, count))


def _rectangles(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw bounds of rectangles about the foot of the point, and its height.

    They go from a wall to a speck, from overhead to edge on.
    """
    size, offset = 10.0 ** rng.uniform(-6.0, 2.0, (2, count)), 10.0 ** rng.uniform(-3.0, 4.0, (2, count))
    offset *= rng.choice([-1.0, 0.0, 1.0], (2, count))
    low = offset - size * rng.random((2, count))
    high = low + size
    return np.stack([low[0], high[0], low[1], high[1], 10.0 ** rng.uniform(-6.0, 4.0, count)])


def _spheres(rng: np.random.Generator, count: int) -> np.ndarray:
    """A centre and a radius: from just outside (or inside) to 1e9 radii away."""
    axis = rng.normal(size=(3, count))
    axis /= np.sqrt((axis * axis).sum(axis=0))
    radius = 10.0 ** rng.uniform(-4.0, 2.0, count)
    ratio = np.where(
        rng.random(count) < 0.5, 1.0 + 10.0 ** rng.uniform(-14.0, 0.0, count), 10.0 ** rng.uniform(-1.0, 9.0, count)
    )
    return np.concatenate([axis * (radius * ratio), radius[None]])


def _half_angles(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.where(
        rng.random((1, count)) < 0.5, 10.0 ** rng.uniform(-9.0, 0.0, (1, count)), rng.uniform(1e-3, 1.57, (1, count))
    )


def _spreads(rng: np.random.Generator, count: int) -> np.ndarray:
    near_straight = math.pi - 10.0 ** rng.uniform(-9.0, 0.0, (1, count))
    return np.where(rng.random((1, count)) < 0.3, near_straight, 10.0 ** rng.uniform(-6.0, 0.4, (1, count)))


def _lobes(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw wi, wo and alphas, most of them where the lobe is bright.

    There wi mirrors wo about one of the lobe's normals.
    """
    alpha, wo = domain.alphas(rng, count), domain.directions(rng, count)
    m = domain.lobe_normals(rng, alpha)
    wi = 2.0 * (wo * m).sum(axis=0) * m - wo
    wi[2] = np.abs(wi[2]) + 1e-300
    return np.concatenate([wi, wo, alpha])


def _curves(rng: np.random.Generator, count: int) -> np.ndarray:
    return np.concatenate([domain.cosines(rng, count), rng.random((2, count))])


def _glossy(distribution: Distribution) -> Callable[[np.ndarray], np.ndarray]:
    return lambda a: MicrofacetReflection(a[3:6], a[6], a[7], distribution, "correlated", "visible").evaluate(a[:3])[0][
        0
    ]


def _rectangle(a: np.ndarray) -> np.ndarray:
    return SphericalRectangle(*a).solid_angle


def _sphere(a: np.ndarray) -> np.ndarray:
    """The sampler's own density, one light a point."""
    origin, up, hit = np.zeros((3, 1)), np.array([[0.0], [0.0], [1.0]]), np.ones(1)
    lights = (SphereSampler(SphereLight("sphere", tuple(column[:3]), column[3], _WHITE)) for column in a.T)
    return np.concatenate([light.pdf(origin, up, hit) for light in lights])


def _sun(a: np.ndarray) -> np.ndarray:
    up = np.array([[0.0], [0.0], [1.0]])
    lights = (SunSampler(SunLight("sun", (0.0, 0.0, 1.0), angle, _WHITE)) for angle in a[0])
    return np.concatenate([light.pdf(up, up, np.ones(1)) for light in lights])


def _spread(a: np.ndarray) -> np.ndarray:
    return np.concatenate([Spread(angle)(np.zeros(1)) for angle in a[0]])


def _of_direction(kernel: Callable[..., np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
    return lambda a: kernel(a[:3], a[3], a[4])


def _distribution(title: str, distribution: Distribution, name: str) -> list[Function]:
    entries = []
    kernels = distribution.density, distribution.smith_lambda
    for kernel, what, symbol, draw in zip(
        kernels, ("density", "lambda"), ("D", "Lambda"), (_normals, _slopes), strict=True
    ):
        entries.append(
            _entry(
                f"{title} {symbol}",
                (*_VECTOR, *_ALPHAS),
                draw,
                _of_direction(kernel),
                f"{name}_{what}",
                cycles_too=True,
            )
        )
    return entries


def _shaped(title: str, distribution: Distribution, truth: Truth) -> Function:
    """D of a distribution of one shape."""
    return Function(FAMILY, title, (*_VECTOR, *_ALPHAS), _normals, _of_direction(distribution.density), truth, BOUND)


def _entry(
    title: str,
    names: tuple[str, ...],
    draw: Draw,
    kernel: Callable[[np.ndarray], np.ndarray],
    form: str,
    cycles_too: bool = False,
    cycles: str = "",
) -> Function:
    """A function whose truth and float32 forms go by one name in their modules."""
    written = getattr(cycles_single, form) if cycles_too else getattr(single, cycles) if cycles else None
    return Function(
        FAMILY,
        title,
        names,
        draw,
        kernel,
        getattr(exact, form),
        BOUND,
        Single(getattr(single, form)),
        Single(written) if written else None,
    )


def closed_forms() -> list[Function]:
    """All of them, subject by subject."""
    return [*_microfacets(), *_fresnel(), *_densities(), *_lights()]


def _microfacets() -> list[Function]:
    """Distributions, masking, and the lobes made of them."""
    return [
        *_distribution("GGX", GGX(), "ggx"),
        *_distribution("Beckmann", Beckmann(), "beckmann"),
        *(_shaped(f"Student-t D, g = {g:g}", StudentT(g), exact.student_density(g)) for g in STUDENT_SHAPES),
        _shaped("shifted gamma D", ShiftedGamma(0.8, 0.01), exact.gamma_density(0.8, 0.01)),
        _shaped("exponential power D", ExponentialPower(0.5), exact.exponential_density(0.5)),
        Function(
            FAMILY,
            "Beckmann Lambda, rational",
            (*_VECTOR, *_ALPHAS),
            _slopes,
            _of_direction(smith_lambda_rational),
            exact.beckmann_lambda_rational,
            BOUND,
            cycles=Single(cycles_single.beckmann_lambda),
        ),
        _entry(
            "masking, Torrance-Sparrow",
            _THREE,
            _pairs,
            lambda a: masking.torrance_sparrow(a[:3], a[3:6], a[6:]),
            "torrance_sparrow",
        ),
        _entry("masking, separable", ("Lambda_i", "Lambda_o"), _lambdas, lambda a: masking.separable(*a), "separable"),
        _entry(
            "masking, height-correlated",
            ("Lambda_i", "Lambda_o"),
            _lambdas,
            lambda a: masking.height_correlated(*a),
            "height_correlated",
            cycles="height_correlated",
        ),
        Function(FAMILY, "GGX bound", (*_VECTOR, *_ALPHAS), _views, _of_direction(GGX().bound), exact.ggx_bound, BOUND),
        _entry("GGX lobe", (*_THREE[:6], *_ALPHAS), _lobes, _glossy(GGX()), "ggx_glossy", True),
        _entry("Beckmann lobe", (*_THREE[:6], *_ALPHAS), _lobes, _glossy(Beckmann()), "beckmann_glossy", True),
    ]


def _fresnel() -> list[Function]:
    return [
        _entry(
            "Fresnel, dielectric", ("cos", "eta"), dielectrics, lambda a: fresnel.dielectric(*a), "dielectric", True
        ),
        _entry("Fresnel, conductor", ("cos", "eta", "k"), _metals, lambda a: fresnel.conductor(*a), "conductor", True),
        _entry("Fresnel, Schlick", ("cos", "f0"), _f0, lambda a: fresnel.schlick(*a), "schlick", cycles="schlick"),
        Function(
            FAMILY,
            "Fresnel, F82",
            ("cos", "f0", "tint"),
            _curves,
            lambda a: F82(a[1], a[2])(a[0]),
            exact.f82,
            BOUND,
            cycles=Single(cycles_single.f82),
            slack=lambda a: 1.0 / np.maximum(a[2], 1e-300),
            excuse="a difference of two curves, of which the share tint is left near the cosine 1/7, as the paper prints it",
        ),
        _entry("Fresnel, Cook-Torrance", ("cos", "f0"), _f0, lambda a: fresnel.cook_torrance(*a), "cook_torrance"),
    ]


def _densities() -> list[Function]:
    """Densities of sampling, and how two of them are weighed."""
    return [
        _entry(
            "density of a visible normal",
            (*_THREE[6:], *_THREE[3:6], "D", "Lambda_o"),
            _visible,
            lambda a: densities.pdf_visible(a[:3], a[3:6], a[6], a[7]),
            "pdf_visible",
            cycles="pdf_visible",
        ),
        _entry(
            "Jacobian of reflection",
            _THREE[3:],
            _facing,
            lambda a: densities.reflection_jacobian(a[:3], a[3:]),
            "reflection_jacobian",
        ),
        _entry(
            "power heuristic",
            ("p", "q"),
            _heuristic,
            lambda a: power_heuristic(*a),
            "power_heuristic",
            cycles="power_heuristic",
        ),
    ]


def _lights() -> list[Function]:
    return [
        _entry(
            "solid angle, rectangle", ("x0", "x1", "y0", "y1", "height"), _rectangles, _rectangle, "rectangle", True
        ),
        _entry("density, sphere light", (*_VECTOR, "radius"), _spheres, _sphere, "sphere_density", True),
        _entry("density, sun", ("half angle",), _half_angles, _sun, "sun_density", True),
        _entry("spread of an area light", ("spread",), _spreads, _spread, "spread", True),
    ]
