# SPDX-License-Identifier: GPL-3.0-or-later
"""Which parts of the image are asked for, and what is refused."""

import pytest
from etalon.lib.comparison.parts import asked_parts
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.parts import WORLD, BounceLimit, EmitterLight
from etalon.lib.scene.lights import SunLight
from etalon.lib.settings.comparison import Settings
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import cube, diffuse, perspective, scene


@pytest.fixture
def reference():
    sun = SunLight("Key", (0.0, 0.0, 1.0), 0.1, (1.0, 1.0, 1.0))
    room = scene(cube(2.0), diffuse(0.5), perspective(2, 2, 1.0, (0.0, 0.0, 0.0)), (sun,), 0.5, bounces=3)
    return ReferenceRenderer(room)


def test_nothing_is_asked_for_by_default(reference):
    assert asked_parts(reference, Settings()) == ()


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
