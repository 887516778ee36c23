# SPDX-License-Identifier: GPL-3.0-or-later
"""Identities that hold for any numbers.

They are normalisations, furnaces, reciprocity, bounds on weights, and the limit of the mirror.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator

import numpy as np
from scipy.special import roots_legendre

from ..bsdfs.microfacet import MicrofacetReflection
from ..microfacets import densities
from ..microfacets.albedo import integrate_albedo
from ..microfacets.beckmann import Beckmann
from ..microfacets.distribution import Distribution
from ..microfacets.ggx import GGX
from . import domain
from .case import Case

FAMILY = "identity"
DISTRIBUTIONS = {"GGX": GGX(), "Beckmann": Beckmann()}
ENERGY = 1e-9
_AXES = ((1e-6, 1e-6), (1e-4, 1e-4), (0.01, 0.01), (0.3, 0.3), (1.0, 1.0), (1e-6, 1.0), (1.0, 1e-6), (0.5, 0.05))
_VIEWS = np.radians([0.0, 30.0, 60.0, 80.0, 89.0, 89.9, 89.99])
_SPECULAR = 1.5e-5  # just above the product of alphas at which a lobe becomes a mirror


def identities() -> list[Case]:
    """All of them; some seconds."""
    cases = []
    for name, distribution in DISTRIBUTIONS.items():
        cases += [
            _worst(f"integral of D cos, {name}", _normalisation(distribution), 1e-12),
            _worst(f"visible normals integrate to 1, {name}", _weak_furnace(distribution), 1e-10),
            _worst(f"reciprocity, {name}", _reciprocity(distribution), 2e-14),
            _worst(f"energy above 1 in a white furnace, {name}", _excess(distribution), ENERGY),
            _worst(f"weight of visible normals above 1, {name}", _visible_weights(distribution), ENERGY),
            _worst(
                f"weight of D cos over its bound 2 (o.m / o.n)^2, {name}",
                _d_cos_weights(distribution),
                1.0 + ENERGY,
                "ratio",
            ),
            _worst(f"from alpha {_SPECULAR:g} to the mirror, {name}", _into_the_mirror(distribution), 20.0 * _SPECULAR),
        ]
    return [*cases, _worst("white furnace against quadrature, GGX", _furnace(), 2e-5)]


Found = Iterator[tuple[float, str]]


def _worst(name: str, found: Found, bound: float, unit: str = "absolute") -> Case:
    values = list(found)
    worst, where = max(values)
    return Case(FAMILY, name, float(worst), bound, unit, where, points=len(values))


def _at(theta: float, count: int, phi: float = 0.7) -> np.ndarray:
    """One direction, `count` times."""
    one = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    return np.repeat(one[:, None], count, axis=1)


def _normals(alpha_x: float, alpha_y: float, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    m = np.stack([alpha_x * x, alpha_y * y, np.ones_like(x)])
    return m / np.sqrt((m * m).sum(axis=0))


def _normalisation(distribution: Distribution) -> Found:
    node, weight = roots_legendre(300)
    p = 0.5 + 0.5 * node
    r, weight = p / (1.0 - p), 0.5 * weight / (1.0 - p) ** 2
    phi = 2.0 * np.pi * (np.arange(64) + 0.5) / 64
    rr, pp = (grid.ravel() for grid in np.meshgrid(r, phi, indexing="ij"))
    for alpha_x, alpha_y in _AXES:
        m = _normals(alpha_x, alpha_y, rr * np.cos(pp), rr * np.sin(pp))
        density = densities.pdf_d_cos(m, distribution.density(m, alpha_x, alpha_y))
        integrand = density * m[2] ** 3 * (alpha_x * alpha_y) * rr * (2.0 * np.pi / 64)
        total = (integrand.reshape(300, 64).sum(axis=1) * weight).sum()
        yield abs(total - 1.0), f"alpha {alpha_x:g} x {alpha_y:g}"


def _interval(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    node, weight = roots_legendre(80)
    return 0.5 * (low + high) + 0.5 * (high - low) * node, 0.5 * (high - low) * weight


def _weak_furnace(distribution: Distribution) -> Found:
    for alpha_x, alpha_y in _AXES:
        for theta in _VIEWS:
            wo = _at(theta, 1)[:, 0]
            sine = float(np.hypot(alpha_x * wo[0], alpha_y * wo[1]))
            toward = np.array([alpha_x * wo[0], alpha_y * wo[1]]) / sine if sine > 0.0 else np.array([1.0, 0.0])
            x, y, weight = _slopes_seen(distribution, float(np.arctan2(-wo[2], sine)))
            m = _normals(alpha_x, alpha_y, toward[0] * x - toward[1] * y, toward[1] * x + toward[0] * y)
            views = _at(theta, x.size)
            d, smith = distribution.density(m, alpha_x, alpha_y), distribution.smith_lambda(views, alpha_x, alpha_y)
            total = (densities.pdf_visible(m, views, d, smith) * m[2] ** 3 * (alpha_x * alpha_y) * weight).sum()
            yield abs(total - 1.0), f"alpha {alpha_x:g} x {alpha_y:g}, {np.degrees(theta):g} degrees"


def _slopes_seen(distribution: Distribution, begin: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stretched slopes along and across the view, and their weights, from where wo.m is zero."""
    if isinstance(distribution, GGX):  # x = tan(angle), y = sqrt(1 + x^2) tan(angle): what is left is smooth
        angle, weight_x = _interval(begin, 0.5 * np.pi)
        x, weight_x = np.tan(angle), weight_x / np.cos(angle) ** 2
        angle, weight_y = _interval(-0.5 * np.pi, 0.5 * np.pi)
        widen = np.sqrt(1.0 + x * x)[:, None]
        y, weight_y = widen * np.tan(angle), widen * (weight_y / np.cos(angle) ** 2)
    else:
        x, weight_x = _interval(max(float(np.tan(begin)), -9.0), 9.0)
        y, weight_y = (np.tile(row, (x.size, 1)) for row in _interval(-9.0, 9.0))
    return np.repeat(x, y.shape[1]), y.ravel(), (weight_x[:, None] * weight_y).ravel()


