# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: collections of receivers and blockers become sets of objects.

Blender's rules resolve the collections, and the sets are numbered as in Cycles. Within one collection the last
statement about an object counts: its child collections first, with the state of the outermost one for all that they
hold, then its own objects. A collection that includes something names all that is lit; one that only excludes
lights the rest.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import bpy

from ...lib.errors import Refusal
from ...lib.scene.links import EVERY_SET, Links

_MOST = 63
"""Sets and collections that Blender can tell apart; beyond them it drops some without saying so in the file."""


@dataclass(frozen=True)
class _Table:
    """The set of each named object, and the sets that each linked collection reaches.

    Objects are the original ones.
    """

    set_of: dict[bpy.types.Object, int]
    reached: dict[bpy.types.Collection, int]


class LinkTable:
    """The light linking of all that a render's depsgraph shows."""

    def __init__(self, depsgraph: bpy.types.Depsgraph, refusals: list[Refusal]) -> None:
        emitters = {instance.object.original: None for instance in depsgraph.object_instances}
        self._receivers = _resolve(emitters, "receiver_collection", refusals)
        self._blockers = _resolve(emitters, "blocker_collection", refusals)

    def links_of(self, thing: bpy.types.Object) -> Links:
        """What the light of an object or a light reaches, and what hides it."""
        linking = thing.original.light_linking
        return Links(
            self._receivers.reached.get(linking.receiver_collection, EVERY_SET),
            self._blockers.reached.get(linking.blocker_collection, EVERY_SET),
        )

    def sets_of(self, instance: bpy.types.DepsgraphObjectInstance) -> tuple[int, int]:
        """The sets of receivers and of blockers that an object is in.

        They are its instancer's, or its own where the instancer is in none.
        """
        owners = [one.original for one in (instance.parent, instance.object) if one is not None]
        found = [[table.set_of.get(one, 0) for one in owners] for table in (self._receivers, self._blockers)]
        receiver, blocker = (next(filter(None, numbers), 0) for numbers in found)
        return receiver, blocker


def _resolve(emitters: dict[bpy.types.Object, None], name: str, refusals: list[Refusal]) -> _Table:
    """The sets by the collections that emitters have as `name`."""
    linked = (getattr(thing.light_linking, name) for thing in emitters)
    collections = list(dict.fromkeys(one for one in linked if one is not None))
    states = [dict(_states(collection)) for collection in collections]
    kinds: dict[tuple[str | None, ...], int] = {}
    set_of: dict[bpy.types.Object, int] = {}
    for thing in dict.fromkeys(thing for each in states for thing in each):
        kind = tuple(each.get(thing) for each in states)
        set_of[thing] = kinds.setdefault(kind, len(kinds) + 1)
    if max(len(collections), len(kinds)) > _MOST:
        what = f"light linking with more than {_MOST} collections or sets of objects"
        refusals.append(Refusal("the scene", what, "link fewer"))
    return _Table(set_of, {one: _reached(kinds, k) for k, one in enumerate(collections)})


def _reached(kinds: dict[tuple[str | None, ...], int], k: int) -> int:
    """The sets that collection `k` reaches, one bit each.

    They are the sets that it includes, or all that it does not exclude.
    """
    included = sum(1 << number for kind, number in kinds.items() if kind[k] == "INCLUDE")
    excluded = sum(1 << number for kind, number in kinds.items() if kind[k] == "EXCLUDE")
    return included or EVERY_SET & ~excluded


def _states(collection: bpy.types.Collection) -> Iterator[tuple[bpy.types.Object, str]]:
    """Each object that a collection names, and INCLUDE or EXCLUDE; the last counts."""
    collection = collection.original
    for child, link in zip(collection.children, collection.collection_children, strict=True):
        yield from ((thing, link.light_linking.link_state) for thing in _all_objects(child))
    for thing, link in zip(collection.objects, collection.collection_objects, strict=True):
        yield thing, link.light_linking.link_state


def _all_objects(collection: bpy.types.Collection) -> Iterator[bpy.types.Object]:
    for child in collection.children:
        yield from _all_objects(child)
    yield from collection.objects
