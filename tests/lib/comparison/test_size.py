# SPDX-License-Identifier: GPL-3.0-or-later
"""Smaller images where time is short."""

import numpy as np
import pytest
from etalon.lib.comparison import run as module
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.departures import Alternatives
from etalon.lib.comparison.run import TimedRun
from etalon.lib.comparison.size import LEAST_PAIRS, SMALL, TINY, choose_divisor, images_of_search
from etalon.lib.departures.catalogue import Departure
from etalon.lib.film.rendering import Rendering
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.scene.camera import smaller_camera
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.renderers import Clock, Painter, blank, grey
from etalon.tests.scenes import diffuse, floor, orthographic, scene


class Timed:
    """A renderer that takes `fixed` seconds and `per` seconds for each sample of a pixel."""

    def __init__(self, clock, per, fixed=0.1, pixels=None):
        self.clock, self.per, self.fixed, self.pixels = clock, per, fixed, pixels

    def at_size(self, width, height):
        return Timed(self.clock, self.per, self.fixed, width * height)

    def render(self, replicate, samples, progress, windows=None):
        assert self.pixels is not None, "an image of the whole size was rendered"
        self.clock.now += self.fixed + self.per * samples * self.pixels
        return Rendering(np.zeros((1, 1, 3)), np.zeros((1, 1), int), 0.0)


def chosen(monkeypatch, width, height, seconds, per=1e-6, searched=0):
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    camera = orthographic(width, height, 1.0, (0.0, 0.0, 1.0))
    sides = Timed(clock, per), Timed(clock, per)
    return choose_divisor(sides, camera, TimedRun(seconds, NO_PROGRESS), searched), clock.now - 100.0


@pytest.mark.parametrize(
    ("width", "height", "seconds", "divisor"),
    [
        (256, 256, 5.0, 1),
        (1920, 1080, None, 1),
        (1920, 1080, 600.0, 1),
        (1920, 1080, 60.0, 2),
        (3840, 2160, 60.0, 4),
        (3840, 2160, 600.0, 2),
        (1921, 1080, 60.0, 1),
        (1920, 1080, 1.0, 5),
    ],
)
def test_the_size_is_the_largest_of_which_replicates_enough_fit_into_the_time(
    monkeypatch, width, height, seconds, divisor
):
    found, spent = chosen(monkeypatch, width, height, seconds)
    assert found == divisor
    assert spent <= max(0.05 * (seconds or 0.0), 1.0)


def test_no_image_is_made_smaller_than_need_be(monkeypatch):
    """24 replicates do not fit, but 8 do.

    With one divisor less, the image would be larger than SMALL.
    """
    found, _ = chosen(monkeypatch, 1920, 1080, 12.0, per=2e-6)
    assert 1920 * 1080 / found**2 <= SMALL < 1920 * 1080 / (found - 1) ** 2


def test_eight_replicates_come_before_the_size(monkeypatch):
    """A small image of a slow scene is made smaller still, but never tiny."""
    assert chosen(monkeypatch, 256, 144, 15.0, per=1e-5)[0] == 1
    assert chosen(monkeypatch, 256, 144, 15.0, per=3e-5)[0] == 2  # 10 x 2 sides x 37 k pixels take 22 s
    found, _ = chosen(monkeypatch, 1920, 1080, 15.0, per=1e-3)
    assert 1920 * 1080 / found**2 <= TINY < 1920 * 1080 / (found // 2) ** 2


@pytest.mark.parametrize("searched", [0, 6, 18, 60])
def test_the_images_of_a_search_for_causes_fit_into_its_time(monkeypatch, searched):
    """A quarter of a minute, for images of 130 k pixels that take 2 s each."""
    found, spent = chosen(monkeypatch, 480, 270, 60.0, per=1.5e-5, searched=searched)
    needed = searched * (0.1 + 1.5e-5 * 480 * 270 / found**2)
    assert needed <= 0.25 * (60.0 - spent)
    assert (found == 1) == (searched <= 6)


def test_a_search_is_planned_for_where_rounding_makes_a_difference():
    names = [Departure("a", "", ""), Departure("b", "", ""), Departure("c", "", "", by_rounding=True)]
    assert images_of_search(Alternatives(tuple(names[:2]), Painter)) == 0
    assert images_of_search(Alternatives(tuple(names), Painter)) == LEAST_PAIRS * 4


class Slow(Painter):
    """A painter whose images take `seconds` for 480 x 270 pixels, and less for fewer."""

    def __init__(self, name, clock, seconds, width=480, height=270):
        cost = (0.05, seconds * width * height / (480 * 270))
        super().__init__(name, grey(1.0, width, height), 5.0, clock=clock, cost=cost)
        self.seconds = seconds

    def at_size(self, width, height):
        return Slow(self.name, self.clock, self.seconds, width, height)


@pytest.mark.grid(3)
@pytest.mark.parametrize("seconds", [0.5, 2.0, 4.0, 4.6, 5.5, 12.0, 40.0])
def test_the_whole_comparison_has_eight_replicates_in_the_chosen_size(monkeypatch, seconds):
    """The calls that are timed before the first look take their part, and so does what comes before them."""
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    run = TimedRun(60.0, NO_PROGRESS)
    sides = Slow("the reference", clock, seconds), Slow("Cycles", clock, 0.1 * seconds)
    divisor = choose_divisor(sides, orthographic(480, 270, 1.0, (0.0, 0.0, 1.0)), run)
    clock.now += 4.0  # as for a search for caustics
    size = 480 // divisor, 270 // divisor
    found = compare(blank(*size), *(side.at_size(*size) for side in sides), {}, CompareOptions(time=run.left))
    assert found.candidate.replicates >= 8
    assert clock.now - 100.0 <= 1.05 * 60.0


@pytest.mark.parametrize("divisor", [2, 4])
def test_a_smaller_image_of_the_reference_shows_the_same(divisor):
    """Its pixels are the means of the pixels that they cover.

    This holds up to noise and the pixel filter.
    """
    camera = orthographic(64, 48, 1.5, (0.3, 0.1, 1.0))
    made = ReferenceRenderer(scene(floor(), diffuse(0.5), camera))
    large = made.render(0, 16).radiance
    small = made.at_size(64 // divisor, 48 // divisor).render(0, 16).radiance
    pooled = large.reshape(48 // divisor, divisor, 64 // divisor, divisor, 3).mean(axis=(1, 3))
    assert small.shape == pooled.shape
    assert small.mean() == pytest.approx(pooled.mean(), rel=0.02)


def test_the_corners_of_a_smaller_raster_are_those_of_the_whole():
    camera = orthographic(64, 48, 1.5, (0.3, 0.1, 1.0))
    small = smaller_camera(camera, 16, 12)
    for x, y in ((0, 0), (1, 0), (0, 1), (1, 1)):
        whole = camera.plane_from_raster @ [64 * x, 48 * y, 1]
        assert small.plane_from_raster @ [16 * x, 12 * y, 1] == pytest.approx(whole)