def _reciprocity(distribution: Distribution) -> Found:
    rng = np.random.default_rng(zlib.crc32(b"reciprocity"))
    alpha, wo = domain.alphas(rng, 4000), domain.directions(rng, 4000)
    alpha_x, alpha_y = alpha
    m = domain.lobe_normals(rng, alpha)
    wi = 2.0 * (wo * m).sum(axis=0) * m - wo
    wi /= np.sqrt((wi * wi).sum(axis=0))
    wi[2] = np.abs(wi[2])
    for form in ("correlated", "separable"):
        there = MicrofacetReflection(wo, alpha_x, alpha_y, distribution, form, "visible").evaluate(wi)[0][0] / wi[2]
        back = MicrofacetReflection(wi, alpha_x, alpha_y, distribution, form, "visible").evaluate(wo)[0][0] / wo[2]
        shines = np.maximum(there, back) > 1e-280
        error = np.where(shines, np.abs(there - back) / np.where(shines, np.maximum(there, back), 1.0), 0.0)
        k = int(np.argmax(error))
        yield (
            float(error[k]),
            f"{form}, alpha {alpha[0, k]:.3g} x {alpha[1, k]:.3g}, wi.z {wi[2, k]:.3g}, wo.z {wo[2, k]:.3g}",
        )


def _square(side: int) -> tuple[np.ndarray, np.ndarray]:
    """The middles of side x side cells of the unit square."""
    middles = (np.arange(side) + 0.5) / side
    u1, u2 = np.meshgrid(middles, middles)
    return u1.ravel(), u2.ravel()


