# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's properties, made from the declared options."""

from dataclasses import dataclass
from pathlib import Path

import bpy
import pytest
from etalon.addon.ui import properties
from etalon.lib.settings.comparison import Settings
from etalon.lib.settings.declaration import Declared, Panel, option
from etalon.lib.settings.presets import PRESETS
from etalon.lib.settings.units import Choice, FilePath, Seconds, Share, Whole


@pytest.fixture
def scene():
    """A scene with the panel's settings."""
    bpy.utils.register_class(properties.EtalonSettings)
    bpy.types.Scene.etalon = bpy.props.PointerProperty(type=properties.EtalonSettings)
    yield bpy.data.scenes.new("panel")
    bpy.data.scenes.remove(bpy.data.scenes["panel"])
    del bpy.types.Scene.etalon
    bpy.utils.unregister_class(properties.EtalonSettings)


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_sets_what_it_names_and_nothing_else(scene, name):
    scene.etalon.confidence = 95.0
    properties.apply_preset(scene, name)
    read = properties.read_settings(scene)
    assert {key: getattr(read, key) for key in PRESETS[name]} == PRESETS[name]
    assert read.changed().keys() <= {*PRESETS[name], "confidence", "threads"}


def test_defaults_of_the_panel_are_those_of_the_settings(scene):
    read = properties.read_settings(scene)
    assert read.changed().keys() <= {"threads"}
    assert scene.etalon.out == "//etalon-out"


def test_what_is_typed_is_what_is_read(scene):
    scene.etalon.tolerance, scene.etalon.confidence, scene.etalon.time = 0.3, 99.9, 90.0
    scene.etalon.partial = True
    read = properties.read_settings(scene)
    assert (read.tolerance, read.confidence, read.time, read.partial) == (0.3 / 100, 99.9 / 100, 90.0, True)


def test_labels_units_and_limits_come_from_the_declaration(scene):
    found = {name: scene.etalon.bl_rna.properties[name] for name in ("tolerance", "time", "out")}
    assert [found[name].name for name in found] == ["Tolerance", "Time", "Output"]
    assert found["tolerance"].subtype == "PERCENTAGE"
    assert found["tolerance"].hard_min == pytest.approx(0.01)
    assert found["tolerance"].hard_max == pytest.approx(50.0)
    assert found["time"].hard_min == 5.0
    assert found["time"].soft_max == 3600.0
    assert found["out"].subtype == "DIR_PATH"
    assert found["tolerance"].description == "Largest relative difference that counts as agreement"


def test_the_panel_shows_what_is_declared_for_it():
    names = [declared.name for declared in properties.SHOWN]
    assert names == [
        *("strategy", "direct", "masking", "model", "fresnel", "sampler", "tolerance", "confidence", "time"),
        *("size", "passes", "lights", "partial", "motion_blur", "out"),
    ]
    assert all(name in properties.EtalonSettings.__annotations__ for name in names)


@dataclass(frozen=True, kw_only=True)
class More(Declared):
    """Options of every kind that a panel may show."""

    share: float = option(0.5, Share(), "a share", panel=Panel("Share"))
    seconds: float = option(3.0, Seconds(), "a time", panel=Panel("Seconds"))
    count: int = option(2, Whole(least=1), "a count", panel=Panel("Count", low=1))
    form: str = option("one", Choice("NAME", "form", ("one", "two")), "a form", panel=Panel("Form"))
    path: Path | None = option(None, FilePath(), "a path", panel=Panel("Path", default="//x"))


def test_a_property_is_made_for_each_kind_of_option():
    group = type(
        "EtalonTestGroup",
        (bpy.types.PropertyGroup,),
        {"__annotations__": {declared.name: properties.make_property(declared) for declared in More.options()}},
    )
    bpy.utils.register_class(group)
    try:
        found = group.bl_rna.properties
        assert found["share"].default == 50.0
        assert found["count"].hard_min == 1
        assert [item.identifier for item in found["form"].enum_items] == ["one", "two"]
        assert found["path"].default == "//x"
        assert found["seconds"].default == 3.0
    finally:
        bpy.utils.unregister_class(group)


def test_no_option_of_the_panel_is_lost_on_the_way_to_the_settings():
    assert {declared.name for declared in properties.SHOWN} <= {declared.name for declared in Settings.options()}
