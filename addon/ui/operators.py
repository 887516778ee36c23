# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's buttons: compare, cancel, open the report."""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy

from ...lib.errors import EtalonError
from ...lib.files.atomic import replace_files
from .. import job
from .properties import read_settings
from .session import session
from .text import phrase_text, translate
from .watching import TICK, watch_job


def output_folder(scene: bpy.types.Scene) -> Path:
    """The folder chosen in the panel; for a file that was never saved, one among the system's temporary files."""
    chosen = scene.etalon.out
    if chosen.startswith("//") and not bpy.data.filepath:
        return Path(tempfile.gettempdir()) / chosen.lstrip("/")
    return Path(bpy.path.abspath(chosen))


class CompareWithCycles(bpy.types.Operator):
    """Render this scene with the reference and with Cycles, and say where the two agree. Esc cancels"""

    bl_idname = "etalon.compare"
    bl_label = "Compare with Cycles"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """One comparison at a time."""
        return context.scene is not None and session.running is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Start the job, have it watched, and wait for Esc."""
        scene = context.scene
        try:
            if scene.camera is None:
                raise EtalonError(f"{scene.name}: the scene has no camera; add one and make it the active camera")
            folder = output_folder(scene)
            with replace_files(folder):  # says at once when the folder cannot be written
                pass
            session.begin(scene, job.BackgroundJob(scene, read_settings(scene), folder))
        except EtalonError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._watched = session.running
        watch_job()
        self._timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Esc ends the job; once it has ended, say what came of it."""
        is_running = session.running is self._watched
        if is_running and event.type == "ESC" and event.value == "PRESS":
            session.running.job.cancel()
            return {"RUNNING_MODAL"}
        if is_running:
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self._timer)
        ended = self._watched
        for error in ended.job.errors:
            self.report({"ERROR"}, error)
        if ended.result is not None:
            self.report({"INFO"}, f"Étalon: {phrase_text(ended.result.headline)}")
        elif not ended.job.errors:
            self.report({"INFO"}, translate("Étalon: cancelled before there was anything to compare"))
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """The window goes away, or the file: the job goes on in the other windows, and handlers end it with the file."""
        context.window_manager.event_timer_remove(self._timer)


class CancelComparison(bpy.types.Operator):
    """End the comparison; what both renderers finished is judged and kept"""

    bl_idname = "etalon.cancel"
    bl_label = "Cancel (Esc)"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while one runs that was not told to end."""
        return session.running is not None and not session.running.job.is_cancelled

    def execute(self, context: bpy.types.Context) -> set[str]:
        """End it at once."""
        session.running.job.cancel()
        return {"FINISHED"}


class OpenReport(bpy.types.Operator):
    """Open the report in the web browser"""

    bl_idname = "etalon.open_report"
    bl_label = "Open Report"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there is one, and none is being written."""
        if context.scene is None or session.is_running(context.scene):
            return False
        result = session.result_of(context.scene)
        return result is not None and (result.folder / "report.html").is_file()

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Hand the file to the browser."""
        bpy.ops.wm.url_open(url=(session.result_of(context.scene).folder / "report.html").as_uri())
        return {"FINISHED"}
