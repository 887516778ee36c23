# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights in all units.

Tested are quadrature of what they send out, rays that leave them, and the definition of the lumen.
"""

import math

import numpy as np
import pytest
from etalon.lib.lights.build import light_sampler
from etalon.lib.lights.light import Ball
from etalon.lib.lights.spot import Falloff
from etalon.lib.lights.units import EFFICACY, light_units
from etalon.lib.scene.lights import AreaLight, Cone, PointLight, SphereLight, SpotLight, SunLight
from scipy.integrate import quad

COLOR = (1.0, 2.0, 0.5)
LUMINANCE = 0.2126 * 1.0 + 0.7152 * 2.0 + 0.0722 * 0.5
AXES = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
PLACE = (0.0, 0.0, 2.0)


def spot(half, blend, radius=0.0, x_axis=AXES[0]):
    return SpotLight("spot", PLACE, radius, COLOR, Cone((0.0, 0.0, -1.0), x_axis, AXES[1], math.cos(half), blend))


def area(shape="RECTANGLE", spread=math.pi):
    return AreaLight("area", PLACE, (2.0, 0.0, 0.0), (0.0, 3.0, 0.0), (0.0, 0.0, -1.0), shape, COLOR, spread)


LIGHTS = {
    "point": PointLight("point", PLACE, COLOR),
    "sphere": SphereLight("sphere", PLACE, 0.3, COLOR),
    "spot": spot(0.6, 0.4),
    "sharp spot": spot(0.3, 0.0),
    "spot with a radius": spot(0.9, 1.0, 0.2),
    "area": area(),
    "disk": area("ELLIPSE"),
    "area with a spread": area(spread=1.0),
    "disk with a narrow spread": area("ELLIPSE", 0.15),
}


@pytest.mark.parametrize("kind", LIGHTS)
def test_the_flux_is_that_of_the_rays_that_leave_the_light(kind, rng):
    """The mean weight of rays, W, in 16 replicates, within five standard errors."""
    sampler = light_sampler(LIGHTS[kind], 10.0)
    ball = Ball(np.zeros((3, 1)), 10.0, 10.0)
    rows = [
        sampler.emit(ball, tuple(rng.random((2, 4096))), tuple(rng.random((2, 4096)))).weight.mean(axis=1)
        for _ in range(16)
    ]
    error = np.std(rows, axis=0, ddof=1) / 4.0
    flux = light_units(LIGHTS[kind]).flux
    assert (np.abs(np.mean(rows, axis=0) - flux) <= 5.0 * error + 1e-9 * flux).all()


@pytest.mark.parametrize(("half", "blend"), [(0.6, 0.4), (0.3, 0.0), (1.5, 1.0), (0.01, 0.15)])
def test_a_spot_lets_out_the_integral_of_its_falloff(half, blend):
    """2 pi times the integral of smoothstep over the cosine, of what 4 pi sr would hold."""

    def falloff(c):
        t = (
            min(max((c - math.cos(half)) / ((1.0 - math.cos(half)) * blend), 0.0), 1.0)
            if blend
            else float(c > math.cos(half))
        )
        return t * t * (3.0 - 2.0 * t)

    edge = math.cos(half) + (1.0 - math.cos(half)) * blend
    integral = quad(falloff, math.cos(half), edge)[0] + quad(falloff, edge, 1.0)[0]
    found = light_units(spot(half, blend))
    np.testing.assert_allclose(found.flux, 2.0 * math.pi * integral * np.array(COLOR), rtol=1e-9)
    np.testing.assert_allclose(found.power, 4.0 * math.pi * np.array(COLOR), rtol=1e-15)
    np.testing.assert_allclose(found.intensity, COLOR, rtol=1e-15)


@pytest.mark.parametrize("spread", [math.pi, 2.5, 1.0, 0.2, 0.1, 0.01, 1e-3])
@pytest.mark.parametrize(("shape", "size"), [("RECTANGLE", 6.0), ("ELLIPSE", 1.5 * math.pi)])
def test_a_spread_keeps_the_flux_and_gathers_it(shape, size, spread):
    """Flux pi L A for every spread: the integral of the intensity over the hemisphere."""
    found, half = light_units(area(shape, spread)), 0.5 * spread
    np.testing.assert_allclose(found.flux, math.pi * size * np.array(COLOR), rtol=1e-12)

    def intensity(theta):
        if spread >= math.pi:
            return found.intensity[0] * math.cos(theta)
        return found.intensity[0] * (1.0 - math.tan(theta) / math.tan(half)) * math.cos(theta)

    flux = quad(lambda theta: 2.0 * math.pi * math.sin(theta) * intensity(theta), 0.0, half, epsabs=0.0)[0]
    assert flux == pytest.approx(found.flux[0], rel=1e-7)


def test_a_lamp_of_one_watt_of_luminance_at_the_maximum_has_683_lumens():
    """A candela is 1/683 W/sr.

    So 1/683 W/sr of luminance in all directions are 4 pi lumens.
    """
    found = light_units(PointLight("one", PLACE, (1.0 / 683.0,) * 3))
    assert found.candela == pytest.approx(1.0, rel=1e-12)
    assert found.lumens == pytest.approx(4.0 * math.pi, rel=1e-12)
    assert EFFICACY == 683.0


def test_a_sun_has_irradiance_and_nothing_else():
    found = light_units(SunLight("sun", (0.0, 0.0, 1.0), 0.01, COLOR))
    assert (found.flux, found.intensity, found.lumens, found.candela) == (None,) * 4
    assert found.lux == pytest.approx(683.0 * LUMINANCE, rel=1e-12)


def test_surfaces_have_the_exitance_of_their_radiance():
    """Flux over area, for the side of an area light and for a sphere."""
    np.testing.assert_allclose(light_units(area()).exitance, light_units(area()).flux / 6.0, rtol=1e-12)
    ball = light_units(LIGHTS["sphere"])
    np.testing.assert_allclose(ball.exitance, ball.flux / (4.0 * math.pi * 0.3**2), rtol=1e-12)


def test_a_stretched_cone_has_no_closed_form():
    light = spot(0.6, 0.4, x_axis=(2.0, 0.0, 0.0))
    assert Falloff(light.cone).is_stretched
    assert light_units(light).flux is None
