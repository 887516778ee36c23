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


def irradiance(x):
    """The irradiance at the origin by a square of radiance 1 that is centred above (x, 0): cos^2 / d^2 over it."""
    node, weight = roots_legendre(64)
    across, along = np.meshgrid(x + 0.5 * SIZE * node, 0.5 * SIZE * node)
    squared = across**2 + along**2 + HEIGHT**2
    return (np.outer(weight, weight) * HEIGHT**2 / squared**2).sum() * (0.5 * SIZE) ** 2


@pytest.mark.parametrize("direct", ["mis", "bsdf", "lights"])
@pytest.mark.parametrize("places", [(0.0, 0.0), (0.0, 0.5 * SIZE), (0.0, 0.0, 0.0)])
def test_lights_in_one_plane_add_up(places, direct, seed):
    lights = tuple(replace(LIGHT, name=str(k), center=(x, 0.0, HEIGHT)) for k, x in enumerate(places))
    camera = scenes.orthographic(1, 1, 1e-3, (0.0, 0.0, 1.0))
    scene = scenes.scene(scenes.floor(), scenes.diffuse(ALBEDO), camera, lights)
    images = replicates(scene, 16, 256, direct=direct, seed=seed)
    assert_mean(images, ALBEDO / np.pi * sum(map(irradiance, places)), precision=5e-3)
