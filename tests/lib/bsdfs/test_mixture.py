# SPDX-License-Identifier: GPL-3.0-or-later
"""Several lobes at one point.

The one-sample model is unbiased, and its density is that of its samples.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.ashikhmin_shirley import AshikhminShirley
from etalon.lib.bsdfs.dielectric import Interface, RoughDielectric
from etalon.lib.bsdfs.fresnels import Dielectric
from etalon.lib.bsdfs.lambert import Lambert, LambertTransmission
from etalon.lib.bsdfs.microfacet import MicrofacetReflection
from etalon.lib.bsdfs.mixture import Mixture
from etalon.lib.bsdfs.specular import Mirror
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.sampling.warps import uniform_sphere
from etalon.tests.chi2 import Tangents, chi_square, integrals
from scipy import stats

LEVEL = 1e-4
COUNT = 100_000
COLORS = [np.array([[0.3], [0.2], [0.1]]), np.array([[0.1], [0.6], [0.5]]), np.array([[0.2], [0.2], [0.4]])]
WO = np.array([0.5, 0.3, np.sqrt(1.0 - 0.34)])


def mixture(count, mirror=False, colors=COLORS):
    wo = np.repeat(WO[:, None], count, axis=1)
    lobes = [
        Lambert(),
        MicrofacetReflection(wo, 0.4, 0.4, GGX(), "correlated", "visible"),
        MicrofacetReflection(wo, 0.7, 0.3, Beckmann(), "separable", "d_cos"),
    ]
    return Mixture([*lobes, Mirror(wo)] if mirror else lobes, [*colors, np.full((3, 1), 0.25)][: 3 + mirror], count)


def above(wi):
    return np.where(wi[2] > 0.0, wi, np.nan)


def test_chi_square(rng):
    wi, weight, pdf = mixture(COUNT).sample(*rng.random((3, COUNT)))
    assert chi_square(above(wi), lambda w: mixture(w.shape[1]).evaluate(w)[1], Tangents(1.0, 1.0)).p_value > LEVEL
    lit = wi[2] > 0.0
    value, density = mixture(COUNT).evaluate(wi)
    np.testing.assert_allclose(density[lit], pdf[lit], rtol=1e-9)
    np.testing.assert_allclose(value[:, lit], (weight * pdf)[:, lit], rtol=1e-9)


def test_value_is_the_coloured_sum(rng):
    wi, _, _ = mixture(1000).sample(*rng.random((3, 1000)))
    wi = wi[:, wi[2] > 0.0]
    count = wi.shape[1]
    wo = np.repeat(WO[:, None], count, axis=1)
    total = COLORS[0] * wi[2] / np.pi
    total = total + COLORS[1] * MicrofacetReflection(wo, 0.4, 0.4, GGX(), "correlated", "visible").evaluate(wi)[0]
    total = total + COLORS[2] * MicrofacetReflection(wo, 0.7, 0.3, Beckmann(), "separable", "visible").evaluate(wi)[0]
    np.testing.assert_allclose(mixture(count).evaluate(wi)[0], total, rtol=1e-12)


def test_mean_weight_is_the_albedo(rng):
    """With a delta among the lobes, the mean weight has two parts.

    They are the integral of the rest and the mirror's colour.
    """
    _, weight, pdf = mixture(COUNT, mirror=True).sample(*rng.random((3, COUNT)))
    share = 0.25 / sum(color.mean() for color in [*COLORS, np.full((3, 1), 0.25)])
    assert stats.binomtest(int(np.isinf(pdf).sum()), COUNT, share).pvalue > LEVEL
    for k in range(3):
        exact = (
            integrals(lambda w, k=k: mixture(w.shape[1]).evaluate(w)[0][k], Tangents(1.0, 1.0), (12, 16)).sum() + 0.25
        )
        error = stats.sem(weight[k])
        assert error < 0.004 * exact
        assert abs(weight[k].mean() - exact) < stats.norm.isf(0.5 * LEVEL / 3) * error


def beside_transmission(kind, count):
    """A rough lobe and one that sends light through the surface, seen from WO."""
    wo, white = np.repeat(WO[:, None], count, axis=1), np.ones((3, 1))
    if kind == "glossy":
        rough = MicrofacetReflection(wo, 1.0, 1.0, GGX(), "correlated", "visible")
    elif kind == "d_cos":
        rough = MicrofacetReflection(wo, 0.7, 0.7, Beckmann(), "correlated", "d_cos")
    elif kind == "ashikhmin_shirley":
        rough = AshikhminShirley(wo, 0.9, 0.9)
    else:
        eta = np.full(count, 1.5)
        rough = RoughDielectric(wo, 1.0, 1.0, eta, GGX(), Interface(Dielectric(eta), white, white))
    return Mixture([rough, LambertTransmission()], [0.5 * white, 0.4 * white], count)


@pytest.mark.parametrize("kind", ["glossy", "d_cos", "ashikhmin_shirley", "glass"])
def test_a_direction_that_its_lobe_rejects_is_not_the_other_lobes(kind, rng):
    """Reflection may end below the surface.

    The mean weight is still the integral of both lobes over the sphere.
    """
    wi, weight, _ = beside_transmission(kind, COUNT).sample(*rng.random((3, COUNT)))
    sphere = uniform_sphere(*rng.random((2, 4 * COUNT)))
    value = 4.0 * np.pi * beside_transmission(kind, 4 * COUNT).evaluate(sphere)[0][0]
    for sampled, exact in ((weight[0], value), (weight[0] * (wi[2] < 0.0), value * (sphere[2] < 0.0))):
        error = np.hypot(stats.sem(sampled), stats.sem(exact))
        assert error < 0.006 * exact.mean()
        assert abs(sampled.mean() - exact.mean()) < stats.norm.isf(0.5 * LEVEL / 8) * error


def test_colours_that_vary_over_the_points(rng):
    """(3, n) colours: each point picks by its own shares."""
    colors = [rng.random((3, COUNT)) * 0.6, COLORS[1], COLORS[2]]
    wi, weight, pdf = mixture(COUNT, colors=colors).sample(*rng.random((3, COUNT)))
    value, density = mixture(COUNT, colors=colors).evaluate(wi)
    lit = wi[2] > 0.0
    np.testing.assert_allclose(density[lit], pdf[lit], rtol=1e-9)
    np.testing.assert_allclose(value[:, lit], (weight * pdf)[:, lit], rtol=1e-9)


def test_black_lobes_do_no_harm(rng):
    """All colours zero: nothing is divided by zero, and nothing is reflected."""
    black = mixture(50, colors=[np.zeros((3, 1))] * 3)
    wi, weight, _ = black.sample(*rng.random((3, 50)))
    assert not weight.any()
    assert not black.evaluate(wi)[0].any()


def test_frozen_arguments(rng):
    colors = [color.copy() for color in COLORS]
    u = rng.random((3, 200))
    for argument in (*colors, u):
        argument.flags.writeable = False
    wi, _, _ = mixture(200, mirror=True, colors=colors).sample(*u)
    wi.flags.writeable = False
    mixture(200, mirror=True, colors=colors).evaluate(wi)
