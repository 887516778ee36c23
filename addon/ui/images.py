# SPDX-License-Identifier: GPL-3.0-or-later
"""Étalon in the Image editors."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ...lib.report.ranking import RankedRegion

# Around a region that an editor zooms to, in shares of its size.
AROUND = 0.25


def image_editors(context: bpy.types.Context) -> Iterator[tuple[bpy.types.Window, bpy.types.Area]]:
    """The Image editors of all windows that show an image."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR" and area.spaces.active.image is not None:
                yield window, area


def zoom_to_region(context: bpy.types.Context, region: RankedRegion) -> None:
    """Zoom each Image editor that shows an image to a region of it."""
    left, top, right, bottom = region.box
    x, y = AROUND * (right - left), AROUND * (bottom - top)
    for window, area in image_editors(context):
        canvas = next(one for one in area.regions if one.type == "WINDOW")
        edges = [
            canvas.view2d.view_to_region(*corner, clip=False)
            for corner in ((left - x, 1.0 - bottom - y), (right + x, 1.0 - top + y))
        ]
        (xmin, ymin), (xmax, ymax) = edges
        with context.temp_override(window=window, area=area, region=canvas):
            bpy.ops.image.view_zoom_border(xmin=xmin, xmax=xmax, ymin=ymin, ymax=ymax, wait_for_input=False)
