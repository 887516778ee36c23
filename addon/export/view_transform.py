# SPDX-License-Identifier: GPL-3.0-or-later
"""How a scene wants its images shown: the settings under Render Properties > Color Management."""

from __future__ import annotations

from pathlib import Path

import bpy

from ...lib.film.view_transform import ViewTransform


def export_view_transform(scene: bpy.types.Scene) -> ViewTransform:
    """The view transform of `scene`, with the OpenColorIO configuration of the Blender that runs.

    Curves and the white balance of the view are named as omitted. The verdict rests on nothing of it.
    """
    settings = scene.view_settings
    config = Path(bpy.utils.system_resource("DATAFILES", path="colormanagement")) / "config.ocio"
    # Blender 4.2 has no white balance of the view.
    balance = getattr(settings, "use_white_balance", False)
    omitted = (("curves", settings.use_curve_mapping), ("white balance", balance))
    return ViewTransform(
        config,
        settings.view_transform,
        "" if settings.look == "None" else settings.look,
        settings.exposure,
        settings.gamma,
        tuple(name for name, is_used in omitted if is_used),
    )
