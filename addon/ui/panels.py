# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels: in the Render properties and in the 3D view's sidebar."""

from __future__ import annotations

from typing import Any, ClassVar

import bpy

from ...lib.audit.document import WORDS
from ...lib.blender_versions import describe_unchecked
from ...lib.cost.summary import summarize as summarize_cost
from ...lib.pages.formats import format_percent
from ...lib.settings.presets import PRESETS
from ...lib.verdict.outcome import Outcome
from . import preflight
from .errors import translate_error
from .images import ShowImage, light_of
from .light import LightMenu, light_text
from .operators import ApplyPreset, CancelComparison, CompareTheRest, CompareWithCycles, OpenReport, SelectOwner
from .properties import SHOWN
from .regions import ICONS, ClearBorder, draw_regions
from .session import Result, session
from .text import draw_text, phrase_text, translate
from .tools import ApplySetting, AuditSettings, MeasureCost, OpenPage, ShowPlan
from .watching import describe_bound, describe_stage, describe_time

# The colour of the headline, by names of icons before and since Blender 4.4.
COLOURS = {Outcome.DIFFERENT: 1, Outcome.UNDECIDED: 3, Outcome.EQUIVALENT: 4, Outcome.EXPLAINED: 5}
_PREFIX = "STRIP_COLOR" if bpy.app.version >= (4, 4, 0) else "SEQUENCE_COLOR"


class _Main:
    """The part that is always visible: result, button or progress, and errors."""

    bl_label = "Étalon"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw it below the panel's header."""
        draw_main(self.layout, context)


