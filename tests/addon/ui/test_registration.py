# SPDX-License-Identifier: GPL-3.0-or-later
"""What is registered with Blender.

It comes and goes, and every icon exists in this release.
"""

import ast
from pathlib import Path

import bpy
import pytest
from etalon.addon import ui
from etalon.addon.ui import panels, registration
from etalon.addon.ui.operators import job
from etalon.lib.errors import EtalonError
from etalon.lib.report.ranking import RankedRegion
from etalon.lib.verdict.outcome import Outcome


def test_everything_that_is_registered_can_be_taken_back():
    for _ in range(2):
        registration.register()
        try:
            assert hasattr(bpy.types.Scene, "etalon")
            assert "compare" in dir(bpy.ops.etalon)
        finally:
            registration.unregister()
        assert not hasattr(bpy.types.Scene, "etalon")
        assert not hasattr(bpy.types.WindowManager, "etalon_regions")


@pytest.mark.parametrize("stops", [None, "no camera"])
def test_what_compare_the_rest_switches_comes_back_where_nothing_starts(monkeypatch, tmp_path, stops):
    """Beside Motion blur, Partial would be refused: it is off while the rest is compared."""
    asked = []

    class Job:
        def __init__(self, scene, settings, *_):
            asked.append((settings.partial, settings.motion_blur))
            raise EtalonError("the disk is full; make room")

    monkeypatch.setattr(job, "BackgroundJob", Job)
    bpy.ops.wm.read_factory_settings()
    registration.register()
    try:
        scene = bpy.context.scene
        scene.etalon.out, scene.etalon.motion_blur = str(tmp_path), True
        if stops:
            scene.camera = None
        with pytest.raises(RuntimeError, match="no camera" if stops else "disk is full"):
            bpy.ops.etalon.compare_the_rest()
        assert asked == ([] if stops else [(True, False)])
        assert (scene.etalon.partial, scene.etalon.motion_blur) == (False, True)
    finally:
        registration.unregister()


def test_the_panel_of_the_render_properties_has_no_header_so_that_blender_keeps_it_above():
    places = [panel for panel in panels.PANELS if panel.bl_space_type == "PROPERTIES"]
    assert [panel.__name__ for panel in places] == ["ETALON_PT_render_main"]
    assert "HIDE_HEADER" in places[0].bl_options


def test_every_icon_exists():
    known = {item.identifier for item in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items}
    used = {f"{panels._PREFIX}_{number:02}" for number in panels.COLOURS.values()}
    for path in Path(ui.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.keyword) and node.arg == "icon":
                used |= {one.value for one in ast.walk(node.value) if isinstance(one, ast.Constant) and one.value}
    assert used - known == set()
    assert len(used) > 8


def test_a_list_of_ten_thousand_regions_is_filled():
    registration.register()
    try:
        box = (0.0, 0.0, 1.0, 1.0)
        regions = [
            RankedRegion("block", "", f"top {k}, 0", Outcome.EQUIVALENT, 0.0, 0.0, 0.0, 0.0, "R", box)
            for k in range(10000)
        ]
        result = type("Shown", (), {"regions_of": lambda self, part: regions})()
        registration.session.results[7] = result
        window_manager = bpy.data.window_managers[0]
        registration.regions.fill_tables(window_manager)
        (table,) = window_manager.etalon_regions
        assert table.name == "7"
        assert [len(table.rows), table.rows[-1].name] == [10000, "top 9999, 0"]
    finally:
        registration.unregister()
