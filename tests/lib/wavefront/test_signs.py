# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours below 0 and above 1.

Emission of any sign is light of that sign, and what would reflect less than nothing reflects nothing.
"""

import numpy as np
import pytest
from etalon.lib.scene.expressions import Constant, Coordinates, Math, ValueToColor, VectorToValue
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.materials import Diffuse, Emission, Translucent
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import color, diffuse, emission, floor, material, orthographic, quad, scene

ABOVE = orthographic(2, 2, 1.0, (0.0, 0.0, 5.0))
SUN = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (1.0, 1.0, 1.0))


def test_a_face_of_negative_emission_shows_it():
    image = ReferenceRenderer(scene(floor(), emission(-0.7, 0.0, 0.4), ABOVE), Options(threads=1)).render(0, 1)
    np.testing.assert_allclose(image.radiance, np.broadcast_to([-0.7, 0.0, 0.4], (2, 2, 3)), rtol=1e-12)


def test_emission_of_both_signs_adds_up():
    both = material(Emission(color(0.9)), Emission(color(-0.7)))
    image = ReferenceRenderer(scene(floor(), both, ABOVE), Options(threads=1)).render(0, 1)
    np.testing.assert_allclose(image.radiance, 0.2, rtol=1e-12)


@pytest.mark.parametrize("direct", ["mis", "bsdf", "lights"])
def test_a_negative_emitter_takes_light_away(direct, seed):
    """A point of a Lambert floor of albedo 0.8 under a square of radiance -1.

    The square has half-width 1 and stands at height 1: E = -0.554...
    """
    a = 1.0
    # Form factor of a square above the middle, Siegel and Howell: (4 / 2 pi) sum over the corner, X = Y = a / height.
    side = a / np.sqrt(1.0 + a * a)
    form = 4.0 / (2.0 * np.pi) * 2.0 * side * np.arctan(side)
    lamp = quad((-a, -a, 1.0), (2.0 * a, 0.0, 0.0), (0.0, 2.0 * a, 0.0), 1)
    under = orthographic(1, 1, 1e-3, (0.0, 0.0, 0.5))
    stage = scene([floor(3.0), lamp], [diffuse(0.8), emission(-1.0, 0.5, 0.0)], under, bounces=0)
    shown = replicates(stage, 8, 256, direct=direct, seed=seed)
    assert_mean(shown, 0.8 * form * np.array([-1.0, 0.5, 0.0]), precision=2e-2)


@pytest.mark.parametrize("closure", [Diffuse, Translucent])
def test_a_colour_below_zero_scatters_nothing(closure):
    """Green shows the albedo 0.5 / pi times the sun's irradiance 0.8."""
    forward = 1.0 if closure is Diffuse else -1.0
    sun = SunLight("sun", (0.0, 0.6, 0.8 * forward), 0.0, (1.0, 1.0, 1.0))
    stage = scene(floor(), material(closure(color(-0.5, 0.5, 2.0))), ABOVE, (sun,))
    image = ReferenceRenderer(stage, Options(threads=1)).render(0, 1)
    np.testing.assert_allclose(image.radiance / (0.8 / np.pi), np.broadcast_to([0.0, 0.5, 2.0], (2, 2, 3)), rtol=1e-9)


@pytest.mark.parametrize("varies", [False, True])
def test_a_negative_world_takes_light_away(varies, seed):
    """A Lambert floor of albedo 0.8 in a world of -0.5: -0.4.

    A world that varies is a constant one to twelve digits.
    """
    direction = VectorToValue(Coordinates("GENERATED"))
    tiny = Math("MULTIPLY", direction, Constant(1e-12), Constant(0.0))
    world = World(ValueToColor(Math("ADD", tiny, Constant(-0.5), Constant(0.0))) if varies else color(-0.5))
    stage = scene(floor(50.0), diffuse(0.8), ABOVE, world=world)
    assert_mean(replicates(stage, 8, 256, seed=seed), -0.4, precision=5e-3)