def _weights(
    distribution: Distribution, strategy: str, form: str = "correlated"
) -> Iterator[tuple[float, float, float, tuple]]:
    """Yield samples over the unit square, for every alpha and view.

    Each is alpha_x, alpha_y, theta and the sample (wi, weight, pdf).
    """
    u1, u2 = _square(160)
    for alpha_x, alpha_y in (*_AXES[1:5], (1.0, 0.05)):
        for theta in _VIEWS:
            alphas = np.asarray(alpha_x), np.asarray(alpha_y)
            lobe = MicrofacetReflection(_at(theta, u1.size), *alphas, distribution, form, strategy)
            wi, weight, pdf = lobe.sample(u1, u2)
            yield alpha_x, alpha_y, theta, (wi, weight[0], pdf)


def _excess(distribution: Distribution) -> Found:
    for form in ("correlated", "separable"):
        for alpha_x, alpha_y, theta, (_, weight, _) in _weights(distribution, "visible", form):
            where = f"{form}, alpha {alpha_x:g} x {alpha_y:g}, {np.degrees(theta):g} degrees"
            yield max(float(weight.mean()) - 1.0, 0.0), where


def _visible_weights(distribution: Distribution) -> Found:
    for form in ("correlated", "separable"):
        for alpha_x, alpha_y, theta, (_, weight, _) in _weights(distribution, "visible", form):
            where = f"{form}, alpha {alpha_x:g} x {alpha_y:g}, {np.degrees(theta):g} degrees"
            yield max(float(weight.max()) - 1.0, 0.0), where


def _d_cos_weights(distribution: Distribution) -> Found:
    """The largest weight of D cos sampling over its bound.

    wi lies above the horizon where m.n > o.n / (2 o.m). There (o.m) / ((o.n) (m.n)) < 2 (o.m / o.n)^2: this bound is
    not a constant.
    """
    for alpha_x, alpha_y, theta, (wi, weight, _) in _weights(distribution, "d_cos"):
        wo = _at(theta, wi.shape[1])
        half = wi + wo
        cos_om = (wo * half).sum(axis=0) / np.sqrt((half * half).sum(axis=0))
        ratio = weight / (2.0 * (cos_om / wo[2]) ** 2)
        where = (
            f"alpha {alpha_x:g} x {alpha_y:g}, {np.degrees(theta):g} degrees; the largest weight is {weight.max():.3g}"
        )
        yield float(ratio.max()), where


def _into_the_mirror(distribution: Distribution) -> Found:
    """The mean reflected direction of the narrowest lobe against the mirror's."""
    u1, u2 = _square(200)
    for theta in _VIEWS[:-1]:
        wo = _at(theta, u1.size)
        alpha = np.asarray(_SPECULAR)
        lobe = MicrofacetReflection(wo, alpha, alpha, distribution, "correlated", "visible")
        wi, weight, _ = lobe.sample(u1, u2)
        mirrored = wo[:, 0] * np.array([-1.0, -1.0, 1.0])
        yield float(np.abs((wi * weight).mean(axis=1) - mirrored).max()), f"{np.degrees(theta):g} degrees"


def _furnace() -> Found:
    """The mean of a sampler's weights over the unit square against the directional albedo.

    Places crowd where the tail of D lies.
    """
    u1, v = _square(700)
    u2, crowd = 1.0 - (1.0 - v) ** 3, 3.0 * (1.0 - v) ** 2
    for alpha in (0.05, 0.3, 1.0):
        for theta in np.radians([0.0, 45.0, 80.0, 89.0]):
            alphas = np.asarray(alpha), np.asarray(alpha)
            lobe = MicrofacetReflection(_at(theta, u1.size), *alphas, GGX(), "correlated", "visible")
            exact = integrate_albedo(np.array([np.cos(theta)]), np.array([alpha]), 60, 40)[0]
            error = abs(float((lobe.sample(u1, u2)[1][0] * crowd).mean()) - exact)
            yield error, f"alpha {alpha:g}, {np.degrees(theta):g} degrees"
