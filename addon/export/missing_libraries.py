# SPDX-License-Identifier: GPL-3.0-or-later
"""Linked libraries that are missing.

They are refused where an object's faces are missing, and a finding of the scene check where anything else is.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ...lib.errors import Refusal
from ...lib.plural import plural
from ...lib.scene.findings import Finding, list_names

_REMEDY = "restore or relink the library, or do not render it"
# What may be missing while the faces are there; the rest is refused with the object that it belongs to.
_KINDS = ("materials", "node_groups", "worlds", "images", "textures", "actions")


def refuse_missing(depsgraph: bpy.types.Depsgraph, refusals: list[Refusal]) -> None:
    """Append collections and objects of the view layer whose data a missing library holds."""
    for collection in depsgraph.scene.collection.children_recursive:
        if collection.is_missing and not collection.hide_render:
            refusals.append(_refusal("collection", collection, collection))
    for thing in depsgraph.view_layer.objects:
        if not thing.hide_render:
            refusals.extend(_refusal("object", thing, one) for one in _parts(thing) if one.is_missing)


def _parts(thing: bpy.types.Object) -> Iterator[bpy.types.ID]:
    """Yield what an object cannot be rendered without.

    That is the object itself, its data and the collection that it shows.
    """
    yield thing
    if thing.data is not None:
        yield thing.data
    if thing.instance_type == "COLLECTION" and thing.instance_collection is not None:
        yield thing.instance_collection


def _refusal(kind: str, owner: bpy.types.ID, missing: bpy.types.ID) -> Refusal:
    what = f"{missing.bl_rna.name.lower()} '{missing.name}' of the library '{missing.library.filepath}', which is not there,"
    return Refusal(f"{kind} '{owner.name}'", what, _REMEDY)


def find_missing_libraries() -> tuple[Finding, ...]:
    """Find the data-blocks of missing libraries that Blender replaced by empty ones.

    Those that are refused are not among them.
    """
    missing = [one for kind in _KINDS for one in getattr(bpy.data, kind) if one.is_missing]
    if not missing:
        return ()
    files = ", ".join(f"'{path}'" for path in dict.fromkeys(one.library.filepath for one in missing))
    names = list_names([f"{one.bl_rna.name} {one.name}" for one in missing])
    return (
        Finding(
            "missing libraries",
            f"{plural(len(missing), 'data-block is', 'data-blocks are')} missing with the library {files}: {names}.",
            "Both sides show what Blender puts in their place, such as a material as Blender makes it.",
            "Restore or relink the library.",
        ),
    )
