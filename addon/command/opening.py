# SPDX-License-Identifier: GPL-3.0-or-later
"""Opening what the user names, a reference scene or a .blend, in Blender."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import bpy

from ...lib.errors import EtalonError
from ...lib.plain_text import folder_name
from ...lib.settings.common import Target
from ...reference_scenes import SCENES, build
from ..host.quiet import quiet
from .assignments import assign
from .scene_choice import describe_missing, describe_unknown

# A .blend starts with its own magic, or with that of the gzip or Zstandard stream around it.
_MAGIC = (b"BLENDER", b"\x1f\x8b", b"\x28\xb5\x2f\xfd")


def open_asked(asked: Target) -> str:
    """Open what a Target names, set what it sets, and return its name.

    Raises EtalonError as `open_target`.
    """
    return open_target(asked.scene, asked.frame, asked.camera, asked.assignments, asked.view_layer)


def open_target(
    target: str | None,
    frame: int | None = None,
    camera: str | None = None,
    assignments: Sequence[str] = (),
    view_layer: str | None = None,
) -> str:
    """Open `target` and return its name; None stays with the file that is open already.

    Then the frame, the camera, the view layer and each assignment "path=value" are set. Raises EtalonError where there is no such
    scene, file, library, camera, view layer or property.
    """
    if target is not None:
        if target in SCENES:
            with quiet():
                build(target)
        elif target.endswith(".blend"):
            open_blend(Path(target))
        else:
            raise EtalonError(describe_unknown(target))
    scene = bpy.context.scene
    if frame is not None:
        scene.frame_set(frame)
    if camera is not None:
        choose_camera(scene, camera)
    if view_layer is not None:
        choose_view_layer(scene, view_layer)
    for assignment in assignments:
        assign(assignment)
    if scene.camera is None:
        raise EtalonError(f"{scene.name}: the scene has no camera; {_where_cameras_are(scene)}")
    return Path(target).stem if target else (Path(bpy.data.filepath).stem or scene.name)


def _where_cameras_are(scene: bpy.types.Scene) -> str:
    """What to do about a scene without an active camera.

    It names the cameras of the scene, or the scenes of the file that have one.
    """
    cameras = sorted(thing.name for thing in scene.objects if thing.type == "CAMERA")
    if cameras:
        return f"choose one of its cameras with --camera: {', '.join(cameras)}"
    others = sorted(other.name for other in bpy.data.scenes if other.camera is not None)
    if others:
        return f"other scenes of the file have one: {', '.join(others)}; make that the active scene and save the file"
    return "add one in Blender and make it the active camera"


def results_folder(chosen: Path | None, name: str) -> Path:
    """The folder that was chosen for the results, or one below etalon-out.

    No name can lead out of etalon-out.
    """
    return chosen or Path("etalon-out") / folder_name(name)


def as_opened(target: Target) -> Target:
    """`target` with the path of the open file where it names no scene.

    A report shows it in its command.
    """
    return replace(target, scene=target.scene or bpy.data.filepath or None)


def refuse_archive(target: Target) -> None:
    """Raise EtalonError for a scene saved as .npz, which Cycles cannot render."""
    if target.is_archive:
        raise EtalonError(f"{target.scene}: Cycles cannot render a saved scene; give the .blend, or use etalon render")


def open_blend(path: Path) -> None:
    """Load a .blend without running any script in it.

    Raises EtalonError that names what is missing or damaged.
    """
    if not path.is_file():
        raise EtalonError(describe_missing(path))
    try:
        with path.open("rb") as file:
            start = file.read(7)
    except OSError as error:
        raise EtalonError(f"{path}: cannot be read ({error.strerror}); check its permissions") from error
    if not start.startswith(_MAGIC):
        raise EtalonError(f"{path}: is not a Blender file; save it again from Blender")
    with quiet():
        try:
            bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False, use_scripts=False)
        except RuntimeError as error:
            reason = str(error).strip().splitlines()[-1].rsplit(": ", 1)[-1]
            raise EtalonError(f"{path}: Blender cannot load it ({reason}); save it again from Blender") from error


def choose_camera(scene: bpy.types.Scene, name: str) -> None:
    """Make the camera object `name` the scene's active one.

    Raises EtalonError, with the names of the cameras, where there is none of that name.
    """
    cameras = {o.name: o for o in scene.objects if o.type == "CAMERA"}
    if name not in cameras:
        there = ", ".join(sorted(cameras)) or "none"
        raise EtalonError(f"{name}: no camera of that name in scene {scene.name}; cameras there: {there}")
    scene.camera = cameras[name]


def choose_view_layer(scene: bpy.types.Scene, name: str) -> None:
    """Use the view layer `name` alone for rendering.

    Raises EtalonError, with the names of the view layers, where there is none of that name.
    """
    if name not in scene.view_layers:
        there = ", ".join(sorted(layer.name for layer in scene.view_layers))
        raise EtalonError(f"{name}: no view layer of that name in scene {scene.name}; view layers there: {there}")
    for layer in scene.view_layers:
        layer.use = layer.name == name
