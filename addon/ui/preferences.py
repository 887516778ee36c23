# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's preferences.

They are threads, the folder for results, what is kept there, and the Blender that renders.
"""

from __future__ import annotations

import bpy

ADDON = __package__.removesuffix(".addon.ui")


class EtalonPreferences(bpy.types.AddonPreferences):
    """What holds for all files."""

    bl_idname = ADDON
    __annotations__ = {
        "threads": bpy.props.IntProperty(
            name="Threads", description="Threads of both renderers; 0: all processors but one", min=0, soft_max=64
        ),
        "folder": bpy.props.StringProperty(
            name="Results",
            description="Folder for results where a scene does not name one; empty: beside the file",
            subtype="DIR_PATH",
        ),
        "keep_exrs": bpy.props.BoolProperty(
            name="Keep EXRs",
            description="Leave float images beside the report: reference.exr, cycles.exr and difference.exr",
            default=True,
        ),
        "blender": bpy.props.StringProperty(
            name="Blender to use",
            description="Another Blender program that renders Cycles' side; empty: this one",
            subtype="FILE_PATH",
        ),
    }

    def draw(self, context: bpy.types.Context) -> None:
        """Draw all of them."""
        self.layout.use_property_split = True
        for name in self.__annotations__:
            self.layout.prop(self, name)


def _preferences() -> EtalonPreferences | None:
    """The preferences; None where Étalon is no extension, as in Blender as a module."""
    addon = bpy.context.preferences.addons.get(ADDON)
    return addon.preferences if addon is not None else None


def preferred_threads() -> int:
    """The number of threads that was chosen, or 0."""
    chosen = _preferences()
    return chosen.threads if chosen is not None else 0


def preferred_folder() -> str:
    """The folder that was chosen for results, or an empty text."""
    chosen = _preferences()
    return chosen.folder if chosen is not None else ""


def keeps_exrs() -> bool:
    """Whether float images are to lie beside reports."""
    chosen = _preferences()
    return chosen.keep_exrs if chosen is not None else True


def preferred_blender() -> str | None:
    """The other Blender program that was chosen."""
    chosen = _preferences()
    return bpy.path.abspath(chosen.blender) if chosen is not None and chosen.blender else None
