# SPDX-License-Identifier: GPL-3.0-or-later
"""The menu *Light*: the part of the light that the images and the list of regions show."""

from __future__ import annotations

import bpy

from ...lib.film.light_passes import LightPass
from ...lib.film.parts import Part, decode_part, encode_part
from .images import LIGHT_MENU, choose_light, light_of
from .regions import fill_tables
from .session import session
from .text import translate


def light_text(part: Part | None) -> str:
    """What the menu calls a part of the light."""
    if part is None:
        return translate("All of the light")
    name = str(part)
    text = name[0].upper() + name[1:]
    return translate(text) if isinstance(part, LightPass) else text


class ShowLight(bpy.types.Operator):
    """Show this part of the light in the images of the comparison, and its regions in the list"""

    bl_idname = "etalon.show_light"
    bl_label = "Show Light"
    __annotations__ = {"part": bpy.props.StringProperty(name="Light", options={"HIDDEN"})}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Have its images written; editors that show one follow, and so does the list."""
        choose_light(context.scene.session_uid, decode_part(self.part) if self.part else None)
        fill_tables(context.window_manager)
        return {"FINISHED"}


class LightMenu(bpy.types.Menu):
    """The parts of the light that were compared"""

    bl_idname = LIGHT_MENU
    bl_label = "Light"

    def draw(self, context: bpy.types.Context) -> None:
        """One entry for the whole image, and one for each part."""
        result, shown = session.result_of(context.scene), light_of(context.scene.session_uid)
        if result is None or result.comparison.passes is None:
            return
        for part in (None, *result.comparison.passes.passes):
            icon = "RADIOBUT_ON" if part == shown else "RADIOBUT_OFF"
            entry = self.layout.operator(ShowLight.bl_idname, text=light_text(part), icon=icon, translate=False)
            entry.part = "" if part is None else encode_part(part)
