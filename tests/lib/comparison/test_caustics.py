# SPDX-License-Identifier: GPL-3.0-or-later
"""Caustics by region: their share, and the room that claims leave for them."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.comparison import caustics
from etalon.lib.comparison.caustics import LEAST, UNLIMITED, Caustics, caustics_in, scout
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.run import TimedRun
from etalon.lib.film.regions import image_regions
from etalon.lib.light_tracing.scouting import Scouted
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.renderers import Painter, blank, grey

WIDTH, HEIGHT, BATCHES = 32, 20, 4


def scouted(value=0.05, brightness=1e4):
    """Each pixel of the left half receives `value` by caustics, in every batch."""
    _, columns = np.divmod(np.arange(WIDTH * HEIGHT), WIDTH)
    left = np.flatnonzero(columns < 16)
    pixel = np.tile(left, BATCHES)
    batch = np.repeat(np.arange(BATCHES), left.size)
    return Scouted(
        (HEIGHT, WIDTH),
        BATCHES,
        pixel,
        batch,
        np.full((3, pixel.size), value),
        np.full(pixel.size, brightness),
        1000,
        0.1,
    )


def test_each_region_gets_its_own_light_by_caustics():
    regions = image_regions(HEIGHT, WIDTH, {"object": [("Right", np.arange(WIDTH)[None] * np.ones((HEIGHT, 1)) >= 16)]})
    found = caustics_in(scouted(), regions)
    expected = {"whole image": 0.025, "Right": 0.0}
    for name, radiance, brightness in zip(regions.names, found.radiance, found.brightness, strict=True):
        wanted = expected.get(name, 0.05 if name.startswith("x 0 to 15") else 0.0)
        # Some more may come by contributions that were not met: a few of the mean size, 0.05 of one pixel in one batch.
        assert (wanted <= radiance + 1e-12).all()
        assert (radiance <= wanted + 6 * 0.05 / (4 * 16 * BATCHES)).all()
        assert brightness == 1e4


def test_nothing_is_lit_where_no_face_is_seen():
    """Without it, a few contributions that were not met may still fall anywhere."""
    columns = np.arange(WIDTH)[None] * np.ones((HEIGHT, 1), int)
    found = [
        caustics_in(replace(scouted(), bare=bare), image_regions(HEIGHT, WIDTH, {})) for bare in (None, columns >= 16)
    ]
    right = image_regions(HEIGHT, WIDTH, {}).names.index("x 16 to 31, y 0 to 19")
    assert [one.radiance[right].any() for one in found] == [True, False]
    assert [one.bare.tolist() for one in found] == [[False] * 3, [False, False, True]]


def test_lamps_without_size_are_left_out():
    regions = image_regions(HEIGHT, WIDTH, {})
    found = caustics_in(scouted(brightness=np.inf), regions)
    assert not found.radiance.any()
    assert not found.brightness.any()


def test_uncertain_light_counts_as_more():
    one = scouted()
    regions = image_regions(HEIGHT, WIDTH, {})
    spread = np.array([0.0, 0.0, 0.0, 4.0])[one.batch]
    uncertain = Scouted(
        one.shape, one.batches, one.pixel, one.batch, one.value * spread, one.brightness, one.paths, one.seconds
    )
    # The mean stays 0.05; four batches of 0, 0, 0 and 0.2 have a standard error of 0.05.
    left = caustics_in(uncertain, regions).radiance[1]
    assert left == pytest.approx(0.05 + 3 * 0.05, rel=0.01)


def test_the_room_is_no_more_than_what_arrives_and_shrinks_with_samples():
    found = Caustics(np.full((2, 3), 0.05), np.array([1e4, 10.0]), np.zeros(2, bool))
    reference, floor, level = np.ones((2, 3)), np.full(3, 1e-3), np.exp(-5.0)
    assert found.room(reference, floor, np.array([1e4, 1e4]), level) == pytest.approx([0.05, 0.005])
    assert found.room(reference, floor, np.array([1e7, 1e7]), level) == pytest.approx([0.005, 5e-6])
    assert found.room(reference, floor, np.array([0.0, 0.0]), level) == pytest.approx([0.05, 0.05])


def test_a_region_lit_by_caustics_is_not_equivalent_before_it_can_have_met_them():
    """Both sides agree exactly; nothing is claimed where light may have been missed."""
    options = CompareOptions(time=None, samples=1024, replicates=16)
    sides = [Painter(name, grey(1.0, WIDTH, HEIGHT), 0.01) for name in ("the reference", "Cycles")]
    found = compare(blank(WIDTH, HEIGHT), *sides, {}, options, scouted=scouted(brightness=1e6))
    named = dict(zip(found.regions.names, found.verdict.outcomes, strict=True))
    assert named["x 0 to 15, y 0 to 19"] is Outcome.UNDECIDED
    assert named["x 16 to 31, y 0 to 19"] is Outcome.EQUIVALENT
    assert found.verdict.is_rare[found.regions.names.index("x 0 to 15, y 0 to 19")]
    assert found.caustics.max() == pytest.approx(0.05, rel=0.03)
    free = compare(blank(WIDTH, HEIGHT), *sides, {}, options, scouted=scouted(brightness=10.0))
    assert free.verdict.outcome is Outcome.EQUIVALENT


@pytest.mark.parametrize(("seconds", "least"), [(1.0, LEAST), (None, UNLIMITED)])
def test_a_trial_that_meets_nothing_is_no_proof(monkeypatch, seconds, least):
    """The pass is made all the same, with the rays that it is due."""
    asked = []

    def nothing(kernel, paths, progress):
        asked.append(paths)
        none = np.zeros(0, int)
        return Scouted((HEIGHT, WIDTH), BATCHES, none, none, np.zeros((3, 0)), np.zeros(0), paths, 10.0)

    monkeypatch.setattr(caustics, "scout_caustics", nothing)
    scout(ReferenceRenderer(blank(WIDTH, HEIGHT)).kernel, TimedRun(seconds, NO_PROGRESS))
    assert asked[-1] == least
