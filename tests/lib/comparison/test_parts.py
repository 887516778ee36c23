# SPDX-License-Identifier: GPL-3.0-or-later
"""Which parts of the image are asked for, and what is refused."""

import pytest
from etalon.lib.comparison import memory, parts
from etalon.lib.comparison.memory import needed_memory
from etalon.lib.comparison.parts import (
    MOST_COST,
    RAYS_OF_A_PASS,
    PassChoice,
    WhyNot,
    asked_parts,
    choose_passes,
    count_rays,
    fit_memory,
)
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.parts import WORLD, BounceLimit, EmitterLight
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.materials import Material
from etalon.lib.settings.comparison import Settings
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import cube, diffuse, perspective, scene


@pytest.fixture
def reference():
    sun = SunLight("Key", (0.0, 0.0, 1.0), 0.1, (1.0, 1.0, 1.0))
    room = scene(cube(2.0), diffuse(0.5), perspective(2, 2, 1.0, (0.0, 0.0, 0.0)), (sun,), 0.5, bounces=3)
    return ReferenceRenderer(room)


def test_long_paths_have_their_passes_compared_by_default(reference):
    choice = choose_passes(reference, Settings())
    assert (choice.asked, choice.passes, choice.why_not) == ("auto", "all", None)
    assert choice.cost == pytest.approx(RAYS_OF_A_PASS * 3 / count_rays(reference))


def test_passes_that_cost_a_tenth_of_the_time_are_left_out(reference, monkeypatch):
    monkeypatch.setattr(parts, "RAYS_OF_A_PASS", MOST_COST / 3 * count_rays(reference))
    choice = choose_passes(reference, Settings())
    assert (choice.passes, choice.why_not) == ("none", WhyNot.COST)
    assert choose_passes(reference, Settings(passes="all")).passes == "all"


def test_passes_are_left_out_beside_unsupported_materials():
    unknown = Material("Fur", (), "node 'Hair BSDF'", passive=True)
    partly = ReferenceRenderer(scene(cube(2.0), unknown, perspective(2, 2, 1.0, (0.0, 0.0, 0.0)), (), 0.5))
    assert choose_passes(partly, Settings()).why_not is WhyNot.UNSUPPORTED


def test_passes_that_do_not_fit_into_memory_are_left_out_by_default_alone(monkeypatch):
    monkeypatch.setattr(memory, "usable_memory", lambda: needed_memory(100, 100, 2))
    for asked, count, why in (("auto", 3, WhyNot.MEMORY), ("auto", 2, None), ("all", 3, None)):
        assert fit_memory(PassChoice(asked, "all"), tuple(LightPass)[:count], 100, 100).why_not is why


def test_a_path_in_a_black_room_has_one_ray():
    """Each path ends on the first face, and no light is sampled."""
    room = scene(cube(2.0), diffuse(0.0), perspective(8, 6, 1.0, (0.0, 0.0, 0.0)), (), 0.0, bounces=0)
    assert count_rays(ReferenceRenderer(room)) == 1.0


def test_passes_bounces_and_lights_go_together(reference):
    found = asked_parts(reference, Settings(passes="diffuse", bounces="1..3", lights=True))
    passes = LightPass.DIFFUSE_DIRECT, LightPass.DIFFUSE_INDIRECT
    assert found == (*passes, *map(BounceLimit, (1, 2, 3)), EmitterLight("Key"), WORLD)


def test_a_limit_beyond_the_scene_s_is_refused(reference):
    with pytest.raises(
        EtalonError, match=r"--bounces 0\.\.4: the scene ends paths after 3; give 0\.\.3, or raise Max Bounces"
    ):
        asked_parts(reference, Settings(bounces=(0, 4)))


@pytest.mark.parametrize("wrong", ["4..0", "-1..2", "a", "1..", "..2", "1.5", (1, 2, 3), (0, True), 10.0, "0..99999"])
def test_what_is_no_range_is_refused(wrong):
    with pytest.raises(EtalonError, match="bounces"):
        Settings(bounces=wrong)


@pytest.mark.parametrize(("written", "read"), [("0..4", (0, 4)), ("2", (2, 2)), (3, (3, 3)), ([1, 2], (1, 2))])
def test_ranges_are_read(written, read):
    settings = Settings(bounces=written)
    assert settings.bounces == read
    assert Settings.from_json(settings.to_json()).bounces == read
