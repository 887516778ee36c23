# SPDX-License-Identifier: GPL-3.0-or-later
"""Lambert and Oren-Nayar: densities and reciprocity.

Also where the energy of each bounce goes.
"""

import itertools

import numpy as np
import pytest
from etalon.lib.bsdfs.lambert import Lambert
from etalon.lib.bsdfs.oren_nayar import OrenNayar
from etalon.tests.chi2 import Tangents, chi_square
from scipy.special import roots_legendre

LEVEL = 1e-4
ROUGHNESS = [0.05, 0.3, 1.0]


def view(cos, count):
    return np.repeat(np.array([[np.sqrt(1.0 - cos * cos)], [0.0], [cos]]), count, axis=1)


def hemisphere(nodes=160):
    """Directions (3, k) and weights (k,) over the upper hemisphere.

    Gauss-Legendre in theta and phi.
    """
    x, w = roots_legendre(nodes)
    theta, phi = 0.25 * np.pi * (x + 1.0), np.pi * (x + 1.0)
    theta, phi = (g.ravel() for g in np.meshgrid(theta, phi, indexing="ij"))
    weight = np.outer(w, w).ravel() * 0.25 * np.pi * np.pi * np.sin(theta)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]), weight


def albedo(lobe_of, cos, nodes=160):
    """Directional albedo by quadrature, (3,)."""
    wi, weight = hemisphere(nodes)
    return lobe_of(view(cos, wi.shape[1])).evaluate(wi)[0] @ weight


def single_albedo(cos, roughness, nodes=160):
    """E of Fujii's single scattering alone, f = A + B t.

    Written from the paper (Portsmouth et al. 2024, eq. 8 to 11).
    """
    wi, weight = hemisphere(nodes)
    wo = view(cos, 1)
    a = 1.0 / (np.pi + roughness * (np.pi / 2.0 - 2.0 / 3.0))
    s = (wi * wo).sum(axis=0) - wi[2] * cos
    t = np.where(s > 0.0, s / np.maximum(wi[2], cos), s)
    return ((a + a * roughness * t) * wi[2]) @ weight


def test_lambert_chi_square(rng):
    wi, weight, pdf = Lambert().sample(*rng.random((2, 100_000)))
    assert np.all(weight == 1.0)
    assert chi_square(wi, lambda w: Lambert().evaluate(w)[1], Tangents(1.0, 1.0)).p_value > LEVEL
    np.testing.assert_allclose(Lambert().evaluate(wi)[1], pdf, rtol=1e-14)
    assert not Lambert().evaluate(-wi)[0].any()


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_oren_nayar_chi_square(roughness, rng):
    lobe = OrenNayar(view(0.3, 100_000), roughness, np.full((3, 1), 0.5))
    wi, weight, pdf = lobe.sample(*rng.random((2, 100_000)))
    value, density = lobe.evaluate(wi)
    np.testing.assert_allclose(weight * pdf, value, rtol=1e-12)
    np.testing.assert_allclose(density, pdf, rtol=1e-12)
    at = lambda w: OrenNayar(view(0.3, w.shape[1]), roughness, np.full((3, 1), 0.5)).evaluate(w)[1]  # noqa: E731
    assert chi_square(wi, at, Tangents(1.0, 1.0)).p_value > LEVEL


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_oren_nayar_reciprocity(roughness, rng):
    pair = rng.normal(size=(2, 3, 2000))
    pair[:, 2] = np.abs(pair[:, 2])
    wi, wo = pair / np.sqrt((pair * pair).sum(axis=1, keepdims=True))
    color = np.array([[0.9], [0.5], [0.1]])
    there = OrenNayar(wo, roughness, color).evaluate(wi)[0] / wi[2]
    back = OrenNayar(wi, roughness, color).evaluate(wo)[0] / wo[2]
    np.testing.assert_allclose(there, back, rtol=1e-10)


@pytest.mark.parametrize("roughness", ROUGHNESS)
@pytest.mark.parametrize("cos", [0.02, 0.3, 0.8, 1.0])
def test_oren_nayar_white_furnace(roughness, cos):
    """White surfaces lose nothing, whatever their roughness."""
    total = albedo(lambda wo: OrenNayar(wo, roughness, np.ones((3, 1))), cos)
    np.testing.assert_allclose(total, 1.0, atol=2e-4)  # t has a kink where the planes of wi and wo are at right angles


