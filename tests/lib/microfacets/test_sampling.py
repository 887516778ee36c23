# SPDX-License-Identifier: GPL-3.0-or-later
"""The samplers against the densities they claim (chi-square).

Also the documents' inversions, and Beckmann's visible slopes.
"""

from functools import partial

import mpmath as mp
import numpy as np
import pytest
from etalon.lib.microfacets import densities, masking, visible_slope
from etalon.lib.microfacets.beckmann import Beckmann, smith_lambda_rational
from etalon.lib.microfacets.ggx import GGX
from etalon.tests.chi2 import Tangents, chi_square, sidak
from scipy.special import erf, erfc

BOTH = pytest.mark.parametrize("distribution", [Beckmann(), GGX()], ids=["beckmann", "ggx"])
ALPHAS = [(1e-4, 1e-4), (0.3, 0.3), (1.0, 1.0), (1.0, 0.05)]
ANGLES = [0.0, 40.0, 80.0, 89.9]
COUNT = 100_000
# All the chi-square tests of this file together fail a right sampler once in a thousand runs of new seeds.
LEVEL = sidak(1e-3, 2 * len(ALPHAS) * (1 + len(ANGLES)))


def observer(degrees, count):
    theta = np.radians(degrees)
    wo = np.array([np.sin(theta) * np.cos(0.6), np.sin(theta) * np.sin(0.6), np.cos(theta)])
    return np.repeat(wo[:, None], count, axis=1)


def d_cos(distribution, alpha_x, alpha_y, m):
    return densities.pdf_d_cos(m, distribution.density(m, alpha_x, alpha_y))


def visible(distribution, alpha_x, alpha_y, degrees, m):
    wo = observer(degrees, m.shape[1])
    lambda_o = distribution.smith_lambda(wo, alpha_x, alpha_y)
    return densities.pdf_visible(m, wo, distribution.density(m, alpha_x, alpha_y), lambda_o)


@BOTH
@pytest.mark.parametrize(("alpha_x", "alpha_y"), ALPHAS)
def test_d_cos_chi_square(distribution, alpha_x, alpha_y, rng):
    m = distribution.sample_d_cos(alpha_x, alpha_y, *rng.random((2, COUNT)))
    result = chi_square(m, partial(d_cos, distribution, alpha_x, alpha_y), Tangents(alpha_x, alpha_y))
    assert result.p_value > LEVEL, result


@pytest.mark.grid(3)
@BOTH
@pytest.mark.parametrize(("alpha_x", "alpha_y"), ALPHAS)
@pytest.mark.parametrize("degrees", ANGLES)
def test_visible_chi_square(distribution, alpha_x, alpha_y, degrees, rng):
    m = distribution.sample_visible(observer(degrees, COUNT), alpha_x, alpha_y, *rng.random((2, COUNT)))
    density = partial(visible, distribution, alpha_x, alpha_y, degrees)
    result = chi_square(m, density, Tangents(alpha_x, alpha_y))
    assert result.p_value > LEVEL, result


@BOTH
def test_chi_square_sees_planted_errors(distribution, rng):
    """Each planted error is seen.

    They are 5 % more roughness, a factor 1.02, G1 left out, axes changed, the wrong sampler, and samples thrown away.
    """
    u = rng.random((2, COUNT))
    chart = Tangents(0.3, 0.1)
    m = distribution.sample_visible(observer(70.0, COUNT), 0.3, 0.1, *u)
    right = partial(visible, distribution, 0.3, 0.1, 70.0)
    g1 = 1.0 / (1.0 + distribution.smith_lambda(observer(70.0, 1), 0.3, 0.1)[0])
    assert g1 < 0.999
    errors = {
        "rougher": (m, partial(visible, distribution, 0.315, 0.105, 70.0)),
        "factor": (m, lambda m: 1.02 * right(m)),
        "no G1": (m, lambda m: right(m) / g1),
        "axes": (m, partial(visible, distribution, 0.1, 0.3, 70.0)),
        "D cos": (distribution.sample_d_cos(0.3, 0.1, *u), right),
        "lost": (np.where(rng.random(COUNT) < 0.005, np.nan, m), right),
        "2 % shift": (distribution.sample_visible(observer(70.0, COUNT), 0.3, 0.1, 0.98 * u[0], u[1]), right),
    }
    assert chi_square(m, right, chart).p_value > LEVEL
    missed = [
        name for name, (samples, density) in errors.items() if chi_square(samples, density, chart).p_value > LEVEL
    ]
    assert not missed


