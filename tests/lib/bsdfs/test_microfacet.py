# SPDX-License-Identifier: GPL-3.0-or-later
"""Glossy lobes: samples follow the density, weights are value over density.

Light may run both ways.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.microfacet import MicrofacetReflection
from etalon.lib.bsdfs.rotated import Rotated
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.ggx import GGX
from etalon.tests.chi2 import Reflections, Tangents, chi_square, integrals, sidak

STRATEGIES = ["visible", "bounded", "d_cos", "cosine", "uniform"]
MASKING = ["correlated", "separable", "torrance_sparrow"]
BOTH = pytest.mark.parametrize("distribution", [Beckmann(), GGX()], ids=["beckmann", "ggx"])
ROUGH = [(0.5, 0.5), (1.0, 1.0), (0.8, 0.3)]
NARROW = [(0.01, 0.01), (0.1, 0.1), (0.1, 0.03)]
COUNT = 50_000
# All chi-square tests of this file together refuse a right lobe once in a thousand.
LEVEL = sidak(1e-3, 2 * (5 * 3 * len(ROUGH) + 2 * len(NARROW) + 2))


def direction(degrees, azimuth=0.7):
    theta = np.radians(degrees)
    return np.array([np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)])


def lobe_for(wo, count, distribution, alphas, strategy="visible", masking="correlated"):
    return MicrofacetReflection(np.repeat(wo[:, None], count, axis=1), *alphas, distribution, masking, strategy)


def above(wi):
    """Directions below the horizon reflect nothing.

    They are samples lost, which the chi-square counts against the density's missing mass.
    """
    return np.where(wi[2] > 0.0, wi, np.nan)


@pytest.mark.grid(3)
@BOTH
@pytest.mark.parametrize("alphas", ROUGH)
@pytest.mark.parametrize("degrees", [0.0, 50.0, 80.0])
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_chi_square_rough(distribution, alphas, degrees, strategy, rng):
    """Over the hemisphere of wi, where the horizon is an edge of the chart."""
    wo = direction(degrees)
    wi, _, _ = lobe_for(wo, COUNT, distribution, alphas, strategy).sample(*rng.random((2, COUNT)))

    def density(w):
        return lobe_for(wo, w.shape[1], distribution, alphas, strategy).evaluate(w)[1]

    assert chi_square(above(wi), density, Tangents(1.0, 1.0)).p_value > LEVEL


@BOTH
@pytest.mark.parametrize("alphas", NARROW)
@pytest.mark.parametrize("strategy", ["visible", "d_cos"])
def test_chi_square_narrow(distribution, alphas, strategy, rng):
    """In the half vector's chart, which follows a lobe of any width.

    The densities are from the documents, so that the horizon, an edge in this chart, needs no care: samples below it
    follow the same density (and reflect nothing).
    """
    wo = direction(50.0)
    wi, weight, _ = lobe_for(wo, COUNT, distribution, alphas, strategy).sample(*rng.random((2, COUNT)))
    assert not weight[:, wi[2] < 0.0].any()

    def density(w):
        m = w + wo[:, None]
        m = m / np.sqrt((m * m).sum(axis=0)) * np.copysign(1.0, m[2])
        d = distribution.density(m, *alphas)
        if strategy == "d_cos":
            return d * m[2] / (4.0 * np.abs(wo @ m))
        g1 = 1.0 / (1.0 + distribution.smith_lambda(wo[:, None], *alphas))
        return np.where(wo @ m > 0.0, d * g1 / (4.0 * wo[2]), 0.0)

    assert chi_square(wi, density, Reflections(wo, Tangents(*alphas)), least_expected=8.0).p_value > LEVEL


@BOTH
@pytest.mark.parametrize("turn", [0.5, 2.5])
def test_chi_square_rotated(distribution, turn, rng):
    """An anisotropic lobe whose axis lies elsewhere: the same density, turned."""
    wo, cos, sin = direction(50.0), np.cos(turn), np.sin(turn)
    inner = np.array([wo[0] * cos + wo[1] * sin, wo[1] * cos - wo[0] * sin, wo[2]])

    def lobe(count):
        return Rotated(lobe_for(inner, count, distribution, (0.8, 0.3)), np.full(count, cos), np.full(count, sin))

    wi, weight, pdf = lobe(COUNT).sample(*rng.random((2, COUNT)))
    assert chi_square(above(wi), lambda w: lobe(w.shape[1]).evaluate(w)[1], Tangents(1.0, 1.0)).p_value > LEVEL
    # The axis itself, from outside: the mean of wi lies where the mirror direction is pulled to by the wider axis.
    value, density = lobe(COUNT).evaluate(wi)
    lit = wi[2] > 0.0
    np.testing.assert_allclose(density[lit], pdf[lit], rtol=1e-8)
    np.testing.assert_allclose(value[:, lit], (weight * pdf)[:, lit], rtol=1e-8)


def test_rotated_turns_the_right_way():
    """alpha_x is along the axis (cos, sin, 0).

    Seen from above, light at a slope along that axis is stronger than across it.
    """
    wo = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 1.0]])
    turn = np.full(2, 0.6)
    lobe = Rotated(MicrofacetReflection(wo, 0.5, 0.1, GGX(), "correlated", "visible"), np.cos(turn), np.sin(turn))
    along = np.array([np.cos(0.6) * 0.5, np.sin(0.6) * 0.5, np.sqrt(0.75)])
    across = np.array([-np.sin(0.6) * 0.5, np.cos(0.6) * 0.5, np.sqrt(0.75)])
    value, _ = lobe.evaluate(np.stack([along, across], axis=1))
    assert (value[:, 0] > 5.0 * value[:, 1]).all()


@BOTH
@pytest.mark.parametrize("masking", MASKING)
@pytest.mark.parametrize("strategy", STRATEGIES)
@pytest.mark.parametrize("alphas", [(0.5, 0.5), (0.8, 0.2), (0.02, 0.02)])
def test_weight_is_value_over_density(distribution, masking, strategy, alphas, rng):
    wo = np.abs(rng.normal(size=(3, 5000)))
    wo /= np.sqrt((wo * wo).sum(axis=0))
    lobe = MicrofacetReflection(wo, *alphas, distribution, masking, strategy)
    wi, weight, pdf = lobe.sample(*rng.random((2, 5000)))
    np.testing.assert_allclose((wi * wi).sum(axis=0), 1.0, rtol=1e-12)
    lit = wi[2] > 0.0
    assert lit.any()
    assert np.all(weight[:, ~lit] == 0.0)
    value, density = lobe.evaluate(wi)
    # The half vector of wi is known to some 1e-16 / alpha of its slope.
    np.testing.assert_allclose(density[lit], pdf[lit], rtol=1e-9 / min(alphas) ** 2)
    np.testing.assert_allclose(value[:, lit], (weight * pdf)[:, lit], rtol=1e-9 / min(alphas) ** 2)


@BOTH
@pytest.mark.parametrize("masking", MASKING)
@pytest.mark.parametrize("alphas", [(0.01, 0.01), (0.4, 0.4), (1.0, 1.0), (1.0, 0.05)])
def test_reciprocity(distribution, masking, alphas, rng):
    """f(wi, wo) = f(wo, wi), Helmholtz."""
    pair = rng.normal(size=(2, 3, 4000))
    pair[:, 2] = np.abs(pair[:, 2])
    wi, wo = pair / np.sqrt((pair * pair).sum(axis=1, keepdims=True))
    there = MicrofacetReflection(wo, *alphas, distribution, masking, "visible").evaluate(wi)[0] / wi[2]
    back = MicrofacetReflection(wi, *alphas, distribution, masking, "visible").evaluate(wo)[0] / wo[2]
    np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-250)


@BOTH
@pytest.mark.parametrize("masking", ["correlated", "separable"])
@pytest.mark.parametrize("alphas", [(0.01, 0.01), (0.4, 0.4), (1.0, 1.0), (1.0, 0.05)])
def test_no_weight_above_one(distribution, masking, alphas, rng):
    """Visible normals: G2 / G1 <= 1, also at grazing views."""
    for degrees in (0.0, 60.0, 89.0, 89.999):
        wi, weight, _ = lobe_for(direction(degrees), 4000, distribution, alphas, masking=masking).sample(
            *rng.random((2, 4000))
        )
        assert weight.max() <= 1.0 + 1e-9
        assert weight.min() >= 0.0
        assert np.isfinite(wi).all()


@pytest.mark.parametrize("alphas", [(0.5, 0.5), (1.0, 1.0), (1.0, 0.3)])
def test_the_bound_saves_reflections(alphas, rng):
    """Bounded normals never lose more reflections to the horizon than visible ones.

    Seen from above, far fewer.
    """
    lost = {}
    for degrees in (0.0, 50.0, 85.0):
        for strategy in ("visible", "bounded"):
            wi = lobe_for(direction(degrees), COUNT, GGX(), alphas, strategy).sample(*rng.random((2, COUNT)))[0]
            lost[strategy] = (wi[2] < 0.0).mean()
        assert lost["bounded"] <= lost["visible"] + 4.0 * np.sqrt(lost["visible"] / COUNT)
        if degrees == 0.0 and alphas == (0.5, 0.5):
            assert lost["bounded"] < 0.5 * lost["visible"]


@BOTH
def test_nothing_below_the_surface(distribution, rng):
    wi = rng.normal(size=(3, 1000))
    wi[2] = -np.abs(wi[2])
    wi /= np.sqrt((wi * wi).sum(axis=0))
    for strategy in STRATEGIES:
        value, pdf = lobe_for(direction(40.0), 1000, distribution, (0.5, 0.5), strategy).evaluate(wi)
        assert not value.any()
        assert not pdf.any()
        # Nor anything for a viewer behind the shading normal.
        wo = direction(100.0)
        value, pdf = lobe_for(wo, 1000, distribution, (0.5, 0.5), strategy).evaluate(-wi)
        assert not value.any()
        weight = lobe_for(wo, 1000, distribution, (0.5, 0.5), strategy).sample(*rng.random((2, 1000)))[1]
        assert not weight.any()


@BOTH
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_frozen_arguments_and_parts(distribution, strategy, rng):
    """No kernel writes into what it was given; a part is the same lobe at fewer points."""
    wo = np.repeat(direction(30.0)[:, None], 64, axis=1)
    alpha_x, alpha_y, u1, u2 = rng.uniform(0.1, 0.9, (4, 64))
    for argument in (wo, alpha_x, alpha_y, u1, u2):
        argument.flags.writeable = False
    lobe = MicrofacetReflection(wo, alpha_x, alpha_y, distribution, "correlated", strategy)
    wi, weight, pdf = lobe.sample(u1, u2)
    wi.flags.writeable = False
    value, density = lobe.evaluate(wi)
    index = np.array([5, 2, 60])
    some = lobe.part(index)
    np.testing.assert_allclose(some.evaluate(wi[:, index])[0], value[:, index], rtol=1e-12)
    np.testing.assert_allclose(some.evaluate(wi[:, index])[1], density[index], rtol=1e-12)
    for a, b in zip(some.sample(u1[index], u2[index]), (wi, weight, pdf), strict=True):
        np.testing.assert_allclose(a, b[..., index], rtol=1e-12)


@BOTH
@pytest.mark.parametrize("alpha", [0.2, 0.7])
def test_densities_of_the_plain_strategies(distribution, alpha, rng):
    """uniform: 1 / (2 pi). cosine: cos / pi.

    D cos: D(m) m_z / (4 wo.m), D from the papers, for all lit directions.
    """
    wi, wo = rng.normal(size=(2, 3, 200))
    wi, wo = (v / np.sqrt((v * v).sum(axis=0)) for v in (wi, wo))
    wi[2], wo[2] = np.abs(wi[2]), np.abs(wo[2])
    m = (wi + wo) / np.sqrt(((wi + wo) ** 2).sum(axis=0))
    tan2 = (m[0] ** 2 + m[1] ** 2) / m[2] ** 2
    if isinstance(distribution, GGX):  # Walter et al. 2007, eq. 33
        d = alpha**2 / (np.pi * m[2] ** 4 * (alpha**2 + tan2) ** 2)
    else:  # eq. 25
        d = np.exp(-tan2 / alpha**2) / (np.pi * alpha**2 * m[2] ** 4)
    expected = {
        "uniform": np.full(200, 0.5 / np.pi),
        "cosine": wi[2] / np.pi,
        "d_cos": d * m[2] / (4.0 * (wo * m).sum(axis=0)),
    }
    for strategy, density in expected.items():
        lobe = MicrofacetReflection(wo, alpha, alpha, distribution, "correlated", strategy)
        np.testing.assert_allclose(lobe.evaluate(wi)[1], density, rtol=1e-9)
        assert not lobe.evaluate(-wi)[1].any()


@BOTH
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_densities_are_per_steradian(distribution, strategy):
    """Over all directions a density is at most 1.

    Those below the horizon, which D cos and visible normals lose, are included; hemispheres have 1.
    """
    wo = direction(0.0)

    def density(wi):
        return lobe_for(wo, wi.shape[1], distribution, (0.1, 0.1), strategy).evaluate(wi)[1]

    chart = Tangents(1.0, 1.0) if strategy in ("cosine", "uniform") else Reflections(wo, Tangents(0.1, 0.1))
    total = integrals(density, chart, (16, 24), tolerance=1e-5).sum()
    # GGX of alpha 0.1 has 1 / (1 + 1 / alpha^2) of its facets, 0.0099, steeper than 45 degrees, Beckmann e^-100.
    lost = 0.0 if strategy in ("cosine", "uniform", "bounded") or isinstance(distribution, Beckmann) else 0.01 / 1.01
    assert total == pytest.approx(1.0 - lost, abs=2e-3)
