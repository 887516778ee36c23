# SPDX-License-Identifier: GPL-3.0-or-later
"""Rough interfaces: sampling against its density, and weights against values.

Also energy, reciprocity, and the smooth limit.
"""

import itertools
from dataclasses import dataclass

import numpy as np
import pytest
from etalon.lib.bsdfs.dielectric import Interface, RoughDielectric
from etalon.lib.bsdfs.fresnels import Dielectric
from etalon.lib.bsdfs.specular import refract
from etalon.lib.microfacets import fresnel
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.ggx import GGX
from etalon.tests.chi2 import Sphere, Tangents, chi_square, integrals, sidak

CASES = [
    (distribution, eta, alpha, cos_o)
    for distribution in (GGX(), Beckmann())
    for eta in (1.5, 1.0 / 1.5)
    for alpha, cos_o in ((0.3, 0.9), (0.6, 0.5), (1.0, 0.25), ((0.2, 0.8), 0.5), ((0.9, 0.3), 0.25))
]
WHITE = np.ones((3, 1))


@dataclass(frozen=True)
class Banded(Sphere):
    """The sphere with a bin's edge at the horizon, and one where GGX ends.

    Facets seen edge-on refract to i.n = -o.n / eta.
    """

    end: float

    @property
    def _knots(self):
        return np.array([0.0, 0.5, 0.6875, 1.0]), np.array([1.0, 0.0, max(self.end, -0.999), -1.0])

    def directions(self, p, q):
        return super().directions(0.5 - 0.5 * np.interp(p, *self._knots), q)

    def solid_angle(self, p, q):
        knots, z = self._knots
        return 2.0 * np.pi * (-np.diff(z) / np.diff(knots))[np.searchsorted(knots[1:-1], p)]

    def coordinates(self, directions):
        p, z = self._knots
        return np.interp(-directions[2], -z, p), super().coordinates(directions)[1]


def viewer(cos_o, count=1):
    return np.repeat(
        np.array([[np.sqrt(1.0 - cos_o**2) * 0.6], [np.sqrt(1.0 - cos_o**2) * 0.8], [cos_o]]), count, axis=1
    )


def lobe(distribution, eta, alpha, wo, glass=True, form="correlated"):
    """Alpha is a number, or a pair along x and y."""
    interface = Interface(Dielectric(np.float64(eta)) if glass else None, WHITE, WHITE)
    return RoughDielectric(wo, *np.broadcast_to(np.float64(alpha), 2), np.float64(eta), distribution, interface, form)


def density(distribution, eta, alpha, cos_o, glass=True):
    return lambda wi: lobe(distribution, eta, alpha, viewer(cos_o, wi.shape[1]), glass).evaluate(wi)[1]


@pytest.mark.grid(3)
@pytest.mark.parametrize("glass", [True, False])
@pytest.mark.parametrize(("distribution", "eta", "alpha", "cos_o"), CASES)
def test_directions_follow_their_density(distribution, eta, alpha, cos_o, glass, rng):
    count = 200_000
    wi, weight, _ = lobe(distribution, eta, alpha, viewer(cos_o, count), glass).sample(*rng.random((2, count)))
    kept = wi[:, weight[0] > 0.0]
    # What is sampled and weighs nothing (below the horizon, totally reflected) is the density's missing mass.
    samples = np.concatenate([kept, np.full((3, count - kept.shape[1]), np.nan)], axis=1)
    result = chi_square(
        samples, density(distribution, eta, alpha, cos_o, glass), Banded(-cos_o / eta), (16, 12), tolerance=2e-5
    )
    assert result.p_value > sidak(1e-3, 2 * len(CASES))


@pytest.mark.parametrize("glass", [True, False])
@pytest.mark.parametrize(("distribution", "eta", "alpha", "cos_o"), CASES)
def test_weight_times_density_is_the_value(distribution, eta, alpha, cos_o, glass, rng):
    made = lobe(distribution, eta, alpha, viewer(cos_o, 4000), glass)
    wi, weight, pdf = made.sample(*rng.random((2, 4000)))
    kept = weight[0] > 0.0
    value, density_there = made.evaluate(wi)
    np.testing.assert_allclose(pdf[kept], density_there[kept], rtol=1e-6)
    np.testing.assert_allclose((weight * pdf)[:, kept], value[:, kept], rtol=1e-6)


