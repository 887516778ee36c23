# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions of what layers leave for what lies below them."""

from __future__ import annotations

from dataclasses import dataclass

from .expressions import ONE, ZERO, Constant, Expression


@dataclass(frozen=True)
class BeneathLayer(Expression):
    """What a glossy layer leaves for the layers below it, a value.

    It is 1 - `weight` times the largest colour of the layer's albedo at |n.wo|.
    The layer is a `lib.scene.materials.Specular` of the same `ior`, `tint`, `roughness` and `distribution`; the first
    must be constant, and what describes a film on the layer, too. Anisotropy leaves the albedo's estimate as it is.
    `coat`: the layer is a coat of Blender's Principled BSDF. Departures (lib/departures): `tables`, the nodes along
    each axis of the tables from which Cycles estimates the albedo (0: the integral itself), `lossless`, as if no light
    were lost between facets, and `film_by_table`.
    """

    ior: Constant
    tint: Expression
    roughness: Expression
    weight: Expression
    distribution: str = "GGX"
    normal: Expression | None = None
    coat: bool = False
    tables: int = 0
    lossless: bool = False
    film_thickness: Constant = ZERO
    film_ior: Constant = ONE
    film_by_table: bool = False


@dataclass(frozen=True)
class BeneathSheen(Expression):
    """What sheen leaves for the layers below it, a value.

    It is 1 - the albedo at n.wo times the largest colour of `weight` `tint`.
    The sheen is a `lib.scene.materials.Sheen` of the same `roughness` and `normal`.
    """

    tint: Expression
    roughness: Expression
    weight: Expression
    normal: Expression | None = None


@dataclass(frozen=True)
class CoatTint(Expression):
    """What an absorbing coat leaves of light, a colour.

    It is 1 mixed by `weight` with tint^(1 / cos), where cos is that of |n.wo| refracted.
    """

    ior: Expression
    tint: Expression
    weight: Expression
    normal: Expression | None = None
