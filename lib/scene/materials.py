# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: a flat list of lobes, each a closure with a weight.

Mix and Add shaders are flattened at export: the weight of a lobe is the product of the factors on its way to
the output. Sockets are expressions, so that a textured socket and a constant one have one form.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..film.light_passes import Family
from .expressions import ONE, WHITE, ZERO, Constant, Expression
from .volumes import Volume


@dataclass(frozen=True)
class Closure:
    """Base of all closures.

    A `color` among the fields multiplies all that the closure does; `normal` is a unit vector of the world (None: the shading normal).
    `families` are those of its light passes, as Cycles counts (kernel/svm/types.h, kernel/film/light_passes.h); () where it scatters nothing.
    """

    families: ClassVar[tuple[Family, ...]] = ()


class Microfacets(Closure):
    """Base of the closures with a `distribution` of microfacets and a `roughness`.

    It is no dataclass, so each closure declares its own defaults.
    """

    distribution: str
    roughness: Expression


class Anisotropic(Microfacets):
    """Base of the closures with `anisotropy`, `rotation` (in turns) and `tangent`.

    Those that reflect by a Fresnel curve may lie under a film of `film_thickness` nm and the index `film_ior`.
    """

    anisotropy: Expression
    rotation: Expression
    tangent: Tangent

    @property
    def is_anisotropic(self) -> bool:
        """Whether the tangent matters.

        It does with any anisotropy but a constant of at most 1e-4, which counts as none, as in Cycles.
        """
        return not (isinstance(self.anisotropy, Constant) and np.all(np.abs(self.anisotropy.value) <= 1e-4))


@dataclass(frozen=True)
class Diffuse(Closure):
    """Lambert where `roughness` is 0, else Cycles' energy-preserving Fujii Oren-Nayar."""

    families: ClassVar[tuple[Family, ...]] = (Family.DIFFUSE,)
    color: Expression = WHITE
    roughness: Expression = ZERO
    normal: Expression | None = None


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
class Glossy(Anisotropic):
    """Microfacet reflection without Fresnel (Blender's Glossy BSDF).

    `distribution`: 'BECKMANN', 'GGX', 'MULTI_GGX', 'ASHIKHMIN_SHIRLEY', or a model that replaces it, such as 'student-t:g=2.5'
    (settings/models.py). `roughness` is Blender's; alpha = roughness^2. `anisotropy` in (-1, 1) and `rotation` (in turns) as on the node.
    `fresnel`: 'none', as in Blender, or a term of settings/models.py.
    """

    families: ClassVar[tuple[Family, ...]] = (Family.GLOSSY,)
    distribution: str = "GGX"
    color: Expression = WHITE
    roughness: Expression = ZERO
    anisotropy: Expression = ZERO
    rotation: Expression = ZERO
    tangent: Tangent = Tangent()
    normal: Expression | None = None
    fresnel: str = "none"


@dataclass(frozen=True)
class Metallic(Anisotropic):
    """Microfacet reflection from a metal (Blender's Metallic BSDF).

    `anisotropy` in [0, 1) stretches as there.
    `fresnel` 'F82': `base` is the colour at normal incidence, `edge` tints near grazing. 'CONDUCTOR': index `base` + i
    `edge`.
    """

    families: ClassVar[tuple[Family, ...]] = (Family.GLOSSY,)
    distribution: str = "GGX"
    fresnel: str = "F82"
    base: Expression = WHITE
    edge: Expression = WHITE
    roughness: Expression = ZERO
    anisotropy: Expression = ZERO
    rotation: Expression = ZERO
    tangent: Tangent = Tangent()
    normal: Expression | None = None
    film_thickness: Expression = ZERO
    film_ior: Expression = ONE


@dataclass(frozen=True)
class Specular(Anisotropic):
    """Microfacet reflection from a dielectric of index `ior`, the same on both faces.

    Blender's Principled BSDF has it as coat and as specular.
    `tint` multiplies the reflectance at normal incidence and fades towards grazing. `anisotropy` as in Metallic.
    """

    families: ClassVar[tuple[Family, ...]] = (Family.GLOSSY,)
    distribution: str = "GGX"
    ior: Expression = ONE
    tint: Expression = WHITE
    roughness: Expression = ZERO
    anisotropy: Expression = ZERO
    rotation: Expression = ZERO
    tangent: Tangent = Tangent()
    normal: Expression | None = None
    film_thickness: Expression = ZERO
    film_ior: Expression = ONE


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
class Translucent(Closure):
    """Lambert on the far side of the surface."""

    families: ClassVar[tuple[Family, ...]] = (Family.DIFFUSE,)
    color: Expression = WHITE
    normal: Expression | None = None


@dataclass(frozen=True)
class Subsurface(Closure):
    """Light that enters an object, scatters inside it and leaves by a diffuse lobe.

    Blender's Subsurface Scattering.
    `color` is about the albedo of a thick body, `radius` the mean free path of each channel in metres, as `mapping`
    reads it (lib/scattering/subsurface.py); `anisotropy` is that of the scattering. Light enters by refraction at GGX
    facets of `alpha` and the index `ior`, and half of it by the cosine where it enters `softly`. With the mapping 'BURLEY' it
    takes no walk: it leaves about the point by Burley's profile, and of all this only `color`, `radius` and `normal` count.
    """

    families: ClassVar[tuple[Family, ...]] = (Family.DIFFUSE,)
    color: Expression = WHITE
    radius: Expression = WHITE
    anisotropy: Expression = ZERO
    ior: Expression = ONE
    alpha: Expression = ONE
    mapping: str = "VAN_DE_HULST"
    softly: bool = False
    normal: Expression | None = None


