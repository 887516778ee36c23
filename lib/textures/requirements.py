# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials ask of the geometry, so that only that is exported."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields

from ..scene.expressions import ZERO, Attribute, Coordinates, Expression, NormalMap, Undisplaced
from ..scene.materials import Anisotropic, Material, Tangent
from ..scene.mesh import UNDISPLACED, UNDISPLACED_NORMAL
from .fold import walk


@dataclass(frozen=True)
class Requirements:
    """What materials read: UV maps, attributes and generated coordinates.

    UV maps are names ('' is the active render map), attributes are names ('' is the active render colour), and
    generated coordinates are read or not.
    """

    uv_maps: frozenset[str]
    generated: bool
    attributes: frozenset[str] = frozenset()


def requirements(materials: Iterable[Material]) -> Requirements:
    """Return what `materials` read.

    They read through their textures, also those of their displacement, and through the tangents of anisotropic lobes.
    """
    uv_maps: set[str] = set()
    attributes: set[str] = set()
    generated = False
    for material in materials:
        for kind, uv_map in _reads(material):
            if kind in ("UV", "TANGENT"):
                uv_maps.add(uv_map)
            elif kind == "ATTRIBUTE":
                attributes.add(uv_map)
            generated = generated or kind == "GENERATED"
    return Requirements(frozenset(uv_maps), generated, frozenset(attributes))


def reads_tangents(material: Material) -> bool:
    """Whether `material` reads tangents along a UV map: through a tangent-space normal map or an anisotropic lobe."""
    return any(kind == "TANGENT" for kind, _ in _reads(material))


def _reads(material: Material) -> Iterator[tuple[str, str]]:
    """Kinds of coordinates, with the name where the kind is 'UV', 'TANGENT' (along a UV map) or 'ATTRIBUTE'."""
    if material.displacement is not None:
        yield from _reads_of(material.displacement.offset)
        if material.displacement.space == "TANGENT":
            yield "UV", ""
    for lobe in material.lobes:
        yield from _reads_of(lobe.weight)
        for value in (getattr(lobe.closure, f.name) for f in fields(lobe.closure)):
            if isinstance(value, Expression):
                yield from _reads_of(value)
        if isinstance(lobe.closure, Anisotropic) and lobe.closure.anisotropy != ZERO:
            yield from _tangent_reads(lobe.closure.tangent)


def _reads_of(root: Expression) -> Iterator[tuple[str, str]]:
    for node in walk(root):
        if isinstance(node, Coordinates):
            yield node.kind, node.uv_map
        elif isinstance(node, NormalMap) and node.space == "TANGENT":
            yield "TANGENT", node.uv_map
        elif isinstance(node, Attribute):
            yield "ATTRIBUTE", node.name
        elif isinstance(node, Undisplaced):
            yield from (("ATTRIBUTE", name) for name in (UNDISPLACED, UNDISPLACED_NORMAL))


def _tangent_reads(tangent: Tangent) -> Iterator[tuple[str, str]]:
    yield ("TANGENT", tangent.uv_map) if tangent.kind == "UV" else ("GENERATED", "")
