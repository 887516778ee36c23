# SPDX-License-Identifier: GPL-3.0-or-later
"""The check that no property is ignored in silence.

A property that is in no table must be as Blender makes it, and an enum must have a value that is read.
"""

from __future__ import annotations

from typing import Any

import bpy

from ....lib.errors import Refusal
from .fresh_structs import content_of, make_structs
from .known import Group
from .of_blender import BLENDER_GROUPS
from .of_cycles import CYCLES_GROUPS

GROUPS: dict[str, Group] = {**CYCLES_GROUPS, **BLENDER_GROUPS}
"""By kind of struct: what is known of its properties."""

_undeclared: dict[tuple[str, str], tuple[str, ...]] = {}
_fresh: dict[tuple[str, str], dict[str, Any]] = {}


def undeclared(group: str, owner: Any) -> tuple[str, ...]:
    """The properties of a struct that its group's tables do not have.

    They are found once in each Blender. Left out: what every datablock has, what an add-on registered on Blender's own
    structs, and read-only values.
    """
    key = (group, owner.bl_rna.identifier)
    if key not in _undeclared:
        known, own = GROUPS[group], group not in CYCLES_GROUPS and not owner.bl_rna.identifier.startswith("Cycles")
        common = {"rna_type", "name", "animation_data", *bpy.types.ID.bl_rna.properties.keys()}
        _undeclared[key] = tuple(
            one.identifier
            for one in owner.bl_rna.properties
            if one.identifier not in common
            and not (own and one.is_runtime)
            and not (one.is_readonly and one.type not in ("POINTER", "COLLECTION"))
            and not known.knows(one.identifier, bpy.app.version)
        )
    return _undeclared[key]


def remember_properties() -> None:
    """Learn what fresh structs hold in the properties that no table has; once.

    Call it before a render, not in it.
    """
    if _fresh:
        return
    for group, struct in make_structs():
        key = (group, struct.bl_rna.identifier)
        _fresh[key] = {name: content_of(struct, name) for name in undeclared(group, struct)}


def refuse_undeclared(owner: str, group: str, struct: Any, refusals: list[Refusal]) -> None:
    """Append undeclared properties that are not as Blender makes them.

    Enum values that no table has are appended too.
    """
    maker = "Cycles' setting" if group in CYCLES_GROUPS else "property"
    fresh = _fresh.get((group, struct.bl_rna.identifier), {})
    for name in undeclared(group, struct):
        kind = struct.bl_rna.properties[name]
        if content_of(struct, name) != fresh.get(name, getattr(kind, "default", None)):
            refusals.append(Refusal(owner, f"{maker} '{kind.name}' ({name})", "set it back to its default"))
    for name, known in GROUPS[group].values.items():
        value = getattr(struct, name, None)
        if value is not None and not _is_value(value, known):
            label = struct.bl_rna.properties[name].name
            refusals.append(Refusal(owner, f"{label} {value} (property {name})", f"choose another {label}"))


def _is_value(value: str, known: str) -> bool:
    """Whether `value` is one of the known ones; a value of words stands alone in its table."""
    return value == known or value in known.split()
