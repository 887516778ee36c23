# SPDX-License-Identifier: GPL-3.0-or-later
"""The methods of subsurface scattering.

The Subsurface Scattering node and the Principled BSDF share them.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ....lib.blender_versions import Versions
from ....lib.scattering.subsurface import BY_DISK
from ....lib.scene import expressions as ex
from ....lib.scene import materials as mt
from ....lib.scene.converters import VectorMath

# Before, Random Walk was what is called Random Walk (Legacy) since, and no method scattered backwards.
_NEW_WALK = Versions("5.2")
_SKIN = "RANDOM_WALK_SKIN"


@dataclass(frozen=True)
class Method:
    """One method: its `mapping` to a medium, and the bounds of the anisotropy.

    lib/scattering/subsurface.py has the mappings.
    """

    mapping: str
    least: float
    most: float

    @property
    def is_skin(self) -> bool:
        """Whether half of the light enters by the cosine.

        The node's own index of subsurface scattering counts then.
        """
        return self.mapping == "SKIN"

    @property
    def is_disk(self) -> bool:
        """Whether light takes no walk, so that anisotropy, index and roughness do not count."""
        return self.mapping == BY_DISK


def read_method(node: bpy.types.Node, name: str) -> Method:
    """The method in the node's property `name`, as Cycles of this Blender takes it."""
    identifier = getattr(node, name)
    new = bpy.app.version[:2] in _NEW_WALK
    least, most = (-0.99, 0.9) if new else (0.0, 0.9)
    if identifier == BY_DISK:
        return Method(BY_DISK, least, most)
    if identifier == _SKIN:
        return Method("SKIN", least, most)
    return Method("VAN_DE_HULST", -0.99, 0.99) if new and identifier == "RANDOM_WALK" else Method("FITTED", least, most)


def parts_of(closure: mt.Subsurface) -> list[tuple[mt.Closure, ex.Expression]]:
    """The closures that a method is made of, each with the share of its weight.

    Christensen and Burley's scatters on the surface where a diffuse lobe has scattered the path before, as in Cycles.
    """
    if closure.mapping != BY_DISK:
        return [(closure, ex.ONE)]
    late = ex.AfterDiffuse()
    diffuse = mt.Diffuse(closure.color, normal=closure.normal)
    return [(closure, ex.Math("SUBTRACT", ex.ONE, late, ex.ZERO)), (diffuse, late)]


def make_subsurface(
    method: Method,
    color: ex.Expression,
    radius: ex.Expression,
    scale: ex.Expression,
    anisotropy: ex.Expression,
    ior: ex.Expression,
    alpha: ex.Expression,
    normal: ex.Expression | None,
) -> mt.Subsurface:
    """The closure of a method; the product of `radius` and `scale` is in metres."""
    bounded = ex.Math("MAXIMUM", anisotropy, ex.Constant(method.least), ex.ZERO)
    bounded = ex.Math("MINIMUM", bounded, ex.Constant(method.most), ex.ZERO)
    metres = VectorMath("SCALE", radius, ex.BLACK, ex.BLACK, scale)
    return mt.Subsurface(color, metres, bounded, ior, alpha, method.mapping, method.is_skin, normal)
