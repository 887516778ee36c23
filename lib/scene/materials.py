# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: a flat list of lobes, each a closure with a weight.

Mix and Add shaders are flattened at export: the weight of a lobe is the product of the factors on its way to
the output. Sockets are expressions, so that a textured socket and a constant one have one form.
"""

from __future__ import annotations

from dataclasses import dataclass

from .expressions import ONE, WHITE, ZERO, Constant, Expression


class Closure:
    """Base of all closures."""


@dataclass(frozen=True)
class Diffuse(Closure):
    """Lambert where `roughness` is 0, else Cycles' energy-preserving Fujii Oren-Nayar."""

    color: Expression = WHITE
    roughness: Expression = ZERO


@dataclass(frozen=True)
class Tangent:
    """Where the tangent of an anisotropic lobe comes from.

    `kind`: 'RADIAL' about `axis` ('X', 'Y', 'Z') in generated coordinates (Blender's default, axis Z) or 'UV' (the
    direction of growing u of `uv_map`).
    """

    kind: str = "RADIAL"
    axis: str = "Z"
    uv_map: str = ""


@dataclass(frozen=True)
class Glossy(Closure):
    """Microfacet reflection without Fresnel (Blender's Glossy BSDF).

    `distribution`: 'BECKMANN', 'GGX' or 'MULTI_GGX'. `roughness` is Blender's; alpha = roughness^2. `anisotropy` in
    (-1, 1) and `rotation` (in turns) as on the node.
    """

    distribution: str = "GGX"
    color: Expression = WHITE
    roughness: Expression = ZERO
    anisotropy: Expression = ZERO
    rotation: Expression = ZERO
    tangent: Tangent = Tangent()

    @property
    def is_anisotropic(self) -> bool:
        """Whether the tangent matters: any anisotropy but a constant that counts as none (at most 1e-4, as in Cycles)."""
        return not (isinstance(self.anisotropy, Constant) and abs(self.anisotropy.value) <= 1e-4)


@dataclass(frozen=True)
class Emission(Closure):
    """Radiance color * strength in all directions on both faces, W m^-2 sr^-1."""

    color: Expression = WHITE
    strength: Expression = ONE


@dataclass(frozen=True)
class Transparent(Closure):
    """Light passes straight on, multiplied by `color`."""

    color: Expression = WHITE


@dataclass(frozen=True)
class Glass(Closure):
    """Smooth dielectric interface: exact Fresnel, Snell; `color` tints reflection and transmission."""

    color: Expression = WHITE
    ior: Expression = ONE


@dataclass(frozen=True)
class Refraction(Closure):
    """Smooth refraction alone, no Fresnel (zero under total internal reflection)."""

    color: Expression = WHITE
    ior: Expression = ONE


@dataclass(frozen=True)
class Lobe:
    """One closure and the value that weighs it."""

    closure: Closure
    weight: Expression = ONE


@dataclass(frozen=True)
class Material:
    """A material as the user named it; no lobes means black."""

    name: str
    lobes: tuple[Lobe, ...]
