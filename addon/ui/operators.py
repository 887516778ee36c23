# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's buttons: compare, cancel, open the report."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import bpy
import bpy.utils.previews

from ...lib.comparison.compare import Comparison
from ...lib.errors import EtalonError
from ...lib.files.atomic import replace_files
from .. import job
from .properties import read_settings

TICK = 0.1  # seconds between two looks at the job

PICTURES = {"Reference": "reference.png", "Cycles": "cycles.png", "Relative difference": "difference.png"}
ICONS = {"EQUIVALENT": "CHECKMARK", "DIFFERENT": "ERROR", "UNDECIDED": "QUESTION", "EXPLAINED": "INFO"}


@dataclass
class Session:
    """What the window knows of the comparison that runs, and of the one that ran last."""

    running: job.BackgroundJob | None = None
    comparison: Comparison | None = None
    folder: Path | None = None
    errors: tuple[str, ...] = ()
    pictures: bpy.utils.previews.ImagePreviewCollection | None = None

    def begin(self, running: job.BackgroundJob) -> None:
        """Forget the last comparison; `running` is the one that counts."""
        self.forget()
        self.running = running

    def take(self) -> None:
        """Take over what the job that has ended leaves behind."""
        ended, self.running = self.running, None
        self.errors, self.comparison, self.folder = ended.errors, ended.comparison, ended.folder
        if self.comparison is not None:
            self.pictures = bpy.utils.previews.new()
            for title, name in PICTURES.items():
                self.pictures.load(title, str(self.folder / name), "IMAGE")

    def forget(self) -> None:
        """End what runs, and drop what ran last."""
        if self.running is not None:
            self.running.cancel()
            self.running.wait()
        if self.pictures is not None:
            bpy.utils.previews.remove(self.pictures)
        self.running = self.comparison = self.folder = self.pictures = None
        self.errors = ()


session = Session()


def output_folder(scene: bpy.types.Scene) -> Path:
    """The folder chosen in the panel; for a file that was never saved, one among the system's temporary files."""
    chosen = scene.etalon.out
    if chosen.startswith("//") and not bpy.data.filepath:
        return Path(tempfile.gettempdir()) / chosen.lstrip("/")
    return Path(bpy.path.abspath(chosen))


def redraw(context: bpy.types.Context) -> None:
    """Draw again wherever the panel may be shown."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"PROPERTIES", "VIEW_3D"}:
                area.tag_redraw()


class CompareWithCycles(bpy.types.Operator):
    """Render this scene by the book and with Cycles, and say where the two agree. Esc cancels"""

    bl_idname = "etalon.compare"
    bl_label = "Compare with Cycles"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """One comparison at a time."""
        return context.scene is not None and session.running is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Start the job, and look at it from a timer."""
        scene = context.scene
        try:
            if scene.camera is None:
                raise EtalonError(f"{scene.name}: the scene has no camera; add one and make it the active camera")
            folder = output_folder(scene)
            with replace_files(folder):  # says at once when the folder cannot be written
                pass
            session.begin(job.BackgroundJob(scene, read_settings(scene), folder))
        except EtalonError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        redraw(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Draw the progress; take over the result when the job has ended; Esc ends it."""
        if session.running is None:
            return self._leave(context, {"CANCELLED"})
        if event.type == "ESC" and event.value == "PRESS":
            session.running.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        redraw(context)
        if not session.running.done:
            return {"PASS_THROUGH"}
        session.take()
        if session.comparison is not None:
            self.report({"INFO"}, f"Étalon: {session.comparison.verdict.outcome.value}")
        elif not session.errors:
            self.report({"INFO"}, "Étalon: cancelled before there was anything to compare")
        for error in session.errors:
            self.report({"ERROR"}, error)
        return self._leave(context, {"FINISHED"})

    def cancel(self, context: bpy.types.Context) -> None:
        """The window or the file goes away: so does the job."""
        session.forget()
        context.window_manager.event_timer_remove(self._timer)

    def _leave(self, context: bpy.types.Context, result: set[str]) -> set[str]:
        context.window_manager.event_timer_remove(self._timer)
        redraw(context)
        return result


class CancelComparison(bpy.types.Operator):
    """End the comparison; what both renderers finished is judged and kept"""

    bl_idname = "etalon.cancel"
    bl_label = "Cancel (Esc)"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while one runs."""
        return session.running is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """End it at once."""
        session.running.cancel()
        return {"FINISHED"}


class OpenReport(bpy.types.Operator):
    """Open the report in the web browser"""

    bl_idname = "etalon.open_report"
    bl_label = "Open Report"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there is one."""
        return session.folder is not None and (session.folder / "report.html").is_file()

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Hand the file to the browser."""
        bpy.ops.wm.url_open(url=(session.folder / "report.html").as_uri())
        return {"FINISHED"}
