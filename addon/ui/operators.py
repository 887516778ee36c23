# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's buttons: compare, cancel, open the report."""

from __future__ import annotations

from typing import ClassVar

import bpy

from ...lib.errors import EtalonError
from ...lib.files.atomic import replace_files
from ...lib.settings.presets import PRESETS
from .. import job
from .errors import translate_error
from .places import objects_with, select_only
from .preferences import keeps_exrs, preferred_blender
from .properties import apply_preset, output_folder, read_settings
from .session import session
from .text import translate
from .waiting import Watched


class CompareWithCycles(Watched, bpy.types.Operator):
    """Render this scene with the reference and Cycles, and say where they agree. Esc cancels"""

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
                raise EtalonError(translate("There is no camera: add one and make it active"))
            folder = output_folder(scene)
            with replace_files(folder):  # says at once when the folder cannot be written
                pass
            started = job.BackgroundJob(scene, read_settings(scene), folder, preferred_blender(), keeps_exrs())
            session.begin(scene, started)
        except EtalonError as error:
            self.report({"ERROR"}, translate_error(str(error)))
            return {"CANCELLED"}
        return self.wait_for_end(context)


class ApplyPreset(bpy.types.Operator):
    """Set tolerance, time and image size to those of this target"""

    bl_idname = "etalon.apply_preset"
    bl_label = "Apply Target"
    bl_options: ClassVar = {"REGISTER", "UNDO"}
    __annotations__ = {"name": bpy.props.EnumProperty(name="Target", items=[(name, name, "") for name in PRESETS])}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Set them."""
        apply_preset(context.scene, self.name)
        return {"FINISHED"}


class CompareTheRest(bpy.types.Operator):
    """Compare without motion blur and without the pixels that show unsupported materials"""

    bl_idname = "etalon.compare_the_rest"
    bl_label = "Compare the Rest"
    bl_options: ClassVar = {"UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """One comparison at a time."""
        return CompareWithCycles.poll(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Switch Partial on and Motion blur off, and press the other button.

        Both come back where nothing starts.
        """
        chosen = context.scene.etalon
        before = chosen.partial, chosen.motion_blur
        chosen.partial, chosen.motion_blur = True, False
        try:
            started = "CANCELLED" not in bpy.ops.etalon.compare("INVOKE_DEFAULT")
        except RuntimeError as error:  # what the other button reports
            self.report({"ERROR"}, str(error).removeprefix("Error: ").strip())
            started = False
        if not started:
            chosen.partial, chosen.motion_blur = before
        return {"FINISHED"} if started else {"CANCELLED"}


class SelectOwner(bpy.types.Operator):
    """Select what is not supported: the object, or the objects with the material"""

    bl_idname = "etalon.select_owner"
    bl_label = "Select What Is Not Supported"
    bl_options: ClassVar = {"REGISTER", "UNDO"}
    __annotations__ = {
        "kind": bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"}),
        "name": bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"}),
    }

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Select it, and make the material the active one of its object."""
        found = objects_with(context.view_layer, "object" if self.kind == "light" else self.kind, self.name)
        if not found:
            self.report({"WARNING"}, translate("'{name}' is no longer in the scene", name=self.name))
            return {"CANCELLED"}
        select_only(context, found)
        for index, slot in enumerate(found[0].material_slots):
            if self.kind == "material" and slot.material and slot.material.name == self.name:
                found[0].active_material_index = index
        return {"FINISHED"}


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
