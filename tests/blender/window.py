# SPDX-License-Identifier: GPL-3.0-or-later
"""The script inside the windowed Blender.

It shows the panel, answers questions, and prints the progress of the comparison as lines of JSON.
"""

import ast
import json
import sys
import time
from pathlib import Path

import bpy
from bl_ext.user_default.etalon.addon.ui.session import session

# No other button has this colour, so that the test finds the panel's on a picture of the screen, as a user's eye does; nor has any
# row of a list the other one.
BUTTON, ROW = (1.0, 0.0, 1.0, 1.0), (0.0, 1.0, 0.0, 1.0)
QUESTION = Path(__file__).with_name("question.py")
# Ticks after the end by which the panel has been drawn again and has loaded its pictures.
SHOWN = 15


def report(event, **facts):
    sys.stdout.write("ETALON " + json.dumps({"event": event, **facts}, default=str) + "\n")
    sys.stdout.flush()


def user_state():
    """What a comparison must leave as it is."""
    scene = bpy.context.scene
    kinds = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}
    cycles, render = (
        {name: repr(getattr(owner, name)) for name, rna in owner.bl_rna.properties.items() if rna.type in kinds}
        for owner in (scene.cycles, scene.render)
    )
    counts = {name: len(getattr(bpy.data, name)) for name in ("images", "objects", "materials", "scenes", "meshes")}
    return {"cycles": cycles, "render": render, "counts": counts, "file": bpy.data.filepath, "dirty": bpy.data.is_dirty}


def answer():
    """Run the statements that the test has left, and report the result.

    It is the value of the last one if it is an expression, or the error.
    """
    tree = ast.parse(QUESTION.read_text())
    QUESTION.unlink()
    last = ast.Expression(tree.body.pop().value) if isinstance(tree.body[-1], ast.Expr) else None
    space = {"bpy": bpy, "session": session}
    try:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            exec(compile(tree, "question", "exec"), space)
            report("answer", value=eval(compile(last, "question", "eval"), space) if last else None)
    except Exception as error:
        report("answer", value=None, error=repr(error))


class Watch:
    """A timer that never rests longer than Blender lets it.

    It also shows that the window is alive.
    """

    def __init__(self):
        self.step = 0
        self.was_running = False
        self.fractions = set()
        self.last = self.longest = 0.0
        self.ended_at = -SHOWN

    def __call__(self):
        window = bpy.context.window_manager.windows[0]
        self.step += 1
        if self.step <= 5:  # a test may turn the 3D view into another editor
            area = max((a for a in window.screen.areas if a.type == "VIEW_3D"), key=lambda a: a.width)
        if self.step == 1:
            area.spaces.active.show_region_ui = True
        elif self.step == 2:
            region = next(r for r in area.regions if r.type == "UI")
            region.active_panel_category = "Étalon"
            area.tag_redraw()
        elif self.step == 5:
            region = next(r for r in area.regions if r.type == "UI")
            box = [region.x, window.height - region.y - region.height, region.width, region.height]
            report("ready", box=box, state=user_state())
        elif self.step > 5:
            self.watch()
        if QUESTION.exists():
            answer()
        return 0.1

    def watch(self):
        running = session.running is not None
        now = time.monotonic()
        if running and not self.was_running:
            report("started")
            self.fractions, self.longest = set(), 0.0
        if running and self.was_running:
            self.longest = max(self.longest, now - self.last)
            self.fractions.add(session.running.job.fraction)
            if len(self.fractions) == 4:
                report("halfway")
        if self.was_running and not running:
            result = session.result_of(bpy.context.scene)
            comparison = result and result.comparison
            report(
                "ended",
                outcome=comparison and comparison.verdict.outcome.value,
                stopped=comparison and comparison.stopped.value,
                folder=str(result and result.folder),
                errors=session.errors.get(bpy.context.scene.session_uid, ()),
                fractions=len(self.fractions),
                longest=self.longest,
                state=user_state(),
            )
            self.ended_at = self.step
        if self.step == self.ended_at + SHOWN:
            report("shown")
        self.was_running, self.last = running, now


bpy.context.preferences.view.show_splash = False
bpy.context.preferences.themes[0].user_interface.wcol_tool.inner = BUTTON
bpy.context.preferences.themes[0].user_interface.wcol_list_item.inner_sel = ROW
bpy.context.scene.render.resolution_percentage = 50
bpy.context.scene.etalon.time = 12.0
bpy.app.timers.register(Watch(), first_interval=0.5, persistent=True)
