# SPDX-License-Identifier: GPL-3.0-or-later
"""Which part of each light arrives; images depend on it for nothing but their noise."""

import math

import numpy as np
import pytest
from etalon.lib.effects.plan import make_plan
from etalon.lib.scene.lights import SphereLight, SunLight
from etalon.lib.scene.materials import Diffuse, Transparent
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.kernel import Kernel
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import color, floor, material, perspective, quad, scene

ALBEDOS = 0.6, 0.0
HIDDEN = SphereLight("hidden", (4.0, 0.0, 1.0), 0.2, (900.0, 900.0, 900.0))
OPEN = SphereLight("open", (-1.0, 0.3, 1.5), 0.2, (4.0, 5.0, 9.0))


def wall(height):
    """A black wall along y at x = 1."""
    return quad((1.0, -400.0, 0.0), (0.0, 800.0, 0.0), (0.0, 0.0, height), 1)


def lit(lights, height, half=1.0):
    """A floor of which a square of 2 `half` about the origin is seen from above, beside a wall of `height` or none."""
    view = perspective(1, 1, 0.1 * half, (0.0, 0.0, 10.0), (0.0, 0.0, -1.0))
    materials = [material(Diffuse(color(albedo))) for albedo in ALBEDOS]
    return scene(
        [floor(60.0), *([wall(height)] if height else [])], materials[: 2 if height else 1], view, lights, bounces=1
    )


def shares(built):
    arriving = Kernel(built, make_plan(built), Options())._arrives
    assert arriving is not None
    return arriving


def chance(built, light):
    """The chance of a light at the origin."""
    selection = Kernel(built, make_plan(built), Options()).selection
    cell = selection.cells(np.zeros((3, 1)))
    return float(selection.probability(light, cell)[0])


def test_a_lamp_behind_a_wall_does_not_arrive_and_one_before_it_does():
    np.testing.assert_array_equal(shares(lit([HIDDEN, OPEN], 40.0)), [0.0, 1.0])
    assert chance(lit([HIDDEN, OPEN], 40.0), 1) > 0.7


def test_of_a_low_sun_the_part_arrives_that_passes_over_the_wall():
    """At 45 degrees a wall of height h shades what is nearer than h; it faces away from the sun itself."""
    sun = SunLight("sun", (math.sqrt(0.5), 0.0, math.sqrt(0.5)), 0.0, (1.0, 1.0, 1.0))
    for height in (0.5, 1.0, 1.5):
        assert shares(lit([sun, OPEN], height))[0] == pytest.approx(1.0 - 0.5 * height, abs=0.01)


def test_a_light_that_reaches_nothing_counts_as_if_nothing_hid_it():
    below = SphereLight("below", (0.0, 0.0, -3.0), 0.2, (1.0, 1.0, 1.0))
    assert shares(lit([below, OPEN], 0.0)).tolist() == [1.0, 1.0]


@pytest.mark.parametrize("direct", ["mis", "lights"])
def test_the_floor_has_the_closed_form_of_the_lamp_that_it_sees(direct, monkeypatch):
    """The lamp gives pi L (r / d)^2 cos; with the hidden one taken for open, there is ten times the variance."""
    built = lit([HIDDEN, OPEN], 40.0, half=1e-3)
    to = np.array(OPEN.position)
    distance = math.sqrt(to @ to)
    truth = ALBEDOS[0] * np.array(OPEN.radiance) * (OPEN.radius / distance) ** 2 * to[2] / distance
    images = replicates(built, 16, 256, direct=direct)
    assert_mean(images, truth, precision=0.02, rounding=1e-3)
    monkeypatch.setattr(Kernel, "_arriving", lambda self, like: None)
    plain = replicates(built, 16, 256, direct=direct)
    assert np.var(plain, axis=0).sum() > 10.0 * np.var(images, axis=0).sum()


def test_a_kernel_like_another_knows_what_arrives(monkeypatch):
    built = lit([HIDDEN, OPEN], 40.0)
    first = Kernel(built, make_plan(built), Options())
    monkeypatch.delattr("etalon.lib.wavefront.kernel.arriving_shares")
    second = Kernel(built, make_plan(built), Options(), first)
    assert second._arrives is first._arrives


@pytest.mark.parametrize("panes", [1, 3, 30])
def test_clear_panes_hide_nothing_unless_there_are_very_many(panes):
    """Between the hidden lamp and the floor stand panes, and no wall."""
    meshes = [quad((1.0 + 0.02 * k, -400.0, 0.0), (0.0, 800.0, 0.0), (0.0, 0.0, 40.0), 1) for k in range(panes)]
    materials = [material(Diffuse(color(0.6))), material(Transparent(color(0.9)))]
    view = perspective(1, 1, 0.1, (0.0, 0.0, 10.0), (0.0, 0.0, -1.0))
    found = shares(scene([floor(60.0), *meshes], materials, view, [HIDDEN, OPEN], bounces=1))
    np.testing.assert_array_equal(found, [float(panes < 9), 1.0])
