# SPDX-License-Identifier: GPL-3.0-or-later
"""Registration of the extension with Blender, and its removal."""

from __future__ import annotations

import bpy

from ..command import cli
from ..host.blender_at_hand import require_supported_blender
from . import (
    handlers,
    images,
    light,
    operators,
    panels,
    preferences,
    preflight,
    properties,
    regions,
    tools,
    translations,
)
from .session import session

_CLASSES = (
    preferences.EtalonPreferences,
    properties.EtalonSettings,
    regions.RegionRow,
    regions.RegionTable,
    regions.RegionList,
    regions.ShowRegion,
    regions.ClearBorder,
    images.ShowImage,
    images.SwitchImage,
    light.ShowLight,
    light.LightMenu,
    images.ImageMenu,
    operators.CompareWithCycles,
    operators.ApplyPreset,
    operators.CompareTheRest,
    operators.SelectOwner,
    operators.CancelComparison,
    operators.OpenReport,
    tools.AuditSettings,
    tools.MeasureCost,
    tools.ShowPlan,
    tools.ApplySetting,
    tools.OpenPage,
    tools.AddReferenceScene,
    tools.ReferenceScenesMenu,
    *panels.PANELS,
)

_commands: list[object] = []


def register() -> None:
    """Register the settings, the panels and the command `etalon`.

    Raises EtalonError in a Blender that is too old.
    """
    require_supported_blender()
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.etalon = bpy.props.PointerProperty(type=properties.EtalonSettings)
    bpy.types.WindowManager.etalon_regions = bpy.props.CollectionProperty(type=regions.RegionTable)
    translations.add_translations()
    images.add_to_image_editor()
    bpy.types.VIEW3D_MT_add.append(tools.draw_scenes_menu)
    handlers.add_handlers()
    _commands.append(bpy.utils.register_cli_command("etalon", cli.main))


def unregister() -> None:
    """Remove all of it again, and end a comparison that still runs."""
    session.forget()
    preflight.forget_surveys()
    bpy.utils.unregister_cli_command(_commands.pop())
    handlers.remove_handlers()
    images.remove_from_image_editor()
    translations.remove_translations()
    bpy.types.VIEW3D_MT_add.remove(tools.draw_scenes_menu)
    del bpy.types.WindowManager.etalon_regions
    del bpy.types.Scene.etalon
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
