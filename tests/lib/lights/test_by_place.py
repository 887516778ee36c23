# SPDX-License-Identifier: GPL-3.0-or-later
"""The grid by which many lights are chosen.

Its chances are those with which it chooses, and the light of a row of lamps on a floor is a sum of closed forms.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.plan import make_plan
from etalon.lib.lights.build import light_sampler
from etalon.lib.lights.by_place import EVEN_SHARE, LightGrid, chances_by_power
from etalon.lib.scene.lights import AreaLight, Falloff, PointLight, SphereLight, SunLight
from etalon.lib.scene.materials import Diffuse
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.kernel import Kernel
from etalon.tests.replicates import assert_mean, assert_same, blocks, replicates
from etalon.tests.scenes import color, floor, material, perspective, quad, scene

ROW = [SphereLight(f"lamp {k}", (3.0 * k, 0.0, 1.5), 0.2, (4.0 + k, 5.0, 9.0 - 0.5 * k)) for k in range(12)]
SUN = SunLight("sun", (0.6, 0.0, 0.8), 0.1, (1.0, 1.0, 1.0))
BOUNDS = np.array([[-50.0, -50.0, 0.0], [50.0, 50.0, 3.0]])
ALBEDO = (0.8, 0.5, 0.3)


def grid_of(lights, bounds=BOUNDS):
    return LightGrid([light_sampler(light, 60.0) for light in lights], bounds, 60.0)


def above(x):
    """A camera of one pixel that sees a spot of some centimetres at (x, 0.3, 0)."""
    return perspective(1, 1, 0.005, (x, 0.3, 5.0), (0.0, 0.0, -1.0))


def test_lights_are_chosen_with_the_chances_of_the_cell():
    grid = grid_of([*ROW, SUN])
    assert grid.useful
    u = (np.arange(50000) + 0.5) / 50000
    for x in (0.0, 17.0, 80.0):
        cell = grid.cells.number(np.array([[x], [0.3], [0.0]]))
        found = np.bincount(grid.choose(np.repeat(cell, u.size), u), minlength=13) / u.size
        np.testing.assert_allclose(found, grid.probability(np.arange(13), np.repeat(cell, 13)), atol=1e-4)


def test_chances_of_each_cell_add_up_to_one_and_none_is_rare(rng):
    grid = grid_of([*ROW, SUN])
    chances = np.array([grid.probability(k, np.arange(grid.cells.everywhere + 1)) for k in range(13)])
    np.testing.assert_allclose(chances.sum(axis=0), 1.0, rtol=1e-12)
    assert chances.min() >= EVEN_SHARE / 13.0 * (1.0 - 1e-12)


def test_the_nearest_of_equal_lamps_is_the_likeliest():
    lamps = [PointLight("lamp", (3.0 * k, 0.0, 1.5), (1.0, 1.0, 1.0)) for k in range(12)]
    grid = grid_of(lamps)
    point = np.array([[3.0 * k for k in range(12)], [0.0] * 12, [0.0] * 12])
    chances = np.array([grid.probability(k, grid.cells.number(point)) for k in range(12)])
    np.testing.assert_array_equal(chances.argmax(axis=0), np.arange(12))
    assert chances.max(axis=0).min() > 4.0 / 12.0


def test_the_last_cell_goes_by_power_alone():
    grid = grid_of([*ROW, SUN])
    flux = np.array([light_sampler(light, 60.0).flux for light in (*ROW, SUN)])
    np.testing.assert_allclose(
        grid.probability(np.arange(13), np.full(13, grid.cells.everywhere)), chances_by_power(flux), rtol=1e-12
    )


@pytest.mark.parametrize(
    "lights",
    [
        [SUN] * 9,
        [PointLight("lamp", (1.0, 2.0, 3.0), (1.0, 1.0, 1.0))] * 9,
        [PointLight("lamp", (float(k), 0.0, 0.0), (0.0, 0.0, 0.0)) for k in range(9)],
        [PointLight("lamp", (1e9 * k, 0.0, 0.0), (1e200, 0.0, 0.0)) for k in range(9)],
    ],
    ids=["suns", "one place", "black", "far apart"],
)
def test_odd_lights_have_finite_chances(lights, rng):
    grid = grid_of(lights)
    cell = grid.cells.number(rng.uniform(-1e6, 1e6, (3, 100)))
    chances = np.array([grid.probability(k, cell) for k in range(9)])
    np.testing.assert_allclose(chances.sum(axis=0), 1.0, rtol=1e-9)


def radiance_above(x, lamps):
    """The light that the floor at (x, 0.3, 0) reflects: each lamp gives pi L (r / d)^2 cos."""
    total = np.zeros(3)
    for lamp in lamps:
        to = np.array(lamp.position) - (x, 0.3, 0.0)
        distance = math.sqrt(to @ to)
        total += np.array(lamp.radiance) * (lamp.radius / distance) ** 2 * to[2] / distance
    return np.array(ALBEDO) * total


@pytest.mark.grid(3)
@pytest.mark.parametrize("direct", ["mis", "lights"])
@pytest.mark.parametrize("x", [0.0, 10.4, 33.0])
def test_floor_under_a_row_of_lamps_is_the_sum_of_their_closed_forms(x, direct):
    lit = scene([floor(60.0)], [material(Diffuse(color(*ALBEDO)))], above(x), ROW, bounces=1)
    images = replicates(lit, 16, 1024, direct=direct)
    assert_mean(images, radiance_above(x, ROW), precision=0.01, rounding=1e-3)


FALLOFFS = [Falloff(1), Falloff(2), Falloff(0, 4.0), Falloff(1, 4.0), Falloff(2, 4.0), Falloff()]
MIXED = [replace(lamp, falloff=FALLOFFS[k % 6]) for k, lamp in enumerate(ROW)]


def test_of_lamps_that_fall_off_otherwise_each_has_its_part_of_the_light_at_the_place():
    """Three quarters of what is not shared evenly go by the irradiance, a quarter by power over the scene's radius.

    The cells are small beside the distances.
    """
    grid = grid_of(MIXED)
    place = np.array([[17.0], [0.3], [0.0]])
    square = np.array([(np.square(lamp.position - place[:, 0])).sum() for lamp in MIXED])

    def fading(square, falloff):
        return square ** (0.5 * falloff.power) * square / (square + falloff.smooth)

    usual = np.array([light_sampler(lamp, 60.0).flux for lamp in ROW]).T
    light, power = (
        usual * [fading(d, lamp.falloff) / over for d, over, lamp in zip(squares, divisors, MIXED, strict=True)]
        for squares, divisors in ((square, square), (np.full(12, 60.0**2), np.ones(12)))
    )
    light, power = ((of / of.sum(axis=1, keepdims=True)).mean(axis=0) for of in (light, power))
    expected = EVEN_SHARE / 12.0 + (1.0 - EVEN_SHARE) * (0.75 * light + 0.25 * power)
    found = grid.probability(np.arange(12), np.repeat(grid.cells.number(place), 12))
    np.testing.assert_allclose(found, expected, rtol=0.1)


@pytest.mark.parametrize(
    ("lights", "useful"),
    [
        ([replace(lamp, falloff=Falloff(2)) for lamp in ROW], False),
        ([*(replace(lamp, falloff=Falloff(2)) for lamp in ROW), SUN], False),
        ([*(replace(lamp, falloff=Falloff(2)) for lamp in ROW), ROW[0]], True),
        ([replace(lamp, falloff=Falloff(2, 1.0)) for lamp in ROW], True),
    ],
    ids=["constant", "constant, and a sun", "constant, and a usual lamp", "constant, smooth"],
)
def test_there_is_a_choice_by_place_where_any_light_depends_on_it(lights, useful):
    assert grid_of(lights).useful == useful


@pytest.mark.parametrize("direct", ["mis", "lights"])
@pytest.mark.parametrize("falloff", [Falloff(1), Falloff(2), Falloff(1, 4.0)], ids=["linear", "constant", "smooth"])
def test_floor_under_lamps_that_fall_off_otherwise_is_the_sum_of_their_closed_forms(falloff, direct):
    """Points beside a usual lamp; each gives intensity cos / d^2, times what the falloff makes of it."""
    lamps = [PointLight(f"lamp {k}", (8.0 * k, 0.3, 1.5), (1.0 + k,) * 3, falloff=falloff) for k in range(5)]
    lamps.append(PointLight("usual", (2.0, 0.3, 1.0), (4.0,) * 3))
    total = 0.0
    for lamp in lamps:
        square = (lamp.position[0] - 10.4) ** 2 + lamp.position[2] ** 2
        fading = square ** (0.5 * lamp.falloff.power) * square / (square + lamp.falloff.smooth)
        total += lamp.intensity[0] * lamp.position[2] / square**1.5 * fading / np.pi
    lit = scene([floor(60.0)], [material(Diffuse(color(*ALBEDO)))], above(10.4), lamps)
    assert_mean(replicates(lit, 16, 1024, direct=direct), total * np.array(ALBEDO), precision=0.01, rounding=1e-3)


def in_two_rooms(count, lamps=ROW):
    """Lamps on both sides of a wall between two cells, over a floor in the plane of another."""
    lamps = [replace(lamps[k], position=(3.0 * k - 16.5, 0.3, 1.5), radius=0.6) for k in range(count)]
    wall = quad((0.0, -2.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 3.0), 0)
    camera = perspective(8, 8, 1.2, (-3.0, -6.0, 4.0), (0.4, 1.0, -0.6))
    return scene([floor(30.0), wall], [material(Diffuse(color(0.8, 0.5, 0.3)))], camera, lamps, bounces=3)


@pytest.mark.parametrize(("lamps", "samples"), [(ROW, 64), (MIXED, 640)], ids=["usual", "of all falloffs"])
def test_strategies_agree_where_lamps_are_chosen_by_place(lamps, samples):
    room, ways = in_two_rooms(12, lamps), {"mis": 64, "lights": 64, "bsdf": samples}
    images = [blocks(replicates(room, 16, count, direct=direct), 4) for direct, count in ways.items()]
    assert_same(images[0], images[1], precision=0.05)
    assert_same(images[0], images[2], precision=0.15)


def test_beams_of_any_falloff_are_chosen_by_power():
    """A light of spread 0 lights what is below its outline, so that distance says little."""
    edges = (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)
    beams = [
        AreaLight(f"{k}", (k, 0.0, 2.0), *edges, "RECTANGLE", (1.0,) * 3, 0.0, falloff=Falloff(1)) for k in (0.0, 9.0)
    ]
    assert not grid_of(beams).useful
    assert grid_of([*beams, *ROW[:2]]).useful


def test_what_arrives_makes_a_grid_only_where_lights_that_shine_differ_in_it():
    suns = [light_sampler(light, 60.0) for light in (SUN, SUN, replace(SUN, irradiance=(0.0, 0.0, 0.0)))]
    assert LightGrid(suns, BOUNDS, 60.0, arrives=np.array([0.0, 1.0, 1.0])).useful
    assert not LightGrid(suns, BOUNDS, 60.0, arrives=np.array([0.5, 0.5, 1.0])).useful


@pytest.mark.parametrize("lights", [[SUN, SUN], [ROW[3]]], ids=["suns", "a lamp"])
def test_there_is_no_grid_where_place_does_not_matter(lights):
    built = scene([floor(30.0)], [material(Diffuse(color(*ALBEDO)))], above(0.0), lights)
    kernel = Kernel(built, make_plan(built), Options())
    assert kernel.selection.grid is None


def test_chances_by_power_at_places_that_were_chosen_by_place_are_caught(monkeypatch):
    """The planted error: a density that forgets the place."""
    by_power = chances_by_power(np.array([light_sampler(lamp, 60.0).flux for lamp in ROW]))
    monkeypatch.setattr(LightGrid, "probability", lambda self, light, cell: by_power[light])
    with pytest.raises(AssertionError, match="difference"):
        test_floor_under_a_row_of_lamps_is_the_sum_of_their_closed_forms(10.4, "mis")
