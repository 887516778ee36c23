# SPDX-License-Identifier: GPL-3.0-or-later
"""Which family of light passes each closure belongs to, as Cycles counts (kernel/svm/types.h, kernel/film/light_passes.h)."""

from __future__ import annotations

from ..film.light_passes import Family
from ..scene.materials import (
    Closure,
    Diffuse,
    Glass,
    Glossy,
    GlossyToon,
    Metallic,
    Refraction,
    Sheen,
    Specular,
    Subsurface,
    Toon,
    Translucent,
    Velvet,
)

FAMILIES: dict[type[Closure], tuple[Family, ...]] = {
    Diffuse: (Family.DIFFUSE,),
    Translucent: (Family.DIFFUSE,),
    Subsurface: (Family.DIFFUSE,),
    Sheen: (Family.DIFFUSE,),
    Toon: (Family.DIFFUSE,),
    GlossyToon: (Family.GLOSSY,),
    Velvet: (Family.GLOSSY,),
    Glossy: (Family.GLOSSY,),
    Metallic: (Family.GLOSSY,),
    Specular: (Family.GLOSSY,),
    Refraction: (Family.TRANSMISSION,),
    # By the side on which the light arrives: the viewer's first.
    Glass: (Family.GLOSSY, Family.TRANSMISSION),
}
