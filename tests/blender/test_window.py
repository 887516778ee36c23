# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's button, pressed with a mouse in a window of the real program."""

import json

import pytest
from etalon.tests.blender.hand import LIST_ROW, RUN, START, STOP, click, find, press_button, settle

pytestmark = pytest.mark.blender


def test_the_button_compares_and_leaves_everything_as_it_was(window, debian, pictures):
    before = window.wait_for("ready", seconds=START)
    press_button(window, before["box"], pictures / "panel.png")
    window.wait_for("started", seconds=START)
    assert window.wait_for("halfway", "ended", seconds=RUN)["event"] == "halfway"
    window.screenshot(pictures / "running.png")
    ended = window.wait_for("ended", seconds=RUN)
    window.wait_for("shown", seconds=STOP)
    window.screenshot(pictures / "ended.png")
    assert ended["errors"] == []
    assert ended["outcome"] in {"EQUIVALENT", "UNDECIDED"}
    assert ended["state"] == before["state"]
    assert ended["fractions"] > 10, "the window was not alive while the comparison ran"
    folder = debian.root / ended["folder"].lstrip("/")
    assert json.loads((folder / "verdict.json").read_text())["verdict"] == ended["outcome"]


def folders_in(debian):
    return {path.name for path in debian.outside.glob("etalon-*") if path.is_dir()}


def workers_in(debian):
    """The command lines of second Blenders."""
    processes = debian.run("sh", "-c", "for p in /proc/[0-9]*/cmdline; do tr '\\0' ' ' <$p; echo; done").stdout
    return [one for one in processes.split("\n") if "cycles/worker.py" in one and str(debian.home) in one]


def test_esc_cancels_the_button_works_again_and_closing_blender_ends_the_comparison(window, debian, pictures):
    before, there = window.wait_for("ready", seconds=START), folders_in(debian)
    press_button(window, before["box"], pictures / "panel.png")
    assert window.wait_for("halfway", "ended", seconds=RUN)["event"] == "halfway"
    window.hand("key", "Escape")
    ended = window.wait_for("ended", seconds=STOP)
    assert ended["errors"] == []
    assert ended["stopped"] in {None, "cancelled"}
    assert folders_in(debian) - there <= {"etalon-out"}, "temporary files were left behind"
    assert ended["state"] == before["state"]
    window.wait_for("shown", seconds=STOP)
    window.screenshot(pictures / "cancelled.png")
    assert workers_in(debian) == []
    press_button(window, before["box"], pictures / "panel.png")
    assert window.wait_for("halfway", "ended", seconds=RUN)["event"] == "halfway"
    assert workers_in(debian)
    window.ask("bpy.app.timers.register(lambda: bpy.ops.wm.quit_blender() and None, first_interval=0.5)")
    window.process.wait(timeout=STOP)
    assert workers_in(debian) == []


def test_a_click_on_a_region_shows_it_and_undo_takes_that_back(window, pictures):
    before = window.wait_for("ready", seconds=START)
    press_button(window, before["box"], pictures / "panel.png")
    assert window.wait_for("ended", seconds=RUN)["errors"] == []
    window.wait_for("shown", seconds=STOP)
    x, y = find(window, before["box"], pictures / "result.png", (0.0, 1.0, 0.0))
    state = """
scene = bpy.context.scene
render, result = scene.render, session.result_of(scene)
border = render.use_border, render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y
selected = sorted(thing.name for thing in bpy.context.view_layer.objects if thing.select_get())
{"border": border, "selected": selected, "stale": result.is_stale(scene), "second": vars(result.regions[1]) | {"outcome": ""}}"""
    first = window.ask(state)
    assert not first["stale"]
    click(window, x - 40, y + LIST_ROW)
    after = window.ask(state)
    window.screenshot(pictures / "region.png")
    left, top, right, bottom = after["second"]["box"]
    assert after["border"][0]
    assert after["border"][1:] == pytest.approx([left, right, 1 - bottom, 1 - top])
    if after["second"]["kind"] == "object":
        assert after["selected"] == [after["second"]["name"]]
    assert not after["stale"], "a selection is no change"
    window.hand("mousemove", before["box"][0] - 200, y, "key", "ctrl+z")
    undone = window.ask(state)
    assert (undone["border"][0], undone["selected"]) == (first["border"][0], first["selected"])
    window.ask("bpy.data.objects.remove(bpy.context.view_layer.objects[0])\nbpy.context.view_layer.update()")
    assert window.ask(state)["stale"]
    for number in range(3):
        click(window, x - 40, y + number * LIST_ROW)
    window.ask("bpy.ops.ed.undo()\nNone")


def test_the_panel_stands_below_the_engine_in_the_render_properties(window, pictures):
    window.wait_for("ready", seconds=START)
    window.ask(
        "max((a for a in bpy.context.screen.areas if a.type == 'VIEW_3D'), key=lambda a: a.width).type = 'PROPERTIES'"
    )
    settle(window)  # an editor knows its tabs once it has been drawn
    box = window.ask("""
area = max((a for a in bpy.context.screen.areas if a.type == 'PROPERTIES'), key=lambda a: a.width)
area.spaces.active.context = 'RENDER'
region = next(r for r in area.regions if r.type == 'WINDOW')
[region.x, bpy.context.window.height - region.y - region.height, region.width, region.height]""")
    settle(window)
    _, y = find(window, box, pictures / "properties.png", (1.0, 0.0, 1.0))
    assert y < box[1] + box[3] / 3