@dataclass(frozen=True)
class Sheen(Closure):
    """A layer of upright fibers; lib/bsdfs/sheen.py.

    Blender's Sheen BSDF 'Microfiber', and its Principled BSDF.
    `roughness` in [0, 1] is Blender's.
    """

    families: ClassVar[tuple[Family, ...]] = (Family.DIFFUSE,)
    color: Expression = WHITE
    roughness: Expression = ZERO
    normal: Expression | None = None


@dataclass(frozen=True)
class Velvet(Closure):
    """Ashikhmin's velvet (Blender's Sheen BSDF 'Ashikhmin', Velvet BSDF of older files).

    `sigma` in [0, 1] is the node's Roughness.
    """

    families: ClassVar[tuple[Family, ...]] = (Family.GLOSSY,)
    color: Expression = WHITE
    sigma: Expression = ONE
    normal: Expression | None = None


@dataclass(frozen=True)
class Toon(Closure):
    """A cone of light about the normal (Blender's Toon BSDF).

    `size` and `smooth` in [0, 1] are parts of a right angle.
    """

    families: ClassVar[tuple[Family, ...]] = (Family.DIFFUSE,)
    color: Expression = WHITE
    size: Expression = ONE
    smooth: Expression = ZERO
    normal: Expression | None = None


@dataclass(frozen=True)
class GlossyToon(Toon):
    """The same about the mirror direction."""

    families: ClassVar[tuple[Family, ...]] = (Family.GLOSSY,)


@dataclass(frozen=True)
class Glass(Anisotropic):
    """Dielectric interface with exact Fresnel; smooth where `roughness` is 0.

    `distribution`: 'BECKMANN', 'GGX' or 'MULTI_GGX', whose lost light is given back with the colour of many bounces `transmission`.
    `reflection` and `transmission` tint what is reflected and what is refracted; `tint` multiplies the reflectance at normal
    incidence and fades towards grazing. `anisotropy` as in Glossy, for what is refracted too.
    `dispersion` is the reciprocal of the Abbe number; `ior` is then the index at Fraunhofer's line d.
    """

    # By the side on which the light arrives: the viewer's first.
    families: ClassVar[tuple[Family, ...]] = (Family.GLOSSY, Family.TRANSMISSION)
    color: Expression = WHITE
    ior: Expression = ONE
    roughness: Expression = ZERO
    distribution: str = "GGX"
    reflection: Expression = WHITE
    transmission: Expression = WHITE
    tint: Expression = WHITE
    anisotropy: Expression = ZERO
    rotation: Expression = ZERO
    tangent: Tangent = Tangent()
    dispersion: Expression = ZERO
    normal: Expression | None = None
    film_thickness: Expression = ZERO
    film_ior: Expression = ONE


@dataclass(frozen=True)
class Refraction(Microfacets):
    """Refraction without Fresnel; zero under total internal reflection.

    `distribution`: 'BECKMANN' or 'GGX'.
    """

    families: ClassVar[tuple[Family, ...]] = (Family.TRANSMISSION,)
    color: Expression = WHITE
    ior: Expression = ONE
    roughness: Expression = ZERO
    distribution: str = "GGX"
    normal: Expression | None = None


WIDE = (Diffuse, Translucent, Subsurface, Sheen, Velvet, Toon)
"""Closures that scatter into directions about the normal, whatever their sockets hold, and GlossyToon."""


@dataclass(frozen=True)
class WeightedClosure:
    """One closure and the value or colour that weighs it."""

    closure: Closure
    weight: Expression = ONE


@dataclass(frozen=True)
class Displacement:
    """How far a material moves the vertices of its faces.

    `offset` is a value, the length along the vertex's normal, or with `is_vector` a colour, the vector itself. Both are lengths of
    `space`: 'OBJECT' or 'WORLD'; or the vector has components along tangent (of the active UV map), normal and bitangent, in the
    object's lengths: 'TANGENT'. With `bumps`, lobes have the normal of a bump on the surface as it was. The offset is evaluated once,
    when a scene is made (lib/surfaces/displacement.py).
    """

    offset: Expression
    space: str = "OBJECT"
    is_vector: bool = False
    bumps: bool = False


@dataclass(frozen=True)
class Material:
    """A material as the user named it; no lobes means black.

    `unknown` says what of it is not simulated, '' where all is. What such a material does to light is not known: it has no
    lobes, paths end there, and what they would have brought is missing from their pixels. It is `passive` where it can only send on
    light that it receives: it does not emit, and its faces stay where they are. Shadow rays pass through what is transparent of
    it only with `transparent_shadows`. `volume` fills what the faces of an object enclose, None: nothing does. Faces that are `only_bounds`
    of it let light pass as if they were not there. The vertices of the scene's mesh are where `displacement` moved them.
    """

    name: str
    lobes: tuple[WeightedClosure, ...]
    unknown: str = ""
    transparent_shadows: bool = True
    volume: Volume | None = None
    only_bounds: bool = False
    passive: bool = False
    displacement: Displacement | None = None