@pytest.mark.parametrize("roughness", ROUGHNESS)
@pytest.mark.parametrize("cos", [0.1, 0.5, 0.9])
def test_oren_nayar_colour_by_order_of_bounce(roughness, cos):
    """Each reflection inside the surface multiplies by its colour once.

    Light scattered k times carries colour^k. Of white light, E(wo) leaves after one scattering. The rest, 1 - E(wo),
    is scattered again, and each time a mean share Eavg leaves: order k >= 2 holds (1 - E(wo)) Eavg (1 - Eavg)^(k -
    2), which sums to 1 with the first, the white furnace. With colour c the albedo is therefore c E + (1 - E) sum
    over k >= 2 of c^k Eavg (1 - Eavg)^(k - 2): the first term of the multiple scattering is c^2. Cycles multiplies
    its c^2 by the closure's weight, c, once more, so that its twice scattered light carries c^3: energy that no
    bounce has taken.
    """
    single = single_albedo(cos, roughness)
    node, weight = roots_legendre(24)
    mu = 0.5 * (node + 1.0)
    average = (np.array([single_albedo(m, roughness, 96) for m in mu]) * mu) @ weight
    color = np.array([[0.9], [0.5], [0.1]])
    order = np.arange(2, 400)
    series = (color**order * average * (1.0 - average) ** (order - 2)).sum(axis=1)
    exact = color[:, 0] * single + (1.0 - single) * series
    found = albedo(lambda wo: OrenNayar(wo, roughness, color), cos)
    np.testing.assert_allclose(found, exact, rtol=3e-4)
    by_cycles = color[:, 0] * single + (1.0 - single) * series * color[:, 0]
    if roughness == 1.0:  # the two are told apart: by up to 2 % where the colour is neither 0 nor 1
        assert np.abs(by_cycles / exact - 1.0).max() > 30.0 * np.abs(found / exact - 1.0).max()


def test_oren_nayar_without_roughness_is_lambert(rng):
    wi, wo = (v / np.sqrt((v * v).sum(axis=0)) for v in np.abs(rng.normal(size=(2, 3, 500))))
    color = np.array([[0.9], [0.5], [0.1]])
    value = OrenNayar(wo, 1e-9, color).evaluate(wi)[0]
    np.testing.assert_allclose(value, color * wi[2] / np.pi, rtol=1e-6)


def test_oren_nayar_keeps_its_arguments(rng):
    wo, color, roughness = view(0.5, 20), rng.random((3, 20)), rng.random(20)
    for argument in (wo, color, roughness):
        argument.flags.writeable = False
    lobe = OrenNayar(wo, roughness, color)
    wi, weight, _ = lobe.sample(*rng.random((2, 20)))
    wi.flags.writeable = False
    value, _ = lobe.evaluate(wi)
    some = lobe.part(np.array([3, 7]))
    np.testing.assert_allclose(some.evaluate(wi[:, [3, 7]])[0], value[:, [3, 7]], rtol=1e-13)
    assert np.isfinite(weight).all()


def single_scattering(wi, wo, roughness):
    """f of light that was scattered once, (n,).

    It is what is left of f / colour for a colour near black.
    """
    color = np.full((3, 1), 1e-9)
    return OrenNayar(wo, roughness, color).evaluate(wi)[0][0] / (1e-9 * wi[2])


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_oren_nayar_scatters_all_light_once_at_grazing(roughness):
    """Fujii's constant pi / 2 - 2 / 3 makes a white surface's albedo 1 at grazing views.

    This holds for every roughness; elsewhere the albedo is less.
    """
    wi, weight = hemisphere(400)
    found = [(single_scattering(wi, view(cos, 1), roughness) * wi[2]) @ weight for cos in (1e-7, 0.2, 0.6, 1.0)]
    assert found[0] == pytest.approx(1.0, abs=2e-4)
    assert all(a > b for a, b in itertools.pairwise(found))


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_oren_nayar_shines_back_to_the_light_by_its_roughness(roughness):
    """f(n, w) = A for every w (Fujii 2012 for s > 0).

    Towards the light itself f = A (1 + roughness sin^2 / cos).
    """
    angle = np.radians([20.0, 50.0, 75.0])
    w = np.stack([np.sin(angle), np.zeros(3), np.cos(angle)])
    level = single_scattering(w, view(1.0, 3), roughness)
    np.testing.assert_allclose(level, level[0], rtol=2e-9)  # the near black has other orders, too
    back = single_scattering(w, w, roughness)
    np.testing.assert_allclose((back / level - 1.0) * np.cos(angle) / np.sin(angle) ** 2, roughness, rtol=1e-6)


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_oren_nayar_keeps_no_less_and_no_more_than_white(roughness):
    """The mean albedo of all directions is its integral: white loses nothing.

    By it the lost light is given back (the constant 5.6).
    """
    node, weight = roots_legendre(24)
    mu = 0.5 * (node + 1.0)
    total = [albedo(lambda wo: OrenNayar(wo, roughness, np.ones((3, 1))), m, 200)[0] for m in mu]
    assert (weight * mu) @ np.array(total) == pytest.approx(1.0, abs=2e-5)
