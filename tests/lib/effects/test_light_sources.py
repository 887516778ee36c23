# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether one light object is all that shines."""

from dataclasses import replace

import pytest
from etalon.lib.effects.light_sources import has_one_light
from etalon.lib.scene.lights import PointLight
from etalon.lib.scene.materials import Material
from etalon.lib.scene.volumes import Volume
from etalon.tests.scenes import diffuse, emission, floor, perspective, scene

LAMP = PointLight("lamp", (0.0, 0.0, 2.0), (1.0, 1.0, 1.0))
PAPER = diffuse(0.5)
CAMERA = perspective(2, 2, 0.5, (0.0, 0.0, 3.0))


def lit(materials=(PAPER,), lights=(LAMP,), **more):
    return scene([floor(material=k) for k in range(len(materials))], materials, CAMERA, lights, **more)


def test_a_lamp_in_a_black_world_is_one_light():
    assert has_one_light(lit())
    assert has_one_light(lit(materials=(PAPER, emission(0.0))))


@pytest.mark.parametrize(
    "other",
    [
        lit(lights=()),
        lit(lights=(LAMP, replace(LAMP, name="other"))),
        lit(world=0.1),
        lit(materials=(PAPER, emission(1.0))),
        lit(materials=(PAPER, Material("hair", (), unknown="a hair shader"))),
        lit(materials=(PAPER, Material("glow", (), volume=Volume(emission=(1.0, 0.0, 0.0)), only_bounds=True))),
    ],
    ids=["none", "two lamps", "a world", "a face", "an unsupported material", "a volume"],
)
def test_whatever_else_may_shine_counts(other):
    assert not has_one_light(other)