@pytest.mark.parametrize("form", ["correlated", "separable", "torrance_sparrow"])
@pytest.mark.parametrize("distribution", [GGX(), Beckmann()], ids=["ggx", "beckmann"])
def test_forms_of_masking(distribution, form, rng):
    """Value and weight carry the chosen G: against D and F, and Lambda, put together by hand."""
    alpha, eta, wo = 0.5, 1.5, viewer(0.4, 4000)
    made = lobe(distribution, eta, alpha, wo, form=form)
    wi, weight, pdf = made.sample(*rng.random((2, 4000)))
    value = made.evaluate(wi)[0]
    kept = weight[0] > 0.0
    np.testing.assert_allclose((weight * pdf)[:, kept], value[:, kept], rtol=1e-6)
    through = wi[2] < 0.0
    assert min((kept & through).sum(), (kept & ~through).sum()) > 100
    smith = lobe(distribution, eta, alpha, wo).evaluate(wi)[0][0]
    upright = wi * np.array([[1.0], [1.0], [0.0]]) + np.array([[0.0], [0.0], [1.0]]) * np.abs(wi[2])
    here, there = (distribution.smith_lambda(w, alpha, alpha) for w in (wo, upright))
    expected = smith.copy()
    if form == "separable":
        expected *= (1.0 + here + there) / ((1.0 + here) * (1.0 + there))
    elif form == "torrance_sparrow":
        m = wi + wo
        m /= np.sqrt((m * m).sum(axis=0))
        cos = (m * wo).sum(axis=0)
        g = np.minimum(1.0, 2.0 * m[2] * np.minimum(wo[2], wi[2]) / cos)
        reflected = fresnel.dielectric(cos, eta) * distribution.density(m, alpha, alpha) * g / (4.0 * wo[2])
        expected = np.where(through, smith, reflected)
    np.testing.assert_allclose(value[0, kept], expected[kept], rtol=1e-9)


