# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame that Blender renders, in pixels, and the part of it within a render border."""

from __future__ import annotations

import bpy
import numpy as np


def full_frame(render: bpy.types.RenderSettings) -> tuple[int, int]:
    """Width and height of the image without a border, in pixels."""
    percentage = render.resolution_percentage
    return render.resolution_x * percentage // 100, render.resolution_y * percentage // 100


def rendered_region(render: bpy.types.RenderSettings, width: int, height: int) -> tuple[int, int, int, int]:
    """Left, bottom, width and height of the rendered region, in pixels.

    Blender never renders a region without a pixel.
    """
    if not render.use_border:
        return 0, 0, width, height
    # Blender multiplies in single precision and cuts off.
    edges = np.array([render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y], np.float32)
    left, right, bottom, top = (edges * np.array([width, width, height, height], np.float32)).astype(int).tolist()
    return left, bottom, right - left, top - bottom
