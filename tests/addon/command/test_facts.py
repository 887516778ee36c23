# SPDX-License-Identifier: GPL-3.0-or-later
"""What a batch asks of a scene, and the view layer that a command renders."""

import bpy
import pytest
from etalon.addon.command.facts import read_facts
from etalon.addon.command.opening import open_target
from etalon.lib.errors import EtalonError
from etalon.reference_scenes import building


@pytest.fixture
def room(tmp_path):
    """A scene with two view layers, an image, a sequence and tiles beside it, saved as a file."""
    scene = building.start("room", 8, 8, 0)
    building.camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), ortho_scale=1.0)
    scene.view_layers[0].name = "Wide"
    scene.view_layers.new("Near")
    scene.frame_start, scene.frame_end = 3, 7
    for name in ("wood.png", "smoke_001.png", "smoke_002.png", "tile.1001.png", "tile.1002.png", "other.png"):
        (tmp_path / name).touch()
    for name, source in (("wood.png", "FILE"), ("smoke_001.png", "SEQUENCE"), ("tile.<UDIM>.png", "TILED")):
        image = bpy.data.images.new(name, 1, 1)
        image.source, image.filepath = source, str(tmp_path / name)
        image.use_fake_user = True
    return tmp_path


def test_facts_are_those_of_the_scene_and_every_file_that_it_shows(room):
    facts = read_facts()
    assert facts["frames"] == [3, 7]
    assert facts["view_layers"] == ["Wide", "Near"]
    assert len(facts["cameras"]) == 1
    names = {path.rpartition("/")[2] for path in facts["files"]}
    assert {"wood.png", "smoke_001.png", "smoke_002.png", "tile.1001.png", "tile.1002.png"} <= names
    assert "other.png" not in names


def test_the_view_layer_that_is_asked_for_is_the_only_one_used(room):
    open_target(None, view_layer="Near")
    assert [layer.name for layer in bpy.context.scene.view_layers if layer.use] == ["Near"]
    with pytest.raises(
        EtalonError, match="Far: no view layer of that name in scene room; view layers there: Near, Wide"
    ):
        open_target(None, view_layer="Far")
