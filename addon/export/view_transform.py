# SPDX-License-Identifier: GPL-3.0-or-later
"""How a scene wants its images shown.

These are the settings under Render Properties > Color Management.
"""

from __future__ import annotations

import bpy

from ...lib.film.view_transform import ViewTransform
from ..host.color_configuration import color_configuration


def export_view_transform(scene: bpy.types.Scene) -> ViewTransform:
    """The view transform of `scene`, with the running Blender's OpenColorIO configuration.

    Curves and the white balance of the view are named as omitted. The verdict does not depend on them.
    """
    settings = scene.view_settings
    # Blender 4.2 has no white balance of the view.
    balance = getattr(settings, "use_white_balance", False)
    omitted = (("curves", settings.use_curve_mapping), ("white balance", balance))
    return ViewTransform(
        color_configuration(),
        settings.view_transform,
        "" if settings.look == "None" else settings.look,
        settings.exposure,
        settings.gamma,
        tuple(name for name, is_used in omitted if is_used),
    )
