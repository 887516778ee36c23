# SPDX-License-Identifier: GPL-3.0-or-later
"""A small object of an unsupported material in a closed room.

Most regions are judged, and none wrongly.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.run import TimedRun
from etalon.lib.comparison.unsupported import UnsupportedLight, find_unsupported_light
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.regions import RegionMoments, image_regions
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.report.summary import summarize
from etalon.lib.report.words import sentences
from etalon.lib.scene.lights import AreaLight
from etalon.lib.scene.materials import Diffuse, Glossy, Material, Transparent
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.coverage import coverage
from etalon.lib.wavefront.reach import reached, seen
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import color, cube, diffuse, emission, floor, material, perspective, quad, scene

OPTIONS = CompareOptions(tolerance=0.1, time=None, samples=48, replicates=12)
HAIR = Material("hair", (), "node 'Hair BSDF'", passive=True)
LAMP = AreaLight(
    "lamp", (0.0, 0.0, 3.9), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", (9.0, 9.0, 9.0), 4.0
)


def room(of_cube, walls=0.6):
    """A closed room under a lamp, seen from inside.

    A small cube stands near a corner.
    """
    inside = cube(2.0, (0.0, 0.0, 2.0), 0)
    small = cube(0.15, (-1.3, 1.4, 0.15), 1)
    view = perspective(24, 16, 1.2, (0.0, -1.8, 2.0), (0.0, 1.8, -0.9))
    return scene([inside, small], [diffuse(walls), of_cube], view, lights=[LAMP], bounces=4)


@cache
def what_hair_may_send():
    """The room without the cube's material, and the light that could come from the cube: one for all candidates."""
    partial = room(HAIR)
    return partial, find_unsupported_light(ReferenceRenderer(partial, Options(threads=1)), TimedRun(None, NO_PROGRESS))


def judged(truth, seed, options=OPTIONS):
    """The comparison of a reference without the cube's material.

    The candidate has all of `truth`.
    """
    partial, light = what_hair_may_send()
    reference = ReferenceRenderer(partial, Options(seed=seed, threads=1))
    candidate = ReferenceRenderer(truth, Options(seed=seed + 1, threads=1))
    return compare(partial, reference, candidate, coverage(reference.kernel), options, unsupported=light)


def cells(found):
    """The outcomes of the finest regions that have pixels left."""
    regions, verdict = found.regions, found.verdict
    return verdict.outcomes[(regions.families == regions.families.max()) & (verdict.excluded < regions.sizes)]


TRUTHS = {
    "black": Diffuse(color(0.0)),
    "white": Diffuse(color(1.0)),
    "clear": Transparent(color(1.0)),
    "mirror": Glossy("GGX", color(1.0)),
}


@pytest.mark.parametrize(
    "truth", [pytest.param(x, marks=pytest.mark.slow) for x in ("white", "black", "clear", "mirror")]
)
def test_whatever_the_unsupported_material_is_nothing_differs(truth, seed):
    found = judged(room(material(TRUTHS[truth])), seed)
    assert not (found.verdict.outcomes == Outcome.DIFFERENT).any()
    assert (cells(found) == Outcome.EQUIVALENT).mean() > 0.5
    assert 0.0 < found.left_out.mean() < 0.05


@pytest.mark.slow
def test_a_darker_candidate_differs_and_a_brighter_one_stays_open(seed):
    """Light that is missing from the reference can explain a brighter candidate.

    It can never explain a darker one.
    """
    few = replace(OPTIONS, samples=24, replicates=8)
    darker = judged(room(diffuse(0.5), walls=0.45), seed, few)
    assert darker.verdict.outcome is Outcome.DIFFERENT
    assert (cells(darker) == Outcome.DIFFERENT).mean() > 0.5
    brighter = judged(room(diffuse(0.5), walls=0.75), seed, few)
    assert brighter.verdict.outcome is Outcome.UNDECIDED
    assert set(brighter.verdict.outcomes) == {Outcome.UNDECIDED}
    assert brighter.verdict.blocked.any()
    said = " ".join([*sentences(brighter), *summarize(brighter)])
    assert "too noisy" not in said
    assert "regions are open because of an unsupported material." in said
    assert "Next: replace the unsupported material to judge the rest; more time shows no more." in said
    assert "open because of an unsupported material" in said
    assert "they show materials that are not simulated: 'hair' (node 'Hair BSDF')" in said


def test_the_room_is_what_a_white_plate_sends_to_a_floor(seed):
    """A plate at height h above the floor, under a uniform sky, and no light below.

    The floor sees the plate with a form factor F. The floor beneath the middle of a square of half-width a gets F = 4
    / pi (x / s) atan(x / s) of its light from there, x = a / h and s = sqrt(1 + x^2) (a quarter of it: Howell, "A
    catalog of radiation configuration factors", B-3). Where light passes straight, that is all the sky's; the
    reference has none of it, so the room is F / (1 - F).
    """
    plate = quad((-0.5, -0.5, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1)
    view = perspective(8, 8, 0.02, (0.0, 0.0, 0.9), (0.0, 0.0, -1.0))
    below = scene([floor(50.0), plate], [diffuse(0.5), HAIR], view, world=1.0, bounces=0)
    reference = ReferenceRenderer(below, Options(seed=seed, threads=1))
    light = find_unsupported_light(reference, TimedRun(None, NO_PROGRESS))
    side = RegionMoments(image_regions(8, 8, {}, (16,)))
    for k in range(8):
        side.add(reference.render(k, 64).radiance)
    ratio = 0.5 / np.sqrt(1.25)
    factor = 4.0 / np.pi * ratio * np.arctan(ratio)
    assert light.room(side, 1e-3)[0] == pytest.approx(factor / (1.0 - factor), rel=0.1)
    assert light.is_in(side).all()


def test_what_may_emit_has_no_bound_and_what_shows_it_is_left_out():
    mirrored = room(HAIR)
    assert find_unsupported_light(ReferenceRenderer(room(Material("a", (), "b"))), TimedRun(None, NO_PROGRESS)) is None
    assert find_unsupported_light(ReferenceRenderer(room(emission(1.0))), TimedRun(None, NO_PROGRESS)) is None
    plain = ReferenceRenderer(mirrored, Options(threads=1))
    walls = replace(mirrored, materials=(material(Glossy("GGX", color(0.9))), HAIR))
    mirrors = ReferenceRenderer(walls, Options(threads=1))
    assert seen(plain).mean() < 0.05 < seen(mirrors).mean()
    assert reached(plain).mean() > 0.5  # which was left out before


def test_light_passes_are_refused(seed):
    reference, nowhere = ReferenceRenderer(room(HAIR), Options(seed=seed, threads=1)), np.zeros((16, 24), bool)
    light = UnsupportedLight(nowhere, nowhere, ())
    with pytest.raises(EtalonError, match="leave out --passes"):
        compare(reference.scene, reference, reference, {}, OPTIONS, unsupported=light, passes=[LightPass.EMISSION])
