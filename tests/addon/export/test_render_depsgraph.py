# SPDX-License-Identifier: GPL-3.0-or-later
"""The depsgraph is a render's, and the scene's settings come back."""

import bpy
import pytest
from etalon.addon.export.render_depsgraph import with_render_depsgraph
from etalon.lib.errors import EtalonError


@pytest.fixture
def scene():
    """The factory scene with a modified cube.

    Its cube is subdivided once in viewports, three times in renders, and hidden in viewports.
    """
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    cube = bpy.data.objects["Cube"]
    modifier = cube.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 3
    cube.hide_viewport = True
    bpy.context.scene.render.use_persistent_data = True
    return bpy.context.scene


def settings(scene):
    """What the export borrows."""
    render = scene.render
    return (
        render.engine,
        render.use_compositing,
        render.use_sequencer,
        render.use_persistent_data,
        render.use_freestyle,
    )


def test_it_is_evaluated_for_a_render(scene):
    def faces(depsgraph):
        return depsgraph.mode, {
            i.object.name: len(i.object.data.polygons) for i in depsgraph.object_instances if i.object.type == "MESH"
        }

    before = settings(scene)
    assert with_render_depsgraph(scene, faces) == ("RENDER", {"Cube": 6 * 4**3})
    assert settings(scene) == before


def test_what_the_function_raises_arrives_and_the_settings_come_back(scene):
    before = settings(scene)
    with pytest.raises(ZeroDivisionError):
        with_render_depsgraph(scene, lambda depsgraph: 1 / 0)
    assert settings(scene) == before
    assert with_render_depsgraph(scene, lambda depsgraph: 3) == 3


def test_lines_of_freestyle_are_not_drawn_over_what_is_no_image(scene):
    """Blender would die: the exporter has no image."""
    scene.render.use_freestyle = scene.view_layers[0].use_freestyle = True
    scene.view_layers[0].freestyle_settings.linesets.new("lines")
    before = settings(scene)
    assert with_render_depsgraph(scene, lambda depsgraph: depsgraph.mode) == "RENDER"
    assert settings(scene) == before


def test_several_view_layers_are_one_export(scene):
    scene.view_layers.new("second")
    calls = []
    with_render_depsgraph(scene, lambda depsgraph: calls.append(depsgraph.view_layer.name))
    assert calls == ["ViewLayer"]


def test_a_render_region_without_a_whole_pixel_is_one_line(scene):
    before = settings(scene)
    scene.render.use_border = True
    scene.render.border_min_x, scene.render.border_max_x = 0.3, 0.3001
    with pytest.raises(EtalonError, match=r"^Scene: its render region holds no whole pixel; widen the region"):
        with_render_depsgraph(scene, lambda depsgraph: 3)
    scene.render.use_border = False
    assert settings(scene) == before


def test_a_scene_without_a_layer_to_render_is_refused(scene):
    scene.view_layers[0].use = False
    with pytest.raises(EtalonError, match="Scene: no view layer is used for rendering"):
        with_render_depsgraph(scene, lambda depsgraph: depsgraph.mode)
