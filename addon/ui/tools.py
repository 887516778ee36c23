# SPDX-License-Identifier: GPL-3.0-or-later
"""The other questions that the panel answers.

They are what settings cost, what accuracy costs, and which effects the scene needs. Each runs the command of the
command line on a copy of the file, in a second Blender.
"""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import bpy

from ...lib.errors import EtalonError
from ...lib.settings.audit import AuditOptions
from ...lib.settings.commands import PlanOutput
from ...lib.settings.common import REFERENCE_SCENES, Target
from ...lib.settings.cost import CostOptions
from ...lib.settings.declaration import Declared
from ...reference_scenes import build
from ..background_command import BackgroundCommand
from ..cycles.audit_settings import CATALOGUE, neutral_assignments
from .errors import translate_error
from .properties import output_folder, read_settings
from .session import session
from .text import translate
from .waiting import Watched

PAGES = {"audit": "audit.html", "cost": "cost.html"}


def folder_of(scene: bpy.types.Scene, command: str) -> Path:
    """The folder for the results of a command, beside those of comparisons."""
    out = output_folder(scene)
    return out.with_name(f"{out.name}-{command}")


def _audit(scene: bpy.types.Scene) -> tuple[tuple[Declared, ...], float | None]:
    chosen = read_settings(scene, partial=False, motion_blur=False)
    options = AuditOptions(
        tolerance=chosen.tolerance,
        confidence=chosen.confidence,
        time=chosen.time,
        threads=chosen.threads,
        out=folder_of(scene, "audit"),
    )
    return (Target(), options), chosen.time


def _cost(scene: bpy.types.Scene) -> tuple[tuple[Declared, ...], float | None]:
    chosen = read_settings(scene, partial=False, motion_blur=False)
    options = CostOptions(time=chosen.time, threads=chosen.threads, out=folder_of(scene, "cost"))
    return (Target(), options), chosen.time


def _plan(scene: bpy.types.Scene) -> tuple[tuple[Declared, ...], float | None]:
    return (Target(), PlanOutput()), None


_SETTINGS = {"audit": _audit, "cost": _cost, "plan": _plan}


class _Ask(Watched):
    """What the buttons have in common."""

    command: ClassVar[str]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """One piece of work at a time, of a scene with a camera."""
        return context.scene is not None and context.scene.camera is not None and session.running is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Start the command; the panel shows its progress and what it finds."""
        scene = context.scene
        try:
            settings, seconds = _SETTINGS[self.command](scene)
            session.begin(scene, BackgroundCommand(self.command, settings, seconds))
        except EtalonError as error:
            self.report({"ERROR"}, translate_error(str(error)))
            return {"CANCELLED"}
        return self.wait_for_end(context)


class AuditSettings(_Ask, bpy.types.Operator):
    """Measure what each Cycles setting of this scene costs in bias, noise and time"""

    bl_idname = "etalon.audit"
    bl_label = "Audit My Settings"
    command = "audit"


class MeasureCost(_Ask, bpy.types.Operator):
    """Measure the error of every way to render this scene against the time it takes"""

    bl_idname = "etalon.cost"
    bl_label = "What Does Accuracy Cost?"
    command = "cost"


class ShowPlan(_Ask, bpy.types.Operator):
    """List the effects that this scene needs and why, and everything that is not simulated"""

    bl_idname = "etalon.plan"
    bl_label = "Plan"
    command = "plan"


class ApplySetting(bpy.types.Operator):
    """Set this setting of the scene to its neutral value"""

    bl_idname = "etalon.apply_setting"
    bl_label = "Apply"
    bl_options: ClassVar = {"REGISTER", "UNDO"}
    __annotations__ = {"key": bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Change it, and say what it was and is."""
        entry = next((one for one in CATALOGUE if one.key == self.key), None)
        if entry is None:
            return {"CANCELLED"}
        for owner, name, value in neutral_assignments(entry, context.scene):
            setattr(owner, name, value)
        self.report({"INFO"}, translate("{setting} is set to {value}", setting=entry.label, value=entry.neutral_shown))
        return {"FINISHED"}


class OpenPage(bpy.types.Operator):
    """Open the page with all figures in the web browser"""

    bl_idname = "etalon.open_page"
    bl_label = "Open Report"
    __annotations__ = {"command": bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Hand it to the browser."""
        path = folder_of(context.scene, self.command) / PAGES[self.command]
        if not path.is_file():
            self.report({"WARNING"}, translate("{path} is not there any more", path=path))
            return {"CANCELLED"}
        bpy.ops.wm.url_open(url=path.as_uri())
        return {"FINISHED"}


class AddReferenceScene(bpy.types.Operator):
    """Open a scene whose image is known. It replaces this file, which can be saved first"""

    bl_idname = "etalon.add_reference_scene"
    bl_label = "Reference Scene"
    __annotations__ = {
        "name": bpy.props.EnumProperty(
            name="Scene", items=[(name, name.replace("_", " ").capitalize(), "") for name in REFERENCE_SCENES]
        )
    }

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Ask first where something would be lost."""
        if bpy.data.is_dirty:
            return context.window_manager.invoke_confirm(self, event)
        return self.execute(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Build it."""
        session.forget()
        build(self.name)
        return {"FINISHED"}


class ReferenceScenesMenu(bpy.types.Menu):
    """Scenes whose images are known"""

    bl_idname = "ETALON_MT_scenes"
    bl_label = "Étalon"

    def draw(self, context: bpy.types.Context) -> None:
        """One entry for each scene."""
        self.layout.operator_context = "INVOKE_DEFAULT"
        self.layout.operator_enum(AddReferenceScene.bl_idname, "name")


def draw_scenes_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Add the reference scenes to the menu Add."""
    menu.layout.menu(ReferenceScenesMenu.bl_idname, icon="SCENE_DATA")
