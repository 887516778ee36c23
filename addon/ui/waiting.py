# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators have in common that start a job: Esc ends it, and its end is reported."""

from __future__ import annotations

import bpy

from .errors import translate_error
from .session import session
from .text import phrase_text, translate
from .watching import TICK, watch_job


class Watched:
    """An operator whose `execute` starts a job of the session and returns `wait_for_end`."""

    def wait_for_end(self, context: bpy.types.Context) -> set[str]:
        """Have the job watched, and stay for Esc."""
        self._watched = session.running
        watch_job()
        self._timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """End the job on Esc; once it has ended, report its result."""
        is_running = session.running is self._watched
        if is_running and event.type == "ESC" and event.value == "PRESS":
            session.running.job.cancel()
            return {"RUNNING_MODAL"}
        if is_running:
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self._timer)
        self._report_end()
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Keep the job when its window or the file goes away.

        It goes on in the other windows, and handlers end it with the file.
        """
        context.window_manager.event_timer_remove(self._timer)

    def _report_end(self) -> None:
        ended = self._watched
        for error in ended.job.errors:
            self.report({"ERROR"}, translate_error(error))
        if ended.result is not None:
            self.report({"INFO"}, translate("Étalon: {verdict}", verdict=phrase_text(ended.result.headline)))
        elif ended.job.is_cancelled:
            self.report({"INFO"}, translate("Étalon: cancelled before there was a result"))
        elif not ended.job.errors:
            self.report({"INFO"}, translate("Étalon: done"))
