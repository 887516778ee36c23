# SPDX-License-Identifier: GPL-3.0-or-later
"""Étalon in the Image editors.

This is a menu of images, keys, regions drawn over them, and zooming.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ...lib.film.parts import Part
from ...lib.report.ranking import RankedRegion
from ...lib.report.views import View
from ...lib.verdict.outcome import Outcome
from ..job import BackgroundJob
from .image_writing import LABELS, Writer, image_of, load_view, reload_views, view_of
from .session import Result, session
from .text import translate

TICK = 0.2  # seconds between two looks at what is being written
# Around a region that an editor zooms to, in shares of its size.
AROUND = 0.25
MOST_BOXES = 200
BOX = (1.0, 0.35, 0.0, 0.9)
DESCRIPTIONS = {
    View.REFERENCE: "The reference's image",
    View.CYCLES: "Cycles' image",
    View.DIFFERENCE: "Red where Cycles is brighter, blue where it is darker; full colour (1) at five times the tolerance",
    View.SIGNIFICANCE: "The difference in standard errors: red above, blue below; full colour (1) at five",
    View.VERDICT: "Green agrees, red differs, yellow is undecided, blue differs for a known reason",
}
LIGHT_MENU = "ETALON_MT_light"
KEYS = ("ONE", "TWO", "THREE", "FOUR", "FIVE")

_writers: dict[int, Writer] = {}
# The result whose images were written last, and the part of the light that they show.
_written: dict[int, tuple[Result, Part | None]] = {}
_seen: dict[int, int] = {}
# The view that each Image editor waits for, by the editor's address.
_waiting: dict[int, tuple[int, View]] = {}


def writer_of(uid: int, folder: Path) -> Writer:
    """What writes the images of a scene, beside the folder of its results."""
    place = folder.with_name(f"{folder.name}-images")
    if uid not in _writers or _writers[uid].folder != place:
        _writers[uid] = Writer(place)
        _written.pop(uid, None)
        _seen[uid] = 0
    return _writers[uid]


def have_images_written(uid: int) -> None:
    """Have the images of a scene's result written.

    Those of a comparison under way are written at each look.
    """
    running, result = session.running, session.results.get(uid)
    if running is not None and running.uid == uid and running.result is None and isinstance(running.job, BackgroundJob):
        running.job.on_look = writer_of(uid, running.job.folder).write_interim
    elif result is not None:
        writer = writer_of(uid, result.folder)
        if not writer.is_busy and _written.get(uid) != (result, writer.part):
            writer.write(result.comparison)
            _written[uid] = result, writer.part
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=TICK, persistent=True)


def light_of(uid: int) -> Part | None:
    """The part of the light that the images of a scene show; None: all of it."""
    return _writers[uid].part if uid in _writers else None


def regions_shown(uid: int) -> list[RankedRegion]:
    """The regions of a scene's result, the worst first, in the part of the light that its images show."""
    result = session.results.get(uid)
    return [] if result is None else result.regions_of(light_of(uid))


def choose_light(uid: int, part: Part | None) -> None:
    """Have the images of a scene's result show a part of the light; None: all of it."""
    result = session.results.get(uid)
    if result is not None:
        writer_of(uid, result.folder).part = part
        have_images_written(uid)


def follow_result(uid: int) -> None:
    """A comparison has begun or is concluded: where its images are in use, they are to follow."""
    if any(image_of(view) is not None for view in View):
        have_images_written(uid)


def _look() -> float | None:
    """Load what has been written, and show it where it was requested."""
    for uid, writer in _writers.items():
        if uid in _written and not writer.is_busy and _written[uid][1] != writer.part:
            have_images_written(uid)
        if writer.count != _seen[uid]:
            _seen[uid] = writer.count
            reload_views(writer.folder)
            session.add_error(uid, writer.error)
        for address, (waiting_for, view) in list(_waiting.items()):
            if waiting_for == uid and writer.count and not writer.is_busy:
                _show(address, load_view(view, writer.folder))
                _waiting.pop(address)
    is_busy = any(writer.is_busy for writer in _writers.values())
    return TICK if is_busy or _waiting or session.running is not None else None


def _show(address: int, image: bpy.types.Image | None) -> None:
    """Show an image in the editor of that address, if that is still there.

    One that showed no image of Étalon's is zoomed to the whole image.
    """
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.as_pointer() == address and area.type == "IMAGE_EDITOR" and image is not None:
                    space = area.spaces.active
                    is_first = view_of(space.image) is None
                    space.image = image
                    if is_first:
                        _fit(window, area)
                    area.tag_redraw()


def _fit(window: bpy.types.Window, area: bpy.types.Area) -> None:
    """Zoom an Image editor to the whole of its image."""
    canvas = next(one for one in area.regions if one.type == "WINDOW")
    if canvas.width > 1:  # else it was never drawn
        with bpy.context.temp_override(window=window, area=area, region=canvas):
            bpy.ops.image.view_all(fit_view=True)


