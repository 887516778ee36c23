# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison under way, watched by a timer.

Its result is shown as soon as there is one, whatever windows come and go.
"""

from __future__ import annotations

import bpy

from ...lib.pages.formats import format_bound, format_duration
from .images import follow_result
from .regions import fill_tables
from .session import Running, session
from .text import translate

TICK = 0.05  # seconds between two looks at the job
# The region of each editor that shows the panels. The others are left alone: a 3D view takes long to draw.
REGIONS = {"PROPERTIES": "WINDOW", "VIEW_3D": "UI", "IMAGE_EDITOR": "UI"}

# What the job calls its stages; the test of translations reads them here.
STAGES = (
    "reading the scene",
    "timing the renderers",
    "looking for caustics",
    "first look",
    "rendering",
    "rendering what is open",
    "writing the report",
    "looking for the smallest scene that shows it",
    "rendering each setting",
    "measuring",
)


def describe_stage(running: Running) -> str:
    """The stage that is under way, or that the job is ending."""
    if running.job.is_cancelled and running.result is None:
        return translate("Ending")
    said = translate(running.job.stage)
    return said[0].upper() + said[1:]


def describe_bound(running: Running) -> str:
    """How closely the images agree so far, and whether that is improving.

    Empty before the first look and when the result is there.
    """
    bounds = [one.bound for one in running.job.bounds]
    if not bounds or running.result is not None:
        return ""
    if bounds[-1] == float("inf"):
        return translate("No bound yet")
    known = [bound for bound in bounds if bound < float("inf")]
    is_falling = len(known) > 1 and known[-1] < known[-2]
    return translate("Within {bound}, falling" if is_falling else "Within {bound}", bound=format_bound(bounds[-1]))


def describe_time(running: Running) -> str:
    """The time that is left.

    Empty before rendering has begun, in the last second, and when the result is there.
    """
    left = running.job.seconds_left
    if left is None or left < 1.0 or running.result is not None:
        return ""
    return translate("{time} left", time=format_duration(round(left)))


def describe_running(running: Running) -> str:
    """All of it in one line, for the status bar."""
    parts = describe_stage(running), describe_time(running), describe_bound(running), translate("Esc cancels")
    return "Étalon:  " + "   ·   ".join(filter(None, parts))


def redraw() -> None:
    """Draw again wherever a panel of Étalon may be shown."""
    for window_manager in bpy.data.window_managers:
        for window in window_manager.windows:
            for area in window.screen.areas:
                for region in area.regions:
                    if region.type == REGIONS.get(area.type):
                        region.tag_redraw()


def set_status(text: str | None) -> None:
    """Show `text` in the status bars of all windows; None gives them back to Blender."""
    for window_manager in bpy.data.window_managers:
        for window in window_manager.windows:
            window.workspace.status_text_set(text)
    if text is None:  # also where a workspace was shown in the meantime
        for workspace in bpy.data.workspaces:
            workspace.status_text_set(None)


def watch_job() -> None:
    """Look at the job from now on, until it has ended; at one job once."""
    follow_result(session.running.uid)
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=TICK, persistent=True)


def _look() -> float | None:
    """Take over the results that there are.

    Returns the seconds until the next look, or None when the job has ended.
    """
    running = session.running
    if running is None:
        set_status(None)
        redraw()
        return None
    is_done = running.job.done
    if session.take_result() is not None:
        for window_manager in bpy.data.window_managers:
            fill_tables(window_manager)
        follow_result(running.uid)
    if is_done:
        session.end()
    set_status(None if is_done else describe_running(running))
    redraw()
    return None if is_done else TICK
