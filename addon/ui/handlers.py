# SPDX-License-Identifier: GPL-3.0-or-later
"""Handlers of Blender's events: changes of the scene, other files, saving."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from . import images, preflight
from .regions import fill_tables
from .session import session


@persistent
def note_change(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Mark results as out of date once something that is rendered has changed.

    A selection is no change. The survey is made anew after any call.
    """
    if session.results or session.running is not None:
        for update in depsgraph.updates:
            if update.is_updated_geometry or update.is_updated_transform or update.is_updated_shading:
                session.mark_changed()
                break
    preflight.note_change()


@persistent
def forget_results(*_: object) -> None:
    """End a comparison under way before another file is opened.

    Its report holds what it has found.
    """
    session.forget()
    preflight.forget_surveys()
    images.forget_images()


@persistent
def empty_tables(*_: object) -> None:
    """Lists are kept out of files: they belong to the session."""
    for window_manager in bpy.data.window_managers:
        window_manager.etalon_regions.clear()


@persistent
def refill_tables(*_: object) -> None:
    """After saving or loading, the lists show what the session has."""
    for window_manager in bpy.data.window_managers:
        fill_tables(window_manager)


_HANDLERS = {
    "depsgraph_update_post": note_change,
    "load_pre": forget_results,
    "load_post": refill_tables,
    "save_pre": empty_tables,
    "save_post": refill_tables,
    "save_post_fail": refill_tables,
}


def add_handlers() -> None:
    """Have Blender call the handlers."""
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def remove_handlers() -> None:
    """Take the handlers back."""
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