def image_editors(context: bpy.types.Context) -> Iterator[tuple[bpy.types.Window, bpy.types.Area]]:
    """The Image editors of all windows."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                yield window, area


def _editor_for(context: bpy.types.Context) -> bpy.types.Area:
    """The Image editor to show an image in.

    It is this one, one that is not pinned to something else, or one in a new window.
    """
    if context.area is not None and context.area.type == "IMAGE_EDITOR":
        return context.area
    free = [area for _, area in image_editors(context) if not area.spaces.active.use_image_pin]
    if free:
        return max(free, key=lambda area: view_of(area.spaces.active.image) is not None)
    bpy.ops.wm.window_new()
    area = context.window_manager.windows[-1].screen.areas[0]
    area.type = "IMAGE_EDITOR"
    return area


class ShowImage(bpy.types.Operator):
    """Show an image of the last comparison in an Image editor"""

    bl_idname = "etalon.show_image"
    bl_label = "Show Image"
    bl_options: ClassVar = {"REGISTER"}
    __annotations__ = {
        "view": bpy.props.EnumProperty(
            name="Image", items=[(view.name, LABELS[view], DESCRIPTIONS[view]) for view in View]
        )
    }

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Where there is a result, or a comparison under way."""
        scene = context.scene
        return scene is not None and (session.result_of(scene) is not None or session.is_running(scene))

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """What the image shows."""
        return translate(DESCRIPTIONS[View[properties.view]])

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Show it, or have it written and show it then."""
        uid, view, area = context.scene.session_uid, View[self.view], _editor_for(context)
        have_images_written(uid)
        writer = _writers.get(uid)
        if writer is None:
            return {"CANCELLED"}
        if writer.count and not writer.is_busy:
            _show(area.as_pointer(), load_view(view, writer.folder))
        else:
            _waiting[area.as_pointer()] = uid, view
        return {"FINISHED"}


class SwitchImage(bpy.types.Operator):
    """Show another image of the comparison"""

    bl_idname = "etalon.switch_image"
    bl_label = "Switch Image"
    __annotations__ = {"number": bpy.props.IntProperty(name="Image", min=1, max=len(View), default=1)}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """In an Image editor that shows one."""
        space = context.space_data
        return (
            space is not None
            and space.type == "IMAGE_EDITOR"
            and view_of(space.image) is not None
            and ShowImage.poll(context)
        )

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Show it."""
        return bpy.ops.etalon.show_image(view=tuple(View)[self.number - 1].name)


class ImageMenu(bpy.types.Menu):
    """The images of the last comparison"""

    bl_idname = "ETALON_MT_images"
    bl_label = "Étalon"

    def draw(self, context: bpy.types.Context) -> None:
        """One entry for each image."""
        for view in View:
            self.layout.operator(ShowImage.bl_idname, text=LABELS[view]).view = view.name
        result = session.result_of(context.scene)
        if result is not None and result.comparison.passes is not None:
            self.layout.separator()
            self.layout.menu(LIGHT_MENU, icon="OUTLINER_OB_LIGHT")


def draw_menu(header: bpy.types.Header, context: bpy.types.Context) -> None:
    """Add the menu to the header of an Image editor."""
    header.layout.menu(ImageMenu.bl_idname)


def draw_boxes() -> None:
    """Outline the regions that differ, over an image of the comparison."""
    context = bpy.context
    result = session.result_of(context.scene)
    if result is None or view_of(context.space_data.image) is None or not context.space_data.overlay.show_overlays:
        return
    regions = regions_shown(context.scene.session_uid)
    differ = [r for r in regions if r.outcome is Outcome.DIFFERENT and r.kind != "image"][:MOST_BOXES]
    to_region = context.region.view2d.view_to_region
    lines = []
    for region in differ:
        left, top, right, bottom = region.box
        corners = [
            to_region(x, y, clip=False)
            for x, y in ((left, 1 - top), (right, 1 - top), (right, 1 - bottom), (left, 1 - bottom))
        ]
        lines += [corner for pair in zip(corners, corners[1:] + corners[:1], strict=True) for corner in pair]
    if not lines:
        return
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    gpu.state.blend_set("ALPHA")
    shader.uniform_float("color", BOX)
    batch_for_shader(shader, "LINES", {"pos": lines}).draw(shader)
    gpu.state.blend_set("NONE")


def zoom_to_region(context: bpy.types.Context, region: RankedRegion) -> None:
    """Zoom each Image editor that shows an image of the comparison to a region of it."""
    left, top, right, bottom = region.box
    x, y = AROUND * (right - left), AROUND * (bottom - top)
    for window, area in image_editors(context):
        if view_of(area.spaces.active.image) is None:
            continue
        canvas = next(one for one in area.regions if one.type == "WINDOW")
        (xmin, ymin), (xmax, ymax) = (
            canvas.view2d.view_to_region(*corner, clip=False)
            for corner in ((left - x, 1.0 - bottom - y), (right + x, 1.0 - top + y))
        )
        with context.temp_override(window=window, area=area, region=canvas):
            bpy.ops.image.view_zoom_border(xmin=xmin, xmax=xmax, ymin=ymin, ymax=ymax, wait_for_input=False)


def forget_images() -> None:
    """Another file is open: nothing is waited for any more."""
    for known in (_writers, _written, _seen, _waiting):
        known.clear()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)


_keys: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []
_handles: list[object] = []


def add_to_image_editor() -> None:
    """Add menu, keys and outlines."""
    bpy.types.IMAGE_MT_editor_menus.append(draw_menu)
    configuration = bpy.context.window_manager.keyconfigs.addon
    if configuration is None:  # Blender without a window
        return
    _handles.append(bpy.types.SpaceImageEditor.draw_handler_add(draw_boxes, (), "WINDOW", "POST_PIXEL"))
    keymap = configuration.keymaps.new(name="Image", space_type="IMAGE_EDITOR")
    for number, key in enumerate(KEYS, start=1):
        item = keymap.keymap_items.new(SwitchImage.bl_idname, key, "PRESS")
        item.properties.number = number
        _keys.append((keymap, item))


def remove_from_image_editor() -> None:
    """Take them back."""
    bpy.types.IMAGE_MT_editor_menus.remove(draw_menu)
    while _handles:
        bpy.types.SpaceImageEditor.draw_handler_remove(_handles.pop(), "WINDOW")
    while _keys:
        keymap, item = _keys.pop()
        keymap.keymap_items.remove(item)
    forget_images()
