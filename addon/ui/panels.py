# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel: in the Render properties and in the 3D view's sidebar."""

from __future__ import annotations

import textwrap
from typing import ClassVar

import bpy

from ...lib.blender_versions import describe_unchecked
from ...lib.report.summary import summarize
from .operators import ICONS, CancelComparison, CompareWithCycles, OpenReport, session
from .properties import SHOWN

_PIXELS_PER_CHARACTER = 7.5


class _Panel:
    """What both places show."""

    bl_label = "Étalon"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw settings, button or progress, and what came out last."""
        layout, settings = self.layout, context.scene.etalon
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.enabled = session.running is None
        for declared in SHOWN:
            column.prop(settings, declared.name)
        if session.running is None:
            row = layout.row()
            row.scale_y = 1.6
            row.operator(CompareWithCycles.bl_idname)
        else:
            running = session.running
            layout.progress(factor=running.fraction, text=f"{running.message}: {running.fraction:.0%}")
            layout.operator(CancelComparison.bl_idname)
        characters = max(20, int(context.region.width / context.preferences.system.ui_scale / _PIXELS_PER_CHARACTER))
        unchecked = describe_unchecked(bpy.app.version[:2])
        if unchecked:
            _draw_text(layout, unchecked, characters, icon="INFO")
        for error in session.errors:
            _draw_text(layout.box(), error, characters, icon="ERROR")
        if session.comparison is not None:
            self._draw_verdict(characters)

    def _draw_verdict(self, characters: int) -> None:
        """The summary, the images, and the way to the report."""
        verdict = session.comparison.verdict
        box = self.layout.box()
        icons = ICONS[verdict.outcome.value], "VIEWZOOM", "FORWARD"
        for sentence, icon in zip(summarize(session.comparison), icons, strict=True):
            _draw_text(box, sentence, characters, icon=icon)
        box.operator(OpenReport.bl_idname)
        _draw_text(box, str(session.folder), characters, icon="FILE_FOLDER")
        for title, picture in session.pictures.items():
            box.label(text=title)
            box.template_icon(icon_value=picture.icon_id, scale=8.0)


def _draw_text(layout: bpy.types.UILayout, text: str, characters: int, icon: str) -> None:
    """A text wrapped to the panel's width, with `icon` in front of its first line."""
    column = layout.column(align=True)
    for number, part in enumerate(textwrap.wrap(text, characters)):
        column.label(text=part, icon="BLANK1" if number else icon)


class RenderPanel(_Panel, bpy.types.Panel):
    """Étalon in the Render properties."""

    bl_idname = "ETALON_PT_render"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}


class SidebarPanel(_Panel, bpy.types.Panel):
    """Étalon in the 3D view's sidebar."""

    bl_idname = "ETALON_PT_sidebar"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Étalon"
