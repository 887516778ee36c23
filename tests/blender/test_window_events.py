# SPDX-License-Identifier: GPL-3.0-or-later
"""What users do in the middle of a comparison, in a window of the real program: nothing is lost, and no error is printed."""

import pytest
from etalon.tests.blender.hand import RUN, START, STOP, press_button, wait_until

pytestmark = pytest.mark.blender


def test_other_scenes_undo_saving_and_another_file_do_no_harm(window, debian, tmp_path):
    before = window.wait_for("ready", seconds=START)
    press_button(window, before["box"], tmp_path / "panel.png")
    assert window.wait_for("halfway", "ended", seconds=RUN)["event"] == "halfway"
    assert window.ask("bpy.ops.etalon.compare.poll()") is False, "a second press"
    window.ask("bpy.context.window.scene = bpy.data.scenes.new('second')")
    window.ask("bpy.context.window.scene = bpy.data.scenes['lambert_analytic']")
    window.ask("bpy.data.objects.remove(bpy.data.objects['Paper'])")
    window.ask("bpy.ops.ed.undo_push(message='removed')\nbpy.ops.ed.undo()")
    window.ask("bpy.ops.wm.save_mainfile()", seconds=STOP)
    assert window.ask("session.running is not None")
    window.ask("bpy.app.timers.register(lambda: bpy.ops.wm.read_homefile() and None)")
    wait_until(window, "not bpy.data.filepath and session.running is None and not session.results")
    assert (debian.outside / "etalon-out" / "verdict.json").is_file(), "what was gathered is written"
    window.screenshot(tmp_path / "other_file.png")
    assert window.ask("bpy.ops.etalon.compare.poll()"), "the button works in the other file"


def test_closing_blender_ends_the_comparison(window, debian, tmp_path):
    before = window.wait_for("ready", seconds=START)
    press_button(window, before["box"], tmp_path / "panel.png")
    assert window.wait_for("halfway", "ended", seconds=RUN)["event"] == "halfway"
    window.ask("bpy.app.timers.register(lambda: bpy.ops.wm.quit_blender() and None, first_interval=0.5)")
    window.process.wait(timeout=STOP)
    processes = debian.run("sh", "-c", "for p in /proc/[0-9]*/cmdline; do tr '\\0' ' ' <$p; echo; done").stdout
    assert not [one for one in processes.split("\n") if "cycles/worker.py" in one and str(debian.home) in one]
