# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions about materials: which lobes, distributions and nodes are seen."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from ..microfacets.thin_film import LEAST_THICKNESS
from ..plural import plural
from ..scene.expressions import Constant, Expression, FresnelFactor, LayerWeight
from ..scene.layers import BeneathLayer, CoatTint
from ..scene.materials import Closure, Diffuse, Glass, Glossy, Metallic, Microfacets, Specular
from ..textures.fold import walk
from .facts import Facts, is_smooth, is_zero, scatters
from .geometry import Answer

_OF_NODES = ("BECKMANN", "GGX", "MULTI_GGX", "ASHIKHMIN_SHIRLEY")
Question = Callable[[Facts], Answer]
C = TypeVar("C", bound=Closure)


def named(names: list[str], what: str, none: str) -> Answer:
    """Needed by the named things, at most three of them spelled out."""
    if not names:
        return False, none
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return True, f"{what} {', '.join(repr(n) for n in names[:3])}{more}"


def closure(kind: type[C] | tuple[type[C], ...], test: Callable[[C], bool] = lambda _: True) -> Question:
    """Whether a material that is seen has a closure of `kind` that passes the test."""

    def question(facts: Facts) -> Answer:
        names = [
            m.name for m in facts.materials if any(isinstance(x.closure, kind) and test(x.closure) for x in m.lobes)
        ]
        return named(names, "material", "no material that is seen has such a lobe")

    return question


def is_rough(closure: Microfacets | Diffuse) -> bool:
    """Whether the roughness is anything but the constant zero."""
    return not is_zero(closure.roughness)


def is_replaced(closure: Glossy) -> bool:
    """Return whether the render options gave the closure another model or Fresnel term.

    Another is one that its node does not have.
    """
    return closure.fresnel != "none" or (not is_smooth(closure) and closure.distribution not in _OF_NODES)


def has_film(closure: Closure) -> bool:
    """Whether a closure may lie under a thin film anywhere."""
    if not isinstance(closure, Metallic | Specular | Glass):
        return False
    thickness = closure.film_thickness
    return not isinstance(thickness, Constant) or thickness.number > LEAST_THICKNESS


def distribution(*names: str) -> Question:
    """Any closure with one of the distributions, smooth ones left out: they have none."""
    return closure(Microfacets, lambda c: not is_smooth(c) and c.distribution in names)


def _nodes(facts: Facts, kinds: tuple[type, ...]) -> list[str]:
    names = []
    for material in facts.materials:
        sockets = (v for x in material.lobes for v in (x.weight, *vars(x.closure).values()))
        if any(isinstance(n, kinds) for v in sockets if isinstance(v, Expression) for n in walk(v)):
            names.append(material.name)
    return names


def socket(kinds: tuple[type, ...], none: str) -> Question:
    """Return whether a socket of a visible material holds a node of one of `kinds`.

    Its constant parts are computed first.
    """
    return lambda facts: named(_nodes(facts, kinds), "material", none)


def fresnel(facts: Facts) -> Answer:
    """Whether a closure or a socket reflects by a Fresnel curve."""
    curves = facts.named((Metallic, Specular, Glass))
    terms = [m.name for m in facts.materials if any(_has_term(x.closure) for x in m.lobes)]
    factors = _nodes(facts, (FresnelFactor, LayerWeight, BeneathLayer, CoatTint))
    return named(sorted({*curves, *terms, *factors}), "material", "no lobe and no socket has a Fresnel term")


def _has_term(closure: Closure) -> bool:
    return isinstance(closure, Glossy) and closure.fresnel != "none"


def several_lobes(facts: Facts) -> Answer:
    """Whether a material scatters by more than one lobe."""
    names = [m.name for m in facts.materials if sum(scatters(x.closure) for x in m.lobes) > 1]
    return named(names, "material", "no material that is seen scatters by more than one lobe")


def several_materials(facts: Facts) -> Answer:
    """Whether hits must be told apart by their material."""
    count = len(facts.materials)
    return count > 1, f"faces have {count} materials" if count > 1 else "all faces have the same material"


def smooth_normals(facts: Facts) -> Answer:
    """Whether a face is shaded smooth."""
    mesh = facts.scene.mesh
    if mesh.corner_normals.shape[2] and mesh.smooth.any():
        return True, f"{int(mesh.smooth.sum())} of {plural(mesh.triangle_count, 'triangle')} shaded smooth"
    return False, "every face is shaded flat"
