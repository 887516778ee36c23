# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as a render sees it.

Modifiers have their render levels, and what is hidden in viewports but not in renders is there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

import bpy

from ...lib.errors import EtalonError
from .nodes.declarations import DECLARATIONS
from .nodes.declared import remember_defaults
from .properties.declared import remember_properties
from .stale_images import reload_stale_images

Result = TypeVar("Result")


def _render(scene: bpy.types.Scene) -> None:
    """Have Blender render the scene; raise EtalonError where it says that it cannot."""
    try:
        bpy.ops.render.render(scene=scene.name)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ")
        if scene.render.use_border and "too small" in reason:
            what = "its render region holds no whole pixel; widen the region, or switch Render Region off"
            raise EtalonError(f"{scene.name}: {what}") from error
        raise EtalonError(f"{scene.name}: Blender cannot render it ({reason}); mend that in Blender") from error


def with_render_depsgraph(scene: bpy.types.Scene, function: Callable[[bpy.types.Depsgraph], Result]) -> Result:
    """Return `function(depsgraph)` for the depsgraph in render mode.

    It does so as with_render_frames does.
    """
    return with_render_frames(scene, lambda depsgraph, _: function(depsgraph))


def with_render_frames(
    scene: bpy.types.Scene, function: Callable[[bpy.types.Depsgraph, Callable[[float], None]], Result]
) -> Result:
    """Return `function(depsgraph, set_frame)` for the depsgraph in render mode.

    `set_frame` evaluates the depsgraph at another time, in frames; the scene's own frame comes back at the end.
    Blender hands it to a render engine only, so one that renders nothing is registered for the time of the call. The
    scene's settings come back, and whatever `function` raises is raised here. Raises EtalonError where the scene
    renders no view layer.
    """
    remember_defaults(DECLARATIONS)
    remember_properties()
    reload_stale_images()
    results: list[Result] = []
    errors: list[BaseException] = []

    class Exporter(bpy.types.RenderEngine):
        bl_idname = "ETALON_EXPORTER"
        bl_label = "Étalon exporter"

        def render(self, depsgraph: bpy.types.Depsgraph) -> None:
            if results or errors:
                return
            frame, subframe = depsgraph.scene.frame_current, depsgraph.scene.frame_subframe

            def set_frame(time: float) -> None:
                self.frame_set(math.floor(time), time - math.floor(time))

            try:
                results.append(function(depsgraph, set_frame))
            except BaseException as error:  # Blender would print it and go on
                errors.append(error)
            now = depsgraph.scene
            if (now.frame_current, now.frame_subframe) != (frame, subframe):
                self.frame_set(frame, subframe)

    render = scene.render
    kept = {
        name: getattr(render, name)
        for name in ("engine", "use_compositing", "use_sequencer", "use_persistent_data", "use_freestyle")
    }
    bpy.utils.register_class(Exporter)
    try:
        # Persistent data would keep the engine, and it is gone in a moment.
        render.use_compositing = render.use_sequencer = render.use_persistent_data = False
        render.use_freestyle = False  # its lines would be drawn over an image that there is not, and Blender dies
        render.engine = Exporter.bl_idname
        _render(scene)
    finally:
        for name, value in kept.items():
            setattr(render, name, value)
        bpy.utils.unregister_class(Exporter)
    if errors:
        raise errors[0]
    if not results:
        raise EtalonError(f"{scene.name}: no view layer is used for rendering; switch one on")
    return results[0]
