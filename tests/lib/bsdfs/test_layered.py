# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers over a white diffuse base in a white furnace.

Nothing is lost or gained between them. Also albedos and means of Fresnel curves.
"""

import mpmath
import numpy as np
import pytest
from etalon.lib.bsdfs.dielectric import Interface, RoughDielectric
from etalon.lib.bsdfs.fresnels import F82, Conductor, Dielectric, tinted_dielectric
from etalon.lib.bsdfs.layered import beneath_layer, coat_tint
from etalon.lib.microfacets import layers
from etalon.lib.microfacets.albedo import directional_albedo
from etalon.lib.microfacets.fresnel import dielectric
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.scene.expressions import ONE, WHITE, Constant
from etalon.lib.scene.layers import BeneathLayer
from etalon.lib.scene.materials import Diffuse, Material, Specular, WeightedClosure
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import fan, fan_camera, scene
from scipy.integrate import quad

ANGLES = np.radians([0.0, 35.0, 60.0, 75.0, 85.0])


def layered(ior, roughness, weight, distribution="MULTI_GGX", tint=WHITE):
    ior, roughness, weight = Constant(ior), Constant(roughness), Constant(weight)
    below = BeneathLayer(ior, tint, roughness, weight, distribution)
    return Material(
        "layered",
        (WeightedClosure(Specular(distribution, ior, tint, roughness), weight), WeightedClosure(Diffuse(WHITE), below)),
    )


def test_white_layers_leave_a_white_furnace_white(seed):
    """A diffuse base gets what the layer above it does not reflect.

    That holds for single and multiple scattering alike.
    """
    materials = [
        layered(1.5, 0.5, 1.0),
        layered(1.5, 1.0, 0.7),
        layered(2.2, 0.2, 1.0, "GGX"),
        layered(0.7, 0.6, 1.0, "GGX"),
    ]
    picture = scene(fan(ANGLES, len(materials)), materials, fan_camera(ANGLES, len(materials)), world=1.0)
    assert_mean(replicates(picture, 10, 256, seed=seed), 1.0, 0.008, rounding=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("eta", [1.5, pytest.param(0.7, marks=pytest.mark.slow)])
def test_glass_albedo_is_what_samples_weigh(eta, rng):
    """The mean weight of sampled directions is the albedo, which compensation makes 1."""
    for alpha, cos_o in ((0.3, 0.9), (0.8, 0.4)):
        wo = np.repeat(np.array([[np.sqrt(1.0 - cos_o**2)], [0.0], [cos_o]]), 200_000, axis=1)
        interface = Interface(Dielectric(np.float64(eta)), np.ones((3, 1)), np.ones((3, 1)))
        _, weight, _ = RoughDielectric(
            wo, np.float64(alpha), np.float64(alpha), np.float64(eta), GGX(), interface
        ).sample(*rng.random((2, wo.shape[1])))
        error = weight[0].std() / np.sqrt(weight.shape[1])
        expected = layers.glass_albedo(np.array([cos_o]), np.float64(alpha), eta)[0]
        assert weight[0].mean() == pytest.approx(expected, abs=4.5 * error + 5e-4)


def test_the_quadrature_has_the_normals_and_the_masking_of_the_lobe(rng):
    """It leaves out y, which has no part in a cosine with a direction in the plane of x and z."""
    many, generator = lattice = 89, 55
    mu, alpha = 0.02 + 0.98 * rng.random((2, 6, 1))
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    lambda_o = layers._smith_lambda(mu, alpha)
    x, z, weight = layers._visible_normals(mu, sine, alpha, lambda_o, lattice)
    k = np.arange(many)
    u1, v = (k + 0.5) / many, (k * generator % many + 0.5) / many
    for row in range(6):
        wo = np.repeat([sine[row], [0.0], mu[row]], many, axis=1)
        m = GGX().sample_visible(wo, *alpha[row].repeat(2), u1, v * v * (3.0 - 2.0 * v))
        np.testing.assert_allclose([x[row], z[row]], m[[0, 2]], rtol=0.0, atol=1e-14)
        assert lambda_o[row, 0] == pytest.approx(GGX().smith_lambda(wo, *alpha[row].repeat(2))[0], rel=1e-13)
    assert weight.sum() == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize(
    "eta", [pytest.param(1.2, marks=pytest.mark.slow), 1.5, pytest.param(0.7, marks=pytest.mark.slow)]
)
def test_glass_albedo_is_the_integral(eta, rng):
    mu, alpha = 0.02 + 0.98 * rng.random((2, 40))
    fine = layers.integrate_glass(mu, alpha, eta, (121393, 75025))
    np.testing.assert_allclose(layers.glass_albedo(mu, alpha, eta), fine, atol=2e-4)


@pytest.mark.parametrize("eta", [1.2, 1.5, 2.4, 0.7])
def test_layer_albedo_splits_the_whole(eta, rng):
    """The parts with weights s and 1 - s add up to the albedo without Fresnel."""
    mu, alpha = 0.02 + 0.98 * rng.random((2, 200))
    parts = layers.layer_albedo(mu, alpha, eta)
    np.testing.assert_allclose(sum(parts), directional_albedo(mu, alpha), atol=1e-4)


@pytest.mark.parametrize("eta", [1.1, 1.5, 2.4, 0.9, 0.4])
def test_average_reflectances_are_their_integrals(eta):
    kink = [np.sqrt(1.0 - eta * eta)] if eta < 1.0 else None
    exact = quad(lambda c: 2.0 * c * dielectric(np.array([c]), eta)[0], 0.0, 1.0, points=kink, epsabs=1e-11)[0]
    assert float(layers.average_reflectance(eta)) == pytest.approx(exact, rel=1e-6)
    curve = tinted_dielectric(np.float64(eta), np.array([[1.0], [0.5], [0.0]]))
    for channel in range(3):
        mean = quad(lambda c, k=channel: 2.0 * c * curve(np.array([c]))[k, 0], 0.0, 1.0, points=kink, epsabs=1e-10)[0]
        assert curve.average[channel, 0] == pytest.approx(mean, abs=1e-6)


def test_f82_meets_its_tint_and_its_mean():
    f0, tint = np.array([[0.2], [0.6], [0.95]]), np.array([[0.4], [0.9], [1.0]])
    curve = F82(f0, tint)
    seventh = f0 + (1.0 - f0) * (6.0 / 7.0) ** 5
    np.testing.assert_allclose(curve(np.array([1.0 / 7.0])), seventh * tint, rtol=1e-12)
    np.testing.assert_allclose(curve(np.array([1.0])), f0)
    for k in range(3):
        mean = quad(lambda c, k=k: 2.0 * c * curve(np.array([c]))[k, 0], 0.0, 1.0)[0]
        assert curve.average[k, 0] == pytest.approx(mean, rel=1e-9)


def test_conductor_average_is_its_integral():
    """Cycles' mean of a conductor is that of a curve through two of its points.

    It is within 2 % for metals.
    """
    eta, k = np.array([[0.2], [0.9], [1.3]]), np.array([[3.9], [2.4], [1.9]])
    curve = Conductor(eta, k)
    for channel in range(3):
        mean = quad(lambda c, i=channel: 2.0 * c * curve(np.array([c]))[i, 0], 0.0, 1.0)[0]
        assert curve.average[channel, 0] == pytest.approx(mean, rel=1e-9)
        assert 1e-3 < abs(curve.average_cycles[channel, 0] / mean - 1.0) < 2e-2


def test_nothing_beneath_a_perfect_layer():
    """Weight 0 leaves all; an index of 1 reflects nothing."""
    cos = np.array([0.3, 0.9])
    np.testing.assert_array_equal(
        beneath_layer("GGX", 1.5, np.ones((3, 1)), np.float64(0.5), np.float64(0.0), cos), 1.0
    )
    np.testing.assert_array_equal(beneath_layer("GGX", 1.0, np.ones((3, 1)), np.float64(0.5), ONE.value, cos), 1.0)


@pytest.mark.parametrize("ior", [1.0, 1.5, 2.2])
@pytest.mark.parametrize("weight", [0.3, 1.0])
def test_coat_tint_absorbs_along_the_refracted_path(ior, weight):
    """Beer's law through a coat of thickness 1 that light crosses under Snell's angle.

    It is computed from the angles themselves (mpmath).
    """
    tint = np.array([[0.9], [0.5], [0.1]])
    angles = np.radians([0.0, 30.0, 60.0, 80.0])
    found = coat_tint(np.float64(ior), tint, np.float64(weight), np.cos(angles))
    for k, angle in enumerate(angles):
        path = 1 / mpmath.cos(mpmath.asin(mpmath.sin(angle) / ior))
        for channel in range(3):
            exact = 1 - weight + weight * mpmath.exp(mpmath.log(float(tint[channel, 0])) * path)
            assert found[channel, k] == pytest.approx(float(exact), rel=1e-9)
