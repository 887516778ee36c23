# SPDX-License-Identifier: GPL-3.0-or-later
"""Where microfacet renderers have failed: the distributions, their sampling, Fresnel.

A NumPy warning is an error here: no kernel may pass through 0/0 or an overflow on its way to a right answer.
"""

import mpmath as mp
import numpy as np
import pytest
from etalon.lib.microfacets import densities, fresnel, masking
from etalon.lib.microfacets.beckmann import Beckmann, smith_lambda_rational
from etalon.lib.microfacets.ggx import GGX
from scipy.special import ndtr

BOTH = pytest.mark.parametrize("distribution", [Beckmann(), GGX()], ids=["beckmann", "ggx"])
EDGES = np.array([0.0, 5e-324, 1e-300, 2.0**-53, 1e-9, 0.5, 1.0 - 1e-9, 1.0 - 2.0**-53, 1.0])


def from_tangents(x, y):
    m = np.stack([x, y, np.ones_like(x)])
    return m / np.sqrt((m * m).sum(axis=0))


def observer(theta, phi=0.3, count=1):
    return np.repeat([[np.sin(theta) * np.cos(phi)], [np.sin(theta) * np.sin(phi)], [np.cos(theta)]], count, axis=1)


@pytest.mark.parametrize("alpha", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_ggx_of_a_narrow_lobe(alpha):
    """From the cosine alone 1 + (alpha^2 - 1) cos^2 cancels.

    At alpha 1e-6 nothing is left of it.
    """
    tangent = alpha * np.array([0.1, 1.0, 3.0, 10.0])
    m = from_tangents(tangent, np.zeros(4))
    value = GGX().density(m, alpha, alpha)
    with mp.workdps(50):
        exact = [
            1 / (mp.pi * mp.mpf(alpha) ** 2 * ((mp.mpf(float(x)) / mp.mpf(alpha)) ** 2 + mp.mpf(float(z)) ** 2) ** 2)
            for x, _, z in m.T
        ]
        error = [abs(float(v / e - 1)) for v, e in zip(value, exact, strict=True)]
    assert max(error) < 1e-14
    if alpha <= 1e-4:
        from_cosine = alpha**2 / (np.pi * (1.0 + (alpha**2 - 1.0) * m[2] ** 2) ** 2)
        assert max(abs(float(v / e - 1)) for v, e in zip(from_cosine, exact, strict=True)) > 1e-9


@BOTH
def test_cosine_above_one_by_rounding(distribution):
    up = np.array([[0.0], [0.0], [1.0 + 4e-16]])
    assert distribution.density(up, 0.5, 0.5) == pytest.approx(1.0 / (np.pi * 0.25), rel=1e-14)
    assert distribution.smith_lambda(up, 0.5, 0.5) == 0.0
    assert np.isfinite(distribution.sample_visible(np.repeat(up, EDGES.size, axis=1), 0.5, 0.5, EDGES, EDGES)).all()
    for value in (
        fresnel.dielectric(up[2], 1.5),
        fresnel.dielectric(up[2], 0.5),
        fresnel.conductor(up[2], 0.2, 3.0),
        fresnel.schlick(up[2], 0.04),
    ):
        assert 0.0 <= value <= 1.0


@BOTH
@pytest.mark.parametrize("alpha", [1e-6, 1e-3, 1.0])
def test_normals_at_the_horizon(distribution, alpha):
    """tan^2 is infinite and cos^4 zero.

    Beckmann's D is 0 there, GGX's alpha^2 / pi, and neither passes through 0/0.
    """
    z = np.array([0.0, 5e-324, 1e-300, 1e-150, 1e-40, 1e-9])
    m = np.stack([np.sqrt(1.0 - z * z), np.zeros(6), z])
    d = distribution.density(m, alpha, alpha)
    assert d[0] == 0.0
    expected = 0.0 if isinstance(distribution, Beckmann) else alpha**2 / np.pi
    np.testing.assert_allclose(d[1:], expected, rtol=1e-5)
    value = distribution.smith_lambda(m, alpha, alpha)
    assert np.isfinite(value).all()
    assert (np.diff(value) <= 0.0).all()
    wi = m[:, ::-1].copy()
    for g in (
        masking.torrance_sparrow(wi, m, m),
        masking.separable(value, value),
        masking.height_correlated(value, value),
    ):
        assert ((g >= 0.0) & (g <= 1.0)).all()
    assert np.isfinite(densities.reflection_jacobian(m, wi)).all()
    assert np.isfinite(densities.pdf_visible(m, wi, d, value)).all()


@BOTH
@pytest.mark.parametrize(("alpha_x", "alpha_y"), [(1e-6, 1.0), (1.0, 1e-6), (1e-6, 1e-6)])
def test_one_axis_without_roughness(distribution, alpha_x, alpha_y, rng):
    """Normalised per axis.

    With its own alpha each tangent of D cos has its one-dimensional distribution.
    """
    u1, u2 = rng.random((2, 40_000))
    m = distribution.sample_d_cos(alpha_x, alpha_y, u1, u2)
    for axis, alpha in enumerate((alpha_x, alpha_y)):
        tangent = m[axis] / m[2] / alpha
        rank = (
            ndtr(tangent * np.sqrt(2.0))
            if isinstance(distribution, Beckmann)
            else 0.5 + 0.5 * tangent / np.sqrt(1.0 + tangent**2)
        )
        # Kolmogorov's bound at a level of 1e-4: 2.23 / sqrt(n)
        distance = np.abs(np.sort(rank) - (np.arange(40_000) + 0.5) / 40_000).max()
        assert distance < 2.23 / np.sqrt(40_000)
    assert np.isfinite(distribution.density(m, alpha_x, alpha_y)).all()
    wo = observer(1.2, 0.8, 40_000)
    m = distribution.sample_visible(wo, alpha_x, alpha_y, u1, u2)
    assert np.isfinite(distribution.density(m, alpha_x, alpha_y)).all()
    assert (m[2] > 0.0).all()


@BOTH
@pytest.mark.parametrize("alpha", [1e-6, 0.05, 1.0])
@pytest.mark.parametrize("theta", [0.0, 1e-300, 1e-160, 1e-12, 0.7, np.radians(89.9999), 0.5 * np.pi - 1e-15])
def test_visible_normals_at_every_end(distribution, alpha, theta):
    """Normal incidence, where no azimuth exists, and grazing incidence.

    Both ends of both uniforms are included, and 1 itself.
    """
    u1, u2 = (grid.ravel() for grid in np.meshgrid(EDGES, EDGES))
    wo = observer(theta, 0.3, u1.size)
    m = distribution.sample_visible(wo, alpha, alpha, u1, u2)
    np.testing.assert_allclose((m * m).sum(axis=0), 1.0, rtol=1e-13)
    assert (m[2] > 0.0).all()
    assert ((wo * m).sum(axis=0) >= -1e-8).all()
    m = distribution.sample_d_cos(alpha, alpha, u1, u2)
    np.testing.assert_allclose((m * m).sum(axis=0), 1.0, rtol=1e-13)
    assert (m[2] > 0.0).all()


def test_visible_normals_at_normal_incidence_fill_the_circle(rng):
    """Without an azimuth the samplers choose one, which must not show.

    The mean tangent is zero and both axes spread alike.
    """
    u1, u2 = rng.random((2, 200_000))
    wo = observer(0.0, 0.0, u1.size)
    m = Beckmann().sample_visible(wo, 0.3, 0.3, u1, u2)
    x, y = m[0] / m[2] / 0.3, m[1] / m[2] / 0.3
    # the variance of a tangent is 1/2, of its square 1/2: five standard errors
    bound = 5.0 * np.sqrt(0.5 / u1.size)
    for mean in (x.mean(), y.mean(), (x * x).mean() - 0.5, (y * y).mean() - 0.5, (x * y).mean()):
        assert abs(mean) < bound


def test_beckmann_visible_normals_from_below():
    """A wo that should not have come.

    It gives some valid normal and no warning; masking gives it weight 0.
    """
    wo = np.array([[0.6, 0.0, 1.0], [0.0, 0.0, 0.0], [-0.8, -1.0, 0.0]])
    u = np.array([0.2, 0.5, 0.9])
    for distribution in (Beckmann(), GGX()):
        m = distribution.sample_visible(wo, 0.3, 0.3, u, u)
        assert np.isfinite(m).all()
        lambda_o = distribution.smith_lambda(wo, 0.3, 0.3)
        assert (densities.pdf_visible(m, wo, distribution.density(m, 0.3, 0.3), lambda_o) < 1e-20).all()


def test_rational_lambda_is_not_the_exact_one():
    """0.31 % in 1 + Lambda, and a jump where the fit ends.

    It is a departure to be named, not used in silence.
    """
    a = 1.0 / np.sqrt(np.array([0.39 * (1.0 - 1e-9), 0.39 * (1.0 + 1e-9)]))
    w = from_tangents(1.0 / a, np.zeros(2))
    outside, inside = smith_lambda_rational(w, 1.0, 1.0)
    assert outside == 0.0
    assert abs(inside) > 1e-5
    exact = Beckmann().smith_lambda(w, 1.0, 1.0)
    assert abs(np.diff(exact)[0]) < 1e-9
    assert exact[0] > 1e-3


def test_fresnel_where_roots_vanish():
    """Index 1 is no interface, and beyond the critical angle reflection is total.

    No root is taken of a tiny negative number.
    """
    cosines = np.concatenate([[0.0, 5e-324, 1e-300, 1e-160], np.geomspace(1e-80, 1.0, 200)])
    assert not fresnel.dielectric(cosines, 1.0).any()
    # eta = 0.6: the critical cosine is 0.8
    around = 0.8 + np.arange(-20, 21) * 2.0**-53
    value = fresnel.dielectric(around, 0.6)
    assert ((value > 0.9999) & (value <= 1.0)).all()
    for eta, k in [(1.0, 0.0), (1.0, 1e-300), (1e-12, 5.0), (0.6, 0.0), (1.0, 1.0), (40.0, 40.0)]:
        value = fresnel.conductor(np.concatenate([cosines, around]), eta, k)
        assert ((value >= 0.0) & (value <= 1.0 + 4e-16)).all()


def test_small_uniforms_do_not_cancel():
    """log(1 - xi) loses a xi below 1e-16 and half the digits of 1e-8.

    log1p does not, and xi = 1 - 2^-53 stays finite.
    """
    u = np.array([1e-300, 1e-20, 1e-8, 1.0 - 2.0**-53])
    m = Beckmann().sample_d_cos(0.5, 0.5, np.full(4, 0.25), u)
    tangent = np.hypot(m[0], m[1]) / m[2]
    with mp.workdps(50):
        exact = [float(mp.sqrt(-mp.log1p(-mp.mpf(float(x)))) / 2) for x in u]
    np.testing.assert_allclose(tangent, exact, rtol=1e-14)
