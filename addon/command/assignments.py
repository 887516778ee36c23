# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties set by their data path, as `--set` and a batch do.

No part of an assignment is ever evaluated as Python.
"""

from __future__ import annotations

import json
import re

import bpy

from ...lib.errors import EtalonError

# An equals sign inside a quoted name belongs to the path; the last attribute may carry an index.
_ASSIGNMENT = re.compile(r'((?:[^"=]|"(?:[^"\\]|\\.)*")+)=(.*)', re.DOTALL)
_LAST = re.compile(r"(?:(.*)\.)?(\w+)(?:\[(\d+)\])?", re.DOTALL)


def assign(assignment: str) -> None:
    """Set one property, as in 'objects["Lamp"].location[2]=3.5'.

    The left side is a data path from bpy.data (or `scene.`), the right side a value as in JSON. Raises EtalonError
    where the path leads nowhere, the value does not fit, or Blender would change it in silence.
    """
    parts = _ASSIGNMENT.fullmatch(assignment)
    if parts is None:
        raise EtalonError(f"{assignment}: is not PATH=VALUE; give a data path and a value")
    path, text = parts[1].strip(), parts[2].strip()
    try:
        value = json.loads(text)
    except ValueError:
        value = text
    owner, name, index = _resolve(path)
    try:
        if index is None:
            setattr(owner, name, value)
        else:
            getattr(owner, name)[index] = value
    except (TypeError, ValueError, AttributeError, IndexError) as error:
        raise EtalonError(f"{path}: cannot be set to {text} ({str(error).strip().splitlines()[-1]})") from error
    kept = getattr(owner, name) if index is None else getattr(owner, name)[index]
    if not _same(kept, value):
        raise EtalonError(f"{path}: Blender turns {text} into {kept}; give a value in the property's range")


def _resolve(path: str) -> tuple[bpy.types.bpy_struct, str, int | None]:
    """The struct that has the property, the property's name, and the index of a component."""
    last = _LAST.fullmatch(path)
    start, rest = bpy.data, last[1] if last else None
    if rest is not None and (rest == "scene" or rest.startswith("scene.")):
        start, rest = bpy.context.scene, rest[6:]
    try:
        owner = start.path_resolve(rest) if rest else start
        known = last is not None and last[2] in owner.bl_rna.properties
    except (ValueError, AttributeError):
        known = False
    if not known:
        raise EtalonError(f"{path}: no such property; copy its full data path in Blender, less the leading bpy.data.")
    return owner, last[2], None if last[3] is None else int(last[3])


def _same(kept: object, value: object) -> bool:
    """Whether Blender kept the value, up to its single precision."""
    if isinstance(value, list):
        return len(kept) == len(value) and all(map(_same, kept, value))
    if isinstance(value, (int, float)) and isinstance(kept, (int, float)):
        return abs(kept - value) <= 1e-6 * max(1.0, abs(value))
    return kept == value
