# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes with a known answer.

One file each builds its scene with bpy and states the expectation and its origin. building.py holds what they share,
expectation.py how an expectation is written down. Each module has `build()`, which replaces what is open in Blender,
and `EXPECTATIONS`.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from types import ModuleType

import bpy

from ..lib.errors import EtalonError
from ..lib.files.atomic import replace_file
from ..lib.settings.common import REFERENCE_SCENES

SCENES: dict[str, ModuleType] = {name: import_module(f".{name}", __name__) for name in REFERENCE_SCENES}


def build(name: str) -> None:
    """Make the reference scene `name` the one that is open.

    Raises EtalonError for an unknown name.
    """
    if name not in SCENES:
        raise EtalonError(f"{name}: no reference scene of that name; there are {', '.join(SCENES)}")
    SCENES[name].build()


def save(name: str, path: Path) -> None:
    """Build the reference scene `name` and save it as a .blend that needs no other file.

    It is written beside its place and renamed. Raises EtalonError for an unknown name or a place that cannot be written.
    """
    build(name)
    for image in bpy.data.images:
        if image.has_data or image.source == "FILE":
            image.pack()
    with replace_file(path) as beside:
        try:
            bpy.ops.wm.save_as_mainfile(filepath=str(beside.resolve()), copy=True, compress=True, check_existing=False)
        except RuntimeError as error:
            reason = str(error).strip().splitlines()[-1].removeprefix("Error: ")
            raise EtalonError(f"{path}: cannot be written ({reason}); make room or name another folder") from error
