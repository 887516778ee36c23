# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights that overlap in one plane: all of them shine, by whatever strategy they are found.

Cycles loses up to half of the light (docs/findings/lights_in_one_plane.md).
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.scene.lights import AreaLight
from etalon.tests import scenes
from etalon.tests.replicates import assert_mean, replicates
from scipy.special import roots_legendre

HEIGHT, SIZE, ALBEDO = 2.0, 4.0, 0.8
LIGHT = AreaLight(
    "one", (0.0, 0.0, HEIGHT), (SIZE, 0.0, 0.0), (0.0, -SIZE, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", (1.0,) * 3, np.pi
)


def irradiance(left, right):
    """The irradiance at the origin by a rectangle of radiance 1 above left <= x <= right: cos^2 / d^2 over it."""
    node, weight = roots_legendre(64)
    half = 0.5 * (right - left)
    across, along = np.meshgrid(left + half * (1.0 + node), 0.5 * SIZE * node)
    squared = across**2 + along**2 + HEIGHT**2
    return (np.outer(weight, weight) * HEIGHT**2 / squared**2).sum() * half * 0.5 * SIZE


def shown(places, seed, **options):
    """Replicates of a point of a floor under lights that are centred above the x in `places`."""
    lights = tuple(replace(LIGHT, name=str(k), center=(x, 0.0, HEIGHT)) for k, x in enumerate(places))
    camera = scenes.orthographic(1, 1, 1e-3, (0.0, 0.0, 1.0))
    scene = scenes.scene(scenes.floor(), scenes.diffuse(ALBEDO), camera, lights)
    return replicates(scene, 16, 256, seed=seed, **options)


@pytest.mark.grid(2)
@pytest.mark.parametrize("direct", ["mis", "bsdf", "lights"])
@pytest.mark.parametrize("places", [(0.0, 0.0), (0.0, 0.5 * SIZE), (0.0, 0.0, 0.0)])
def test_lights_in_one_plane_add_up(places, direct, seed):
    both = sum(irradiance(x - 0.5 * SIZE, x + 0.5 * SIZE) for x in places)
    assert_mean(shown(places, seed, direct=direct), ALBEDO / np.pi * both, precision=5e-3)


@pytest.mark.grid(2)
@pytest.mark.parametrize("direct", ["mis", "bsdf"])
@pytest.mark.parametrize("places", [(0.0, 0.0), (0.0, 0.5 * SIZE), (0.0, 0.0, 0.0)])
def test_with_the_departure_they_shine_as_the_area_that_they_cover(places, direct, seed):
    union = irradiance(min(places) - 0.5 * SIZE, max(places) + 0.5 * SIZE)
    images = shown(places, seed, direct=direct, departures=frozenset({"lights in one plane"}))
    assert_mean(images, ALBEDO / np.pi * union, precision=2e-2)
