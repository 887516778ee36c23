# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights that overlap in one plane: all of them shine, by whatever strategy they are found.

Cycles loses up to half of the light (docs/findings/lights_in_one_plane.md).
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.scene.lights import AreaLight, Falloff
from etalon.tests import scenes
from etalon.tests.replicates import assert_mean, replicates
from scipy.special import roots_legendre

DEPARTING = frozenset({"lights in one plane"})
HEIGHT, SIZE, ALBEDO = 2.0, 4.0, 0.8
LIGHT = AreaLight(
    "one", (0.0, 0.0, HEIGHT), (SIZE, 0.0, 0.0), (0.0, -SIZE, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", (1.0,) * 3, np.pi
)


def irradiance(left, right, radiance=np.ones_like):
    """The irradiance at the origin by a rectangle above left <= x <= right: radiance(d) cos^2 / d^2 over it."""
    node, weight = roots_legendre(64)
    half = 0.5 * (right - left)
    across, along = np.meshgrid(left + half * (1.0 + node), 0.5 * SIZE * node)
    squared = across**2 + along**2 + HEIGHT**2
    arriving = radiance(np.sqrt(squared)) * HEIGHT**2 / squared**2
    return (np.outer(weight, weight) * arriving).sum() * half * 0.5 * SIZE


def above(places, **settings):
    """Lights that are centred above the x in `places`."""
    return tuple(replace(LIGHT, name=str(k), center=(x, 0.0, HEIGHT), **settings) for k, x in enumerate(places))


def shown(lights, seed, **options):
    """Replicates of a point of a floor under `lights`."""
    camera = scenes.orthographic(1, 1, 1e-3, (0.0, 0.0, 1.0))
    scene = scenes.scene(scenes.floor(), scenes.diffuse(ALBEDO), camera, lights)
    return replicates(scene, 16, 256, seed=seed, **options)


@pytest.mark.grid(2)
@pytest.mark.parametrize("direct", ["mis", "bsdf", "lights"])
@pytest.mark.parametrize("places", [(0.0, 0.0), (0.0, 0.5 * SIZE), (0.0, 0.0, 0.0)])
def test_lights_in_one_plane_add_up(places, direct, seed):
    both = sum(irradiance(x - 0.5 * SIZE, x + 0.5 * SIZE) for x in places)
    assert_mean(shown(above(places), seed, direct=direct), ALBEDO / np.pi * both, precision=5e-3)


@pytest.mark.grid(2)
@pytest.mark.parametrize("direct", ["mis", "bsdf"])
@pytest.mark.parametrize("places", [(0.0, 0.0), (0.0, 0.5 * SIZE), (0.0, 0.0, 0.0)])
def test_with_the_departure_they_shine_as_the_area_that_they_cover(places, direct, seed):
    union = irradiance(min(places) - 0.5 * SIZE, max(places) + 0.5 * SIZE)
    images = shown(above(places), seed, direct=direct, departures=DEPARTING)
    assert_mean(images, ALBEDO / np.pi * union, precision=2e-2)


@pytest.mark.parametrize("places", [(0.0, 0.0), (0.0, 0.5 * SIZE)])
def test_with_the_departure_lights_of_one_falloff_shine_as_the_area_that_they_cover(places, seed):
    """Linear falloff: radiance grows with the distance."""
    union = irradiance(min(places) - 0.5 * SIZE, max(places) + 0.5 * SIZE, lambda d: d)
    images = shown(above(places, falloff=Falloff(1)), seed, departures=DEPARTING)
    assert_mean(images, ALBEDO / np.pi * union, precision=2e-2)


@pytest.mark.parametrize("first", [0, 1])
def test_with_the_departure_the_light_is_met_that_is_dimmer_at_the_place(first, seed):
    """One of radiance 1, the other of d / 2.5: which is dimmer depends on the distance d, 2 to 3.5 metres."""
    lights = LIGHT, replace(LIGHT, name="other", radiance=(0.4,) * 3, falloff=Falloff(1))
    images = shown((lights[first], lights[1 - first]), seed, departures=DEPARTING)
    least = irradiance(-0.5 * SIZE, 0.5 * SIZE, lambda d: np.minimum(1.0, 0.4 * d))
    assert_mean(images, ALBEDO / np.pi * least, precision=2e-2)
