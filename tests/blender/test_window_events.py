# SPDX-License-Identifier: GPL-3.0-or-later
"""Actions of users in the middle of a comparison, in a window of the real program.

Nothing is lost, and no error is printed.
"""

import pytest
from etalon.tests.blender.hand import RUN, START, STOP, press_button, settle, wait_until

pytestmark = pytest.mark.blender

QUICK = """
scene = bpy.context.scene
scene.render.resolution_percentage, scene.etalon.time = 25, 5.0"""

# Not within a question, which is asked in this very window.
CLOSE_FIRST = """
def close():
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        bpy.ops.wm.window_close()


bpy.app.timers.register(close)"""


def test_a_closed_window_other_scenes_undo_saving_and_another_file_do_no_harm(window, debian, pictures):
    before = window.wait_for("ready", seconds=START)
    # More than it takes to do all of this on a busy machine; opening the other file ends it.
    window.ask("bpy.context.scene.etalon.time, bpy.context.scene.etalon.tolerance = 120.0, 0.1")
    press_button(window, before["box"], pictures / "panel.png")
    assert window.wait_for("halfway", "ended", seconds=RUN)["event"] == "halfway"
    wait_until(window, "bool(session.running.job.bounds)", questions=600)  # there is something to keep
    assert window.ask("bpy.ops.etalon.compare.poll()") is False, "a second press"
    window.ask("bpy.ops.wm.window_new_main()")
    wait_until(window, "len(bpy.context.window_manager.windows) == 2")
    window.ask(CLOSE_FIRST)
    wait_until(window, "len(bpy.context.window_manager.windows) == 1")
    assert window.ask("session.running is not None"), "the window of the button is closed, and the comparison goes on"
    window.ask("bpy.context.window.scene = bpy.data.scenes.new('second')")
    window.ask("bpy.context.window.scene = bpy.data.scenes['lambert_analytic']")
    window.ask("bpy.data.objects.remove(bpy.data.objects['Paper'])")
    window.ask("bpy.ops.ed.undo_push(message='removed')\nbpy.ops.ed.undo()")
    window.ask("bpy.ops.wm.save_mainfile()", seconds=STOP)
    assert window.ask("session.running is not None")
    window.ask("bpy.app.timers.register(lambda: bpy.ops.wm.read_homefile() and None)")
    wait_until(window, "not bpy.data.filepath and session.running is None and not session.results")
    assert (debian.outside / "etalon-out" / "verdict.json").is_file(), "what was gathered is written"
    window.screenshot(pictures / "other_file.png")
    assert window.ask("bpy.ops.etalon.compare.poll()"), "the button works in the other file"


def test_what_is_not_simulated_is_said_and_the_rest_is_compared(window, pictures):
    before = window.wait_for("ready", seconds=START)
    window.ask(QUICK)
    window.ask("""
tree = bpy.data.materials['Paper'].node_tree
node = tree.nodes.new('ShaderNodeBsdfRayPortal')
tree.links.new(node.outputs[0], tree.get_output_node('CYCLES').inputs['Surface'])
bpy.context.view_layer.update()""")
    window.ask("bpy.context.scene.render.engine = 'BLENDER_EEVEE_NEXT'")
    said = """
import bl_ext.user_default.etalon.addon.ui.preflight as preflight
scene = bpy.context.scene
[notice.text for notice in preflight.notices_of_settings(scene) + preflight.survey(scene)]"""
    assert window.ask(said) == [
        "Another engine is chosen; Cycles' render is compared",
        "'Paper': Ray Portal BSDF is not simulated",
    ]
    surveys = "import bl_ext.user_default.etalon.addon.ui.preflight as preflight\npreflight._surveys.get(bpy.context.scene.session_uid)"
    wait_until(window, surveys)
    settle(window)
    window.screenshot(pictures / "notices.png")
    press_button(window, before["box"], pictures / "panel.png")
    window.wait_for("ended", seconds=RUN)
    assert window.ask("[refusal.owner for refusal in session.refusals[bpy.context.scene.session_uid]]") == [
        "material 'Paper'"
    ]
    window.wait_for("shown", seconds=STOP)
    window.screenshot(pictures / "refused.png")


PIN = """
space = [a for a in bpy.context.screen.areas if a.type == 'IMAGE_EDITOR'][0].spaces.active
space.image, space.use_image_pin = bpy.data.images.new('mine', 8, 8), True"""
# Nothing can be written any more, as on a full disk; in this process alone.
FILL_DISK = """
import resource, signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (512, resource.RLIM_INFINITY))"""
EMPTY_DISK = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))"""


def test_the_image_editor_in_french_keeps_a_pinned_image_and_a_full_disk_keeps_the_report(window, debian, pictures):
    before = window.wait_for("ready", seconds=START)
    window.ask(QUICK)
    press_button(window, before["box"], pictures / "panel.png")
    assert window.wait_for("ended", seconds=RUN)["errors"] == []
    window.ask("""
area = max((a for a in bpy.context.screen.areas if a.type == 'VIEW_3D'), key=lambda a: a.width)
area.type = 'IMAGE_EDITOR'
area.spaces.active.show_region_ui = True
bpy.ops.etalon.show_image(view='CYCLES')""")
    shown = "[a for a in bpy.context.screen.areas if a.type == 'IMAGE_EDITOR'][0].spaces.active.image"
    wait_until(window, f"{shown} is not None and {shown}.name == 'Étalon Cycles'")
    window.screenshot(pictures / "cycles.png")
    x, y = before["box"][0] // 2, before["box"][1] + before["box"][3] // 2
    for key, name in (("1", "Reference"), ("3", "Difference"), ("4", "Significance"), ("5", "Verdict")):
        window.hand("mousemove", x, y)
        window.ask("None")
        window.hand("key", key)
        wait_until(window, f"{shown}.name == 'Étalon {name}' and {shown}.size[0] > 0 and {shown}.is_float")
        window.screenshot(pictures / f"{name.lower()}.png")
    assert not window.ask("any(image.is_dirty for image in bpy.data.images)"), "Blender would ask at quitting"
    window.ask("""
view = bpy.context.preferences.view
view.language = next(name for name in ('fr_FR', 'fr') if name in bpy.app.translations.locales)
view.use_translate_interface = True""")
    assert window.ask("bpy.app.translations.pgettext_iface('Compare the Rest')") == "Comparer le reste"
    settle(window)
    window.screenshot(pictures / "french.png")
    window.ask(PIN)
    window.ask("bpy.ops.etalon.show_image(view='CYCLES')")
    wait_until(window, "len(bpy.context.window_manager.windows) == 2")
    assert window.ask(f"{shown}.name") == "mine", "a pinned editor keeps its image"
    folder = debian.outside / "etalon-out"
    report = (folder / "verdict.json").read_bytes()
    window.ask("bpy.ops.etalon.compare('INVOKE_DEFAULT')\nNone")
    wait_until(window, "session.running is not None and session.running.job.fraction > 0")
    window.ask(FILL_DISK)
    ended = window.wait_for("ended", seconds=RUN)
    window.ask(EMPTY_DISK)
    assert ended["errors"]
    assert all("cannot be written (" in error for error in ended["errors"])
    assert (folder / "verdict.json").read_bytes() == report, "the report before is whole"
    assert not list(folder.glob(".unfinished-*"))
    settle(window)
    window.screenshot(pictures / "full_disk.png")