@pytest.mark.parametrize("distribution", [GGX(), Beckmann()], ids=["ggx", "beckmann"])
@pytest.mark.parametrize("eta", [1.5, 1.0 / 1.5])
@pytest.mark.parametrize("alpha", [0.5, (0.2, 0.9)])
def test_exchange_of_light_and_viewer(distribution, eta, alpha, rng):
    """f(i, o) / eta^2 = f(o, i) across the interface.

    On one side f(i, o) = f(o, i) (Walter et al. 2007, sec. 5.3).
    """
    direction = rng.normal(size=(2, 3, 5000))
    wo, wi = direction / np.sqrt((direction**2).sum(axis=1, keepdims=True))
    wo[2] = np.abs(wo[2])
    wi[:, ::2] -= 0.9 * (wi + wo)[:, ::2]  # half of them near straight on, where refraction is
    wi /= np.sqrt((wi**2).sum(axis=0))
    through = wi[2] < 0.0
    forth = lobe(distribution, eta, alpha, wo).evaluate(wi)[0][0] / np.abs(wi[2])
    upright = np.stack([np.ones_like(wi[2]), np.ones_like(wi[2]), np.where(through, -1.0, 1.0)])
    back = np.empty_like(forth)
    for side, eta_there in ((through, 1.0 / eta), (~through, eta)):
        swapped = lobe(distribution, eta_there, alpha, (wi * upright)[:, side])
        back[side] = swapped.evaluate((wo * upright)[:, side])[0][0] / wo[2, side]
    assert (forth[through] > 0.0).sum() > 500
    np.testing.assert_allclose(forth, back * np.where(through, eta**2, 1.0), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("distribution", [GGX(), Beckmann()], ids=["ggx", "beckmann"])
def test_no_energy_from_nowhere(distribution):
    """Reflected and refracted light together never exceed what arrives.

    No light passes facets seen from behind.
    """
    for eta, alpha, cos_o in itertools.product(
        (1.2, 1.5, 2.4, 1.0 / 1.2, 1.0 / 1.5), (0.5, 1.0, (0.3, 1.0)), (0.1, 0.6, 0.99)
    ):

        def value(wi, eta=eta, alpha=alpha, cos_o=cos_o):
            return lobe(distribution, eta, alpha, viewer(cos_o, wi.shape[1])).evaluate(wi)[0][0]

        assert integrals(value, Banded(-cos_o / eta), (16, 12), tolerance=5e-3).sum() < 1.0
    behind = np.array([[0.95], [0.0], [-np.sqrt(1.0 - 0.95**2)]])  # refraction into 1.5 bends by at most 48 degrees
    assert lobe(distribution, 1.5, 1.0, np.array([[0.0], [0.0], [1.0]])).evaluate(behind)[0].max() == 0.0


@pytest.mark.parametrize("eta", [1.5, 1.0 / 1.5])
def test_smooth_limit_is_snell_and_fresnel(eta, rng):
    """At a tiny alpha the directions are the mirror's and Snell's, with Fresnel's shares."""
    wo = viewer(0.8, 100_000)
    wi, weight, _ = lobe(GGX(), eta, 1e-4, wo).sample(*rng.random((2, wo.shape[1])))
    through = wi[2] < 0.0
    refracted, _ = refract(wo[:, :1], np.float64(eta))
    mirrored = wo[:, :1] * np.array([[-1.0], [-1.0], [1.0]])
    assert np.median(np.abs(wi - np.where(through, refracted, mirrored)).max(axis=0)) < 1e-3
    np.testing.assert_allclose(np.median(weight), 1.0, atol=1e-3)
    reflectance = float(fresnel.dielectric(np.array([0.8]), eta)[0])
    spread = np.sqrt(reflectance * (1.0 - reflectance) / wo.shape[1])
    assert abs((~through).mean() - reflectance) < 4.5 * spread


STRETCHED = [(0.2, 0.8), (0.9, 0.3), (1.0, 0.05)]


def given_by_facets(alpha, eta, wo):
    """What an interface gives back, over its facets.

    D G1 (o.m) / (o.n) dm, each share times G2 / G1 of where its ray leaves.
    """

    def value(m):
        here = np.repeat(wo, m.shape[1], axis=1)
        cos = (here * m).sum(axis=0)
        share = fresnel.dielectric(np.clip(cos, 0.0, 1.0), eta)
        sine2 = (1.0 - cos * cos) / eta**2
        bent = m * (cos / eta - np.sqrt(np.maximum(1.0 - sine2, 0.0))) - here / eta
        kept = np.zeros_like(cos)
        lambda_o = GGX().smith_lambda(wo, *alpha)
        for wi, part, side in (
            (2.0 * cos * m - here, share, 1.0),
            (bent, np.where(sine2 < 1.0, 1.0 - share, 0.0), -1.0),
        ):
            upright = np.stack([wi[0], wi[1], side * wi[2]])
            kept += part * np.where(upright[2] > 0.0, 1.0 / (1.0 + lambda_o + GGX().smith_lambda(upright, *alpha)), 0.0)
        return GGX().density(m, *alpha) * np.where(cos > 0.0, cos, 0.0) / wo[2] * kept

    return integrals(value, Tangents(*alpha), (12, 12), tolerance=1e-5).sum()


@pytest.mark.parametrize("alpha", STRETCHED[:2])
@pytest.mark.parametrize("eta", [1.5, 1.0 / 1.5])
def test_stretched_glass_gives_back_what_its_facets_do(alpha, eta):
    """A white furnace: value over all directions against the integral over facets.

    The latter has no Jacobian.
    """
    wo = viewer(0.6)

    def value(wi):
        return lobe(GGX(), eta, alpha, np.repeat(wo, wi.shape[1], axis=1)).evaluate(wi)[0][0]

    expected = given_by_facets(alpha, eta, wo)
    assert 0.5 < expected < 1.0
    assert integrals(value, Banded(-0.6 / eta), (16, 12), tolerance=1e-4).sum() == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("distribution", [GGX(), Beckmann()], ids=["ggx", "beckmann"])
def test_stretching_the_other_axis_turns_the_lobe(distribution, rng):
    """Alphas swapped and all turned by a quarter: the same; the alphas swapped alone: not."""
    wo, wi = viewer(0.5, 2000), rng.normal(size=(3, 2000))
    wi /= np.sqrt((wi**2).sum(axis=0))
    turned = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    plain = lobe(distribution, 1.5, (0.2, 0.7), wo).evaluate(wi)[0]
    np.testing.assert_allclose(lobe(distribution, 1.5, (0.7, 0.2), turned @ wo).evaluate(turned @ wi)[0], plain, 1e-9)
    assert np.abs(lobe(distribution, 1.5, (0.7, 0.2), wo).evaluate(wi)[0] - plain).max() > 0.1 * plain.max()


@pytest.mark.parametrize("distribution", [GGX(), Beckmann()], ids=["ggx", "beckmann"])
@pytest.mark.parametrize("alpha", [(1e-4, 1.0), (1.0, 1e-4), (1.5e-5, 1.5e-5)])
@pytest.mark.parametrize("cos_o", [1.0, 0.5, 1e-3])
def test_an_axis_that_is_hardly_rough(distribution, alpha, cos_o, rng):
    """Weights stay finite and at most 1.

    Weight times density is the value, as far as the direction's own digits carry.
    """
    made = lobe(distribution, 1.5, alpha, viewer(cos_o, 4000))
    wi, weight, pdf = made.sample(*rng.random((2, 4000)))
    assert np.isfinite(wi).all()
    assert np.isfinite(weight).all()
    assert weight.max() < 1.0 + 1e-9
    kept = (weight[0] > 0.0) & np.isfinite(pdf)
    assert kept.mean() > 0.3
    np.testing.assert_allclose(made.evaluate(wi)[0][0, kept], (weight[0] * pdf)[kept], rtol=1e-4)
