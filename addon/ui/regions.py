# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of regions, and what a click on one of them does."""

from __future__ import annotations

import threading
from typing import ClassVar

import bpy

from ...lib.pages.formats import format_bound, format_percent
from ...lib.report.page import GRIDS
from ...lib.report.ranking import RankedRegion
from ...lib.verdict.outcome import Outcome
from .images import regions_shown, zoom_to_region
from .places import select_objects, set_border
from .session import Result, session
from .text import font_size, measure, shorten, text_width, translate

ICONS = {
    Outcome.DIFFERENT: "ERROR",
    Outcome.EXPLAINED: "INFO",
    Outcome.UNDECIDED: "QUESTION",
    Outcome.EQUIVALENT: "CHECKMARK",
}
KINDS = {
    "image": "whole image",
    "material": "material",
    "facing": "angles of a material",
    "object": "object",
    "cell": "cell",
    "block": "block",
}
CHANNELS = {"R": "red", "G": "green", "B": "blue"}
# Pixels, at an interface scale of 1, that a row has beyond a line of text, and that its icon and the gaps around its texts take.
ROW, ICON, GAP = 14, 38, 12


def label_text(region: RankedRegion) -> str:
    """A region's label in the language of the interface."""
    if region.kind not in GRIDS:
        return translate(region.label) if region.kind == "image" else region.label
    place, first, second = region.label.rsplit(" ", 2)
    return f"{translate(place)} {first} {second}"


def figures(region: RankedRegion) -> str:
    """A region's figures for a row.

    They are the difference with its margin, or the bound where no difference is shown.
    """
    if region.outcome in (Outcome.DIFFERENT, Outcome.EXPLAINED):
        return f"{format_percent(region.difference).removesuffix(' %')} ± {format_bound(region.margin)}"
    return f"≤ {format_bound(region.bound)}" if region.bound < float("inf") else translate("unbounded")


def describe_region(region: RankedRegion) -> list[str]:
    """All that is known of a region, line by line."""
    lines = [translate(KINDS[region.kind]).capitalize()]
    if region.kind != "image":
        lines = [f"{lines[0]}: {region.name}"]
    if region.outcome in (Outcome.DIFFERENT, Outcome.EXPLAINED):
        ends = format_percent(region.low), format_percent(region.high)
        channel = translate(CHANNELS[region.channel])
        said = translate("{difference} in {channel}", difference=format_percent(region.difference), channel=channel)
        lines.append(f"{said} ({translate('{low} to {high}', low=ends[0], high=ends[1])})")
    bound = format_bound(region.bound) if region.bound < float("inf") else translate("unbounded")
    lines.append(translate("The difference is at most {bound}", bound=bound))
    return lines


class RegionRow(bpy.types.PropertyGroup):
    """One row; its name is what the list's search field finds. The figures are in the session."""


_showing = threading.Lock()
"""Held while a region is shown, which chooses its row."""


def _go_to_active(table: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """A click beside the names of a row, or an arrow key, shows that region."""
    if not _showing.locked() and table.name == str(context.scene.session_uid):
        bpy.ops.etalon.show_region("EXEC_DEFAULT", True, number=table.active)


class RegionTable(bpy.types.PropertyGroup):
    """The rows of one scene; the table is named by the scene's `session_uid`."""

    __annotations__ = {
        "rows": bpy.props.CollectionProperty(type=RegionRow),
        "active": bpy.props.IntProperty(name="Region", update=_go_to_active, options={"SKIP_SAVE"}),
    }


def table_of(context: bpy.types.Context) -> RegionTable | None:
    """The table of the scene that is shown, if it has a result."""
    return context.window_manager.etalon_regions.get(str(context.scene.session_uid))


def fill_tables(window_manager: bpy.types.WindowManager) -> None:
    """Make the tables anew from all results that there are, in the part of the light that each shows."""
    tables = window_manager.etalon_regions
    tables.clear()
    for uid in session.results:
        table = tables.add()
        table.name = str(uid)
        for region in regions_shown(uid):
            table.rows.add().name = label_text(region)


class RegionList(bpy.types.UIList):
    """Regions, the worst first."""

    bl_idname = "ETALON_UL_regions"

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        data: RegionTable,
        item: RegionRow,
        icon: int,
        active_data: RegionTable,
        active_property: str,
        index: int = 0,
    ) -> None:
        """One row: icon, name and figures; the name is a button."""
        regions = regions_shown(int(data.name))
        if index >= len(regions):
            return
        region, points = regions[index], font_size(context)
        scale, text = context.preferences.system.ui_scale, figures(region)
        width = text_width(context) + ROW * scale
        share = max(1.0 - (measure(text, points) + GAP * scale) / width, 0.2)
        split = layout.split(factor=share, align=True)
        name = split.row(align=True)
        name.alignment = "LEFT"
        label = shorten(label_text(region), int(share * width - ICON * scale), points)
        shown = name.operator(
            ShowRegion.bl_idname, text=label, icon=ICONS[region.outcome], emboss=False, translate=False
        )
        shown.number = index
        value = split.row()
        value.alignment = "RIGHT"
        value.alert = region.outcome is Outcome.DIFFERENT
        value.label(text=text, translate=False)


class ShowRegion(bpy.types.Operator):
    """Select this region's objects, set the render region to it, zoom Image editors to it"""

    bl_idname = "etalon.show_region"
    bl_label = "Show Region"
    bl_options: ClassVar = {"REGISTER", "UNDO"}
    __annotations__ = {"number": bpy.props.IntProperty(options={"HIDDEN", "SKIP_SAVE"})}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only where there is a result."""
        return context.scene is not None and session.result_of(context.scene) is not None

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """The region's whole name and figures, and what a click does."""
        regions = regions_shown(context.scene.session_uid)
        said = describe_region(regions[properties.number]) if properties.number < len(regions) else []
        return "\n".join([*said, translate(cls.__doc__)])

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Show it in the 3D view, in the camera's frame and in the Image editors."""
        result, regions = session.result_of(context.scene), regions_shown(context.scene.session_uid)
        if not 0 <= self.number < len(regions):
            return {"CANCELLED"}
        region, table = regions[self.number], table_of(context)
        if table is not None:
            with _showing:
                table.active = self.number
        missing = select_objects(context, region)
        if missing:
            self.report({"WARNING"}, translate("'{name}' is no longer in the scene", name=missing))
        set_border(context.scene, result.border, region)
        zoom_to_region(context, region)
        return {"FINISHED"}


class ClearBorder(bpy.types.Operator):
    """Render the whole frame again"""

    bl_idname = "etalon.clear_border"
    bl_label = "Whole Frame"
    bl_options: ClassVar = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only where a part of the frame is rendered."""
        return context.scene is not None and context.scene.render.use_border

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Switch the render region off."""
        context.scene.render.use_border = False
        return {"FINISHED"}


def draw_regions(layout: bpy.types.UILayout, context: bpy.types.Context, result: Result) -> None:
    """The list, and the figures of the region that is chosen in it."""
    table = table_of(context)
    if table is None or not len(table.rows):
        return
    layout.template_list(RegionList.bl_idname, "", table, "rows", table, "active", rows=5)