class _Headless:
    """Everything in one panel without a header of Blender's.

    Blender keeps such panels above the others, in the order in which they were registered.
    """

    bl_label = "Étalon"
    bl_options: ClassVar = {"HIDE_HEADER"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw what is always visible and the sub-panels, below a header that closes and opens all of it."""
        header, body = self.layout.panel("etalon_main")
        header.label(text=self.bl_label)
        if body is None:
            return
        draw_main(body, context)
        for name, part in PARTS.items():
            header, inner = body.panel(f"etalon_{name}", default_closed="DEFAULT_CLOSED" in part.bl_options)
            header.label(text=part.bl_label)
            if inner is not None:
                part.draw_column(inner, context)


def draw_main(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the result first, then the button or the progress."""
    scene = context.scene
    result = session.result_of(scene)
    if result is not None:
        draw_result(layout, context, result)
    for error in session.errors.get(scene.session_uid, ()):
        draw_text(layout.box(), context, translate_error(error), icon="ERROR")
    if session.running is None:
        draw_start(layout, context)
    else:
        draw_progress(layout, context)
    unchecked = describe_unchecked(bpy.app.version[:2])
    if unchecked:
        draw_text(layout, context, unchecked, icon="INFO")


def draw_start(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What would stop a comparison, each with a button to it, and the button that starts one."""
    scene = context.scene
    refused = [preflight.notice_of(refusal) for refusal in session.refusals.get(scene.session_uid, ())]
    notices = [*preflight.notices_of_settings(scene), *(refused or preflight.notices_of_content(scene))]
    for notice in notices[: preflight.MOST]:
        row = layout.row()
        stops = notice.stops and not (notice.kind == "material" and scene.etalon.partial)
        draw_text(row, context, notice.text, icon="ERROR" if stops else "INFO", beside=bool(notice.name))
        if notice.name:
            button = row.operator(SelectOwner.bl_idname, text="", icon="RESTRICT_SELECT_OFF", emboss=False)
            button.kind, button.name = notice.kind, notice.name
    if len(notices) > preflight.MOST:
        draw_text(layout, context, translate("and {count} more", count=len(notices) - preflight.MOST), icon="BLANK1")
    button = layout.row()
    button.scale_y = 1.6
    button.operator(CompareWithCycles.bl_idname)
    if any(notice.kind == "material" for notice in notices) and not scene.etalon.partial:
        layout.operator(CompareTheRest.bl_idname)
    draw_text(layout, context, preflight.describe_task(scene), icon="BLANK1")


def draw_progress(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How far the comparison is, what it knows so far, and the button that ends it."""
    running = session.running
    if not session.is_running(context.scene):
        draw_text(layout, context, translate("Another scene is being compared"), icon="TIME")
    column = layout.column(align=True)
    column.progress(factor=running.job.fraction, text=describe_time(running))
    draw_text(column, context, describe_stage(running), icon="TIME")
    bound = describe_bound(running)
    if bound:
        draw_text(column, context, bound, icon="TRACKING_FORWARDS")
    layout.operator(CancelComparison.bl_idname, icon="X")


def draw_result(layout: bpy.types.UILayout, context: bpy.types.Context, result: Result) -> None:
    """Draw the verdict in one coloured line, then its details.

    These are its text, the regions, and buttons that lead to the report.
    """
    outcome = result.comparison.verdict.outcome
    box = layout.box()
    colour = f"{_PREFIX}_{COLOURS[outcome]:02}"
    draw_text(box, context, phrase_text(result.headline), icon=colour, alert=outcome is Outcome.DIFFERENT)
    if result.is_stale(context.scene):
        draw_text(box, context, translate("The scene has changed since; compare again"), icon="FILE_REFRESH")
    column = box.column(align=True)
    for phrase in result.details:
        draw_text(column, context, phrase_text(phrase), icon="BLANK1")
    draw_regions(layout, context, result)
    row = layout.row(align=True)
    row.operator_menu_enum(ShowImage.bl_idname, "view", icon="IMAGE_DATA")
    if result.comparison.passes is not None:
        shown = light_text(light_of(context.scene.session_uid))
        row.menu(LightMenu.bl_idname, text=shown, icon="OUTLINER_OB_LIGHT", translate=False)
    row = layout.row(align=True)
    row.operator(OpenReport.bl_idname, icon="URL")
    row.operator(ClearBorder.bl_idname, icon="FULLSCREEN_EXIT")


class _Part:
    """A sub-panel; those in which nothing needs to be changed are closed at first."""

    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw what it holds."""
        self.draw_column(self.layout, context)

    @classmethod
    def draw_column(cls, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draw what it holds into `layout`, greyed while a job runs."""
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.enabled = session.running is None
        cls.draw_part(column, context)


def draw_options(layout: bpy.types.UILayout, context: bpy.types.Context, group: str) -> None:
    """The declared options of one sub-panel."""
    for declared in SHOWN:
        if declared.panel.group == group:
            layout.prop(context.scene.etalon, declared.name)


class _Target(_Part):
    """How closely and for how long."""

    bl_label = "Target"
    bl_options: ClassVar = set()

    @classmethod
    def draw_part(cls, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draw presets and settings."""
        row = layout.row(align=True)
        row.use_property_split = False
        for name in PRESETS:
            row.operator(ApplyPreset.bl_idname, text=name).name = name
        draw_options(layout, context, "target")


class _Model(_Part):
    """How the reference renders."""

    bl_label = "Model"

    @classmethod
    def draw_part(cls, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draw the options of the reference."""
        draw_options(layout, context, "model")


class _Frame(_Part):
    """The part of the scene that is compared."""

    bl_label = "Region"

    @classmethod
    def draw_part(cls, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draw the scene's own settings."""
        scene, render = context.scene, context.scene.render
        layout.prop(scene, "camera")
        layout.prop(scene, "frame_current", text="Frame")
        layout.prop(render, "resolution_percentage", text="Resolution")
        layout.prop(render, "use_border")
        if render.use_border:
            column = layout.column(align=True)
            for name in ("border_min_x", "border_max_x", "border_min_y", "border_max_y"):
                column.prop(render, name, slider=True)
        layout.operator(ClearBorder.bl_idname, icon="FULLSCREEN_EXIT")


class _Passes(_Part):
    """In which light the images differ."""

    bl_label = "Passes"

    @classmethod
    def draw_part(cls, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draw the choice of light passes."""
        draw_options(layout, context, "passes")


class _Tools(_Part):
    """The other questions, and their answers."""

    bl_label = "Settings, Cost and Plan"

    @classmethod
    def draw_part(cls, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draw a button for each, and below what it found."""
        layout.use_property_split = False
        found = session.figures.get(context.scene.session_uid, {})
        layout.operator(AuditSettings.bl_idname)
        if "audit" in found:
            draw_audit(layout.box(), context, found["audit"])
        layout.operator(MeasureCost.bl_idname)
        if "cost" in found:
            box = layout.box()
            draw_text(box, context, summarize_cost(found["cost"]))
            box.operator(OpenPage.bl_idname, icon="URL").command = "cost"
        layout.operator(ShowPlan.bl_idname)
        if "plan" in found:
            draw_plan(layout.box(), context, found["plan"])


def draw_audit(layout: bpy.types.UILayout, context: bpy.types.Context, figures: dict[str, Any]) -> None:
    """Draw what each setting costs, the worst first.

    A button makes a biased setting neutral.
    """
    for entry in figures["settings"]:
        if entry["together"]:
            continue
        row, outcome = layout.row(), Outcome(entry["outcome"])
        said = f"{entry['label']}, {entry['value']}: {translate(WORDS[outcome])}"
        if outcome is Outcome.DIFFERENT:
            said += f" {format_percent(entry['worst']['difference'])}"
        draw_text(row, context, said, icon=ICONS[outcome], beside=outcome is Outcome.DIFFERENT)
        if outcome is Outcome.DIFFERENT:
            row.operator(ApplySetting.bl_idname, text="", icon="LOOP_BACK").key = entry["key"].removesuffix("-factory")
    if not figures["settings"]:
        draw_text(layout, context, translate("Every setting is at its neutral value"), icon="CHECKMARK")
    layout.operator(OpenPage.bl_idname, icon="URL").command = "audit"


def draw_plan(layout: bpy.types.UILayout, context: bpy.types.Context, figures: dict[str, Any]) -> None:
    """Draw the effects that the scene needs, each with its reason.

    What is not simulated stands above the button.
    """
    if "refusals" in figures:
        draw_text(layout, context, translate("Not everything is simulated; see above"), icon="ERROR")
    for decision in figures.get("decisions", ()):
        if decision["needed"]:
            draw_text(layout, context, f"{decision['effect']}: {decision['fact']}", icon="DOT")


PARTS = {"target": _Target, "model": _Model, "region": _Frame, "passes": _Passes, "tools": _Tools}


def _in_sidebar(base: type, name: str, **more: object) -> type:
    """The panel `base` in the sidebar of the 3D view."""
    place = {"bl_space_type": "VIEW_3D", "bl_region_type": "UI", "bl_category": "Étalon"}
    return type(f"ETALON_PT_sidebar_{name}", (base, bpy.types.Panel), place | more)


def _in_image_editor(base: type, name: str, **more: object) -> type:
    """The panel `base` in the sidebar of the Image editor."""
    place = {"bl_space_type": "IMAGE_EDITOR", "bl_region_type": "UI", "bl_category": "Étalon"}
    return type(f"ETALON_PT_image_{name}", (base, bpy.types.Panel), place | more)


def _make_panels() -> tuple[type, ...]:
    """All panels, each in each of its places; parents come before their children."""
    place = {"bl_space_type": "PROPERTIES", "bl_region_type": "WINDOW", "bl_context": "render"}
    made = [type("ETALON_PT_render_main", (_Headless, bpy.types.Panel), place)]
    for place in (_in_sidebar, _in_image_editor):
        main = place(_Main, "main")
        made.append(main)
        made += [place(base, name, bl_parent_id=main.__name__) for name, base in PARTS.items()]
    return tuple(made)


PANELS = _make_panels()
