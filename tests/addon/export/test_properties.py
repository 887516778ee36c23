# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' settings in this Blender: each stands in a table, or is refused when it is not at its default."""

import bpy
import pytest
from etalon.addon.cycles.neutral import neutral
from etalon.addon.export import properties
from etalon.lib.errors import Refused

REFUSED = {"world.cycles": {"use_shadows"}}
"""Settings that stand in no table on purpose: another value than the default is refused."""


@pytest.fixture
def settings(studio):
    studio.quad()
    lamp = studio.add("lamp", bpy.data.lights.new("lamp", "POINT"))
    studio.scene.world = bpy.data.worlds.new("world")
    return {
        "cycles": studio.scene.cycles,
        "view_layer.cycles": studio.layer.cycles,
        "object.cycles": bpy.data.objects["quad"].cycles,
        "light.cycles": lamp.data.cycles,
        "material.cycles": studio.plain.cycles,
        "world.cycles": studio.scene.world.cycles,
    }


@pytest.mark.parametrize("group", sorted(properties.IRRELEVANT))
def test_every_setting_of_this_blender_stands_in_a_table_or_is_refused(settings, group):
    assert set(properties.undeclared(group, settings[group])) <= REFUSED.get(group, set())


@pytest.mark.parametrize("group", sorted(properties.IRRELEVANT))
def test_no_setting_is_both_neutral_and_irrelevant(settings, group):
    irrelevant = {name for names in properties.IRRELEVANT[group].values() for name in names.split()}
    with neutral(bpy.context.scene) as changes:
        held = {path.removeprefix(group + ".") for path in changes.settings if path.startswith(group + ".")}
    assert irrelevant & held == set()


@pytest.mark.parametrize(
    ("group", "name", "value"),
    [
        ("cycles", "tile_size", 64),
        ("view_layer.cycles", "pass_debug_sample_count", True),
        ("object.cycles", "ao_distance", 1.0),
        ("light.cycles", "max_bounces", 500),
        ("material.cycles", "volume_step_rate", 2.0)
        if bpy.app.version < (5, 0)
        else ("cycles", "min_light_bounces", 3),
        ("world.cycles", "sample_map_resolution", 512),
    ],
)
def test_a_setting_in_no_table_is_refused_where_it_is_changed(studio, settings, monkeypatch, group, name, value):
    """Plants a setting that is new: its row is taken out of the tables."""
    monkeypatch.setitem(properties._undeclared, group, (name,))
    studio.export()
    setattr(settings[group], name, value)
    with pytest.raises(Refused, match=rf"Cycles' setting '.*' \({name}\) is not simulated; set it back to its default"):
        studio.export()


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="the world's switch Shadows is new in Blender 5")
def test_a_world_that_casts_no_shadows_is_refused(studio, settings):
    settings["world.cycles"].use_shadows = False
    with pytest.raises(Refused, match="world 'world': Cycles' setting 'Shadows'"):
        studio.export()