@BOTH
@pytest.mark.parametrize(("alpha_x", "alpha_y"), [*ALPHAS, (1e-6, 1.0)])
def test_visible_weights_stay_below_one(distribution, alpha_x, alpha_y, rng):
    """The weight of a visible normal is G2 / G1, whatever the distribution's tail does."""
    for degrees in (0.0, 60.0, 89.0, 89.9999):
        wo = observer(degrees, 4000)
        m = distribution.sample_visible(wo, alpha_x, alpha_y, *rng.random((2, 4000)))
        assert np.isfinite(m).all()
        assert (m[2] > 0.0).all()
        np.testing.assert_allclose((m * m).sum(axis=0), 1.0, rtol=1e-14)
        assert ((wo * m).sum(axis=0) > -1e-9).all()
        wi = 2.0 * (wo * m).sum(axis=0) * m - wo
        lambda_i, lambda_o = (distribution.smith_lambda(w, alpha_x, alpha_y) for w in (wi, wo))
        for form in (masking.separable, masking.height_correlated):
            weight = form(lambda_i, lambda_o) * (1.0 + lambda_o)
            assert weight.max() <= 1.0 + 1e-12
            assert (weight[wi[2] <= 0.0] < 1e-60).all()


def test_the_documents_angles(rng):
    """Beckmann: theta = atan(sqrt(-sigma^2 log(1 - xi2))).

    GGX: theta = atan(sigma sqrt(xi2 / (1 - xi2))); phi = 2 pi xi1.
    """
    u1, u2 = rng.random((2, 1000))
    for distribution, tangent in (
        (Beckmann(), np.sqrt(-(0.3**2) * np.log(1.0 - u2))),
        (GGX(), 0.3 * np.sqrt(u2 / (1.0 - u2))),
    ):
        m = distribution.sample_d_cos(0.3, 0.3, u1, u2)
        np.testing.assert_allclose(np.hypot(m[0], m[1]) / m[2], tangent, rtol=1e-9)
        np.testing.assert_allclose(np.arctan2(m[1], m[0]) / (2.0 * np.pi) % 1.0, u1, atol=1e-12)


def mass_above(x, sine, cosine):
    """The share of visible normals with a tangent above x, in floating point.

    Exact to some 1e-15.
    """
    cot = cosine / sine
    whole = cosine * np.sqrt(np.pi) * (1.0 + erf(cot)) + sine * np.exp(-(np.minimum(cot, 30.0) ** 2))
    return (cosine * np.sqrt(np.pi) * erfc(x) + sine * np.exp(-x * x)) / whole


def slope_cases(rng, count):
    """Views evenly in angle, in cotangent and at both ends.

    u evenly and, by its logit, at both ends.
    """
    third = count // 3
    cot = np.concatenate(
        [
            1.0 / np.tan(rng.uniform(1e-6, 0.5 * np.pi, count - 2 * third)),
            10.0 ** rng.uniform(-9.0, 1.0, third),
            1.0 / rng.random(third) - 1.0,
        ]
    )
    logit = rng.uniform(-36.0, 36.0, count)
    u = np.where(rng.random(count) < 0.5, rng.random(count), 1.0 / (1.0 + np.exp(-logit)))
    return 1.0 / np.sqrt(1.0 + cot * cot), cot / np.sqrt(1.0 + cot * cot), np.clip(u, 2.0**-54, 1.0 - 2.0**-53)


def visible_tangent(sine, cosine, u):
    view = np.stack([sine, np.zeros_like(sine), cosine])
    return visible_slope.visible_tangent(sine, cosine, u, Beckmann().smith_lambda(view, 1.0, 1.0))


def test_visible_slope_inverts_its_distribution(rng):
    sine, cosine, u = slope_cases(rng, 300_000)
    x = visible_tangent(sine, cosine, u)
    error = np.abs(mass_above(x, sine, cosine) - (1.0 - u))
    worst = error.argmax()
    assert error[worst] < 4e-15, (error[worst], sine[worst], cosine[worst], u[worst])


def test_visible_slope_to_fifty_digits(rng):
    sine, cosine, u = slope_cases(rng, 300)
    x = visible_tangent(sine, cosine, u)
    with mp.workdps(50):
        for case in zip(x, sine, cosine, u, strict=True):
            t, s, c, level = (mp.mpf(float(value)) for value in case)
            cot = c / s

            def above(t, s=s, c=c):
                return c * mp.sqrt(mp.pi) * mp.erfc(t) + s * mp.exp(-t * t)

            assert abs(above(t) / above(-cot) - (1 - level)) < 4e-15, case


def test_visible_slope_grows_with_u():
    """Neighbouring uniforms stay neighbours: what low-discrepancy points need."""
    u = np.linspace(0.0, 1.0, 20_001)
    for theta in np.radians([1e-7, 1.0, 30.0, 75.0, 89.0, 89.9999, 90.0]):
        x = visible_tangent(np.full_like(u, np.sin(theta)), np.full_like(u, max(np.cos(theta), 1e-70)), u)
        assert (np.diff(x) > -1e-9).all()


def test_visible_slope_at_its_closed_forms():
    """Grazing: x = sqrt(-log(1 - u)). Normal incidence: erf(x) = 2 u - 1."""
    u = np.linspace(0.001, 0.999, 777)
    one = np.ones_like(u)
    np.testing.assert_allclose(visible_tangent(one, 1e-70 * one, u), np.sqrt(-np.log1p(-u)), rtol=1e-9)
    np.testing.assert_allclose(erf(visible_tangent(1e-150 * one, one, u)), 2.0 * u - 1.0, atol=2e-12)


@BOTH
def test_no_kernel_writes_into_its_arguments(distribution, rng):
    """Frozen arguments: a kernel that wrote into one would raise."""
    u1, u2 = rng.random((2, 64))
    wo = observer(30.0, 64).copy()
    m = distribution.sample_d_cos(0.5, 0.2, u1, u2)
    wi = 2.0 * (wo * m).sum(axis=0) * m - wo
    d = distribution.density(m, 0.5, 0.2)
    lambda_i, lambda_o = distribution.smith_lambda(wi, 0.5, 0.2), distribution.smith_lambda(wo, 0.5, 0.2)
    alpha_x, alpha_y = np.full(64, 0.5), np.full(64, 0.2)
    for argument in (u1, u2, wo, m, wi, d, lambda_i, lambda_o, alpha_x, alpha_y):
        argument.flags.writeable = False
    distribution.density(m, alpha_x, alpha_y)
    distribution.smith_lambda(wo, alpha_x, alpha_y)
    smith_lambda_rational(wo, alpha_x, alpha_y)
    distribution.sample_d_cos(alpha_x, alpha_y, u1, u2)
    distribution.sample_visible(wo, alpha_x, alpha_y, u1, u2)
    densities.pdf_d_cos(m, d)
    densities.pdf_visible(m, wo, d, lambda_o)
    densities.reflection_jacobian(wo, m)
    masking.torrance_sparrow(wi, wo, m)
    masking.separable(lambda_i, lambda_o)
    masking.height_correlated(lambda_i, lambda_o)
