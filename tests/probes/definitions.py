# SPDX-License-Identifier: GPL-3.0-or-later
"""The probes behind the fingerprints.

They are closures by their node and sockets, the light, and the angles. No Blender is needed to read them.
"""

from dataclasses import dataclass, field

from etalon.lib.blender_versions import Versions

TILTS = (-1.45, -1.1, -0.5, 0.1, 0.6, 1.15, 1.45)
"""Angles (radians, about x) by which the facets lean away from the viewer, who looks down along -z."""
FEW_TILTS = (0.1, 0.4, 0.7, 1.0)
"""Those of facets under a light that needs many samples."""
GRAZING_TILTS = (1.4,)

IRRADIANCE = 2.0
_ABOVE, _BEHIND = (0.35, -0.3, 1.0), (0.3, 0.2, -1.0)
SUNS = {"front": _ABOVE, "back": _BEHIND, "front prism": _ABOVE, "back prism": _BEHIND}
"""Towards the sun (not normalised), above the facets or behind them. One sample of a sun has no noise, unless glass disperses it."""
FURNACES = ("furnace", "grazing furnace")
"""A furnace is a white world, whose light only BSDF sampling finds: it is for facts that a sun does not show."""
LIGHTS = (*SUNS, *FURNACES)
NOISY = ("front prism", "back prism", *FURNACES)
"""The lights that need many samples."""

EVERY = Versions()
Value = float | tuple[float, ...]


@dataclass(frozen=True)
class Probe:
    """One node with its sockets, on facets of all angles under one light.

    `distribution` is a Toon node's component, too.

    `fact` is what a change in Cycles is reported as. `node` is Blender's type without 'ShaderNode', `inputs` go by
    identifier, colours are RGBA. `normal`: colour and strength of a normal map that turns the node's normal. A node
    with anisotropy has its tangent along the UV map's u. `versions`: the releases of Blender that have all of its
    sockets.
    """

    fact: str
    name: str
    light: str
    node: str
    inputs: dict[str, Value] = field(default_factory=dict)
    distribution: str = ""
    fresnel: str = ""
    normal: tuple[tuple[float, ...], float] | None = None
    versions: Versions = EVERY

    @property
    def key(self) -> str:
        """Name and light: unique among all probes."""
        return f"{self.name}, {self.light}"

    @property
    def is_stretched(self) -> bool:
        """Whether the node is anisotropic."""
        return bool(self.inputs.get("Anisotropy") or self.inputs.get("Anisotropic"))


def tilts(light):
    """The angles of the facets under a light."""
    if light == "grazing furnace":
        return GRAZING_TILTS
    return FEW_TILTS if light in NOISY else TILTS


RED, BLUE, WHITE, BLACK = (0.9, 0.3, 0.15, 1.0), (0.3, 0.5, 0.9, 1.0), (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0)
F82 = {"Base Color": RED, "Edge Tint": BLUE}
CONDUCTOR = {"IOR": (0.2, 0.9, 1.3), "Extinction": (3.9, 2.4, 1.9)}
MAPPED = ((0.62, 0.42, 0.93, 1.0), 0.5)  # the viewer sees the front of every turned normal
STRETCH = {"Anisotropy": 0.6, "Rotation": 0.1}
BOTH_SIDES = ("front", "back")
FILMS = Versions("5.0")  # films as they are simulated
NEW_GLASS = Versions("5.3")  # glass that is anisotropic, and glass that disperses


def _glossy(fact, distribution, roughness, light="front", **inputs):
    stretched = f" {inputs['Anisotropy']}" if "Anisotropy" in inputs else ""
    inputs = {"Color": RED, "Roughness": roughness, **inputs}
    return Probe(fact, f"Glossy {distribution} {roughness}{stretched}", light, "BsdfGlossy", inputs, distribution)


def _metallic(fact, fresnel, distribution, roughness, versions=EVERY, **inputs):
    stretched = f" {inputs['Anisotropy']}" if "Anisotropy" in inputs else ""
    stretched += " film" if "Thin Film IOR" in inputs else ""
    inputs = {"Roughness": roughness, **(F82 if fresnel == "F82" else CONDUCTOR), **inputs}
    name = f"Metallic {fresnel} {distribution} {roughness}{stretched}"
    return Probe(fact, name, "front", "BsdfMetallic", inputs, distribution, fresnel, versions=versions)


def _interface(fact, node, distribution, roughness, ior):
    # Refraction by Beckmann's facets shows nothing of light on the viewer's side.
    lights = ("back",) if (node, distribution) == ("BsdfRefraction", "BECKMANN") else BOTH_SIDES
    inputs = {"Color": BLUE, "Roughness": roughness, "IOR": ior}
    name = f"{node.removeprefix('Bsdf')} {distribution} {roughness} {ior}"
    return [Probe(fact, name, light, node, inputs, distribution) for light in lights]


def _stretched_glass(distribution, roughness, ior, anisotropy):
    inputs = {"Color": BLUE, "Roughness": roughness, "IOR": ior, "Anisotropy": anisotropy, "Rotation": 0.1}
    fact = "anisotropic glass table" if distribution == "MULTI_GGX" else "anisotropic glass"
    name = f"Glass {distribution} {roughness} {ior} {anisotropy}"
    return [Probe(fact, name, light, "BsdfGlass", inputs, distribution, versions=NEW_GLASS) for light in BOTH_SIDES]


def _principled(fact, name, distribution="GGX", *lights, versions=EVERY, **inputs):
    inputs = {"Base Color": RED, **{key.replace("_", " "): value for key, value in inputs.items()}}
    return [
        Probe(fact, f"Principled {name}", light, "BsdfPrincipled", inputs, distribution, versions=versions)
        for light in lights or ("front",)
    ]


def _sheen(fact, distribution, roughness):
    inputs = {"Color": RED, "Roughness": roughness}
    return Probe(fact, f"Sheen {distribution} {roughness}", "front", "BsdfSheen", inputs, distribution)


def _mapped(name, node, distribution="", **inputs):
    fresnel = "F82" if node == "BsdfMetallic" else ""
    return Probe("normal maps", f"mapped {name}", "front", node, inputs, distribution, fresnel, MAPPED)


GLASSY = {"Transmission_Weight": 1.0, "Specular_Tint": BLUE, "Roughness": 0.6}
DISPERSION = {"Transmission_Dispersion_Scale": 1.0, "Transmission_Dispersion_Abbe_Number": 15.0}
FILM = {"Thin_Film_Thickness": 420.0, "Thin_Film_IOR": 1.4}
COAT = {"Coat_Weight": 0.8, "Coat_IOR": 1.5}

PROBES = (
    Probe("Lambert", "Diffuse", "front", "BsdfDiffuse", {"Color": RED}),
    *(Probe("Lambert", "Translucent", light, "BsdfTranslucent", {"Color": RED}) for light in BOTH_SIDES),
    *(Probe("Oren-Nayar", f"Diffuse {r}", "front", "BsdfDiffuse", {"Color": RED, "Roughness": r}) for r in (0.3, 1.0)),
    Probe("Oren-Nayar", "white Diffuse 0.6", "front", "BsdfDiffuse", {"Color": WHITE, "Roughness": 0.6}),
    *(_glossy("GGX", "GGX", r) for r in (0.3, 0.7)),
    _glossy("GGX", "GGX", 0.5, **STRETCH),
    *(_glossy("Beckmann", "BECKMANN", r) for r in (0.3, 0.7)),
    _glossy("Beckmann", "BECKMANN", 0.5, **STRETCH),
    _glossy("Beckmann density", "BECKMANN", 0.4, "furnace"),
    *(_glossy("Ashikhmin-Shirley", "ASHIKHMIN_SHIRLEY", r) for r in (0.3, 0.8)),
    *(_glossy("Ashikhmin-Shirley", "ASHIKHMIN_SHIRLEY", r, **STRETCH) for r in (0.3, 0.8)),
    *(_glossy("Ashikhmin-Shirley sampling", "ASHIKHMIN_SHIRLEY", r, "furnace") for r in (0.3, 0.4)),
    _glossy("Ashikhmin-Shirley sampling at grazing", "ASHIKHMIN_SHIRLEY", 0.5, "grazing furnace"),
    _glossy("Ashikhmin-Shirley sampling at grazing", "ASHIKHMIN_SHIRLEY", 0.5, "grazing furnace", **STRETCH),
    *(_metallic("F82", "F82", d, r) for d in ("BECKMANN", "GGX") for r in (0.3, 0.8)),
    _metallic("F82", "F82", "GGX", 0.5, Anisotropy=0.7, Rotation=0.1),
    *(_metallic("conductor", "PHYSICAL_CONDUCTOR", d, 0.5) for d in ("BECKMANN", "GGX")),
    *(_glossy("GGX table", "MULTI_GGX", r) for r in (0.2, 0.45, 0.7, 0.95)),
    _metallic("GGX table", "F82", "MULTI_GGX", 0.7),
    _metallic("mean reflectance of a conductor", "PHYSICAL_CONDUCTOR", "MULTI_GGX", 0.7),
    *(
        probe
        for node in ("BsdfGlass", "BsdfRefraction")
        for distribution in ("BECKMANN", "GGX")
        for roughness, ior in ((0.4, 1.5), (0.8, 1.5), (0.6, 0.7))
        for probe in _interface("glass", node, distribution, roughness, ior)
    ),
    *(
        probe
        for roughness in (0.3, 0.6)
        for probe in _interface("glass table", "BsdfGlass", "MULTI_GGX", roughness, 1.5)
    ),
    *_interface("glass table, index below 1", "BsdfGlass", "MULTI_GGX", 0.7, 0.7),
    *_principled("layer albedo", "layer 0.5"),
    *_principled("layer albedo", "layer 0.2", Roughness=0.2),
    *_principled("layer albedo", "layer 1.0 1.8", Roughness=1.0, IOR=1.8),
    *_principled("layer albedo", "layer MULTI_GGX 0.5", "MULTI_GGX"),
    *_principled("layer albedo", "layer MULTI_GGX 1.0 1.8", "MULTI_GGX", Roughness=1.0, IOR=1.8),
    *_principled("layer albedo", "layer level 1", Specular_IOR_Level=1.0, Specular_Tint=BLUE),
    *_principled("layer albedo, index below 1", "layer 0.8", IOR=0.8),
    *_principled("Principled", "level 0", Specular_IOR_Level=0.0),
    *_principled("Principled", "metal", Metallic=1.0, Specular_Tint=BLUE),
    *_principled("Principled", "stretched metal", Metallic=1.0, Anisotropic=0.6, Anisotropic_Rotation=0.15),
    *_principled("Principled", "glass", "GGX", "front", "back", **GLASSY),
    *(
        probe
        for how in (("BECKMANN", 0.6, 1.5, 0.6), ("GGX", 0.6, 1.5, 0.6), ("GGX", 0.5, 0.7, -0.5), ("MULTI_GGX", 0.6, 1.5, 0.6))
        for probe in _stretched_glass(*how)
    ),
    *_principled("anisotropic glass", "stretched glass", "GGX", *BOTH_SIDES, versions=NEW_GLASS, Anisotropic=0.6,
                 Anisotropic_Rotation=0.15, **GLASSY),
    *_principled("dispersion", "glass", "GGX", "back prism", versions=NEW_GLASS, **GLASSY, **DISPERSION),
    *_principled("dispersion", "reflecting glass", "GGX", "front prism", versions=NEW_GLASS, **GLASSY, **DISPERSION),
    *_principled("Oren-Nayar", "rough diffuse", Specular_IOR_Level=0.0, Diffuse_Roughness=0.6),
    *_principled("coat albedo", "coat 0.2", Specular_IOR_Level=0.0, Coat_Roughness=0.2, **COAT),
    *_principled("coat albedo", "coat 0.4", Specular_IOR_Level=0.0, Coat_Roughness=0.4, **COAT),
    *_principled("coat albedo", "coat 0.8", Specular_IOR_Level=0.0, Coat_Roughness=0.8, **COAT),
    *(
        probe
        for weight in (0.5, 1.0)
        for probe in _principled("coat tint", f"tinted coat {weight}", Specular_IOR_Level=0.0, Coat_Weight=weight,
                                 Coat_Roughness=0.4, Coat_Tint=BLUE)
    ),
    *(
        Probe("thin film", f"Metallic {fresnel} film {thickness} {ior}", "front", "BsdfMetallic",
              {"Roughness": 0.5, **how, "Thin Film Thickness": thickness, "Thin Film IOR": ior}, "GGX", fresnel, versions=FILMS)
        for fresnel, how in (("F82", F82), ("PHYSICAL_CONDUCTOR", CONDUCTOR))
        for thickness, ior in ((0.6, 1.8), (150.0, 1.33), (600.0, 2.2))
    ),
    _metallic("GGX table", "F82", "MULTI_GGX", 0.7, versions=FILMS, **{"Thin Film Thickness": 350.0, "Thin Film IOR": 1.5}),
    *(
        Probe("thin film", f"Glass {distribution} film {thickness}", light, "BsdfGlass",
              {"Roughness": 0.5, "IOR": 1.5, "Thin Film Thickness": thickness, "Thin Film IOR": 1.8}, distribution, versions=FILMS)
        for distribution, thickness in (("GGX", 200.0), ("GGX", 900.0), ("BECKMANN", 450.0))
        for light in BOTH_SIDES
    ),
    *_principled("thin film", "film on metal", versions=FILMS, Metallic=1.0, Specular_Tint=BLUE, **FILM),
    *_principled("thin film", "film on glass", "GGX", *BOTH_SIDES, versions=FILMS, **GLASSY, **FILM),
    *_principled("thin film layer", "film on layer", versions=FILMS, **FILM),
    *_principled("thin film layer", "film on tinted layer", versions=FILMS, Specular_Tint=BLUE, IOR=1.8, **FILM),
    *_principled("thin film layer", "film on layer MULTI_GGX", "MULTI_GGX", versions=FILMS, Roughness=0.8, **FILM),
    *(_sheen("sheen", "MICROFIBER", roughness) for roughness in (0.05, 0.3, 0.7, 1.0)),
    *(_sheen("velvet", "ASHIKHMIN", sigma) for sigma in (0.15, 0.3, 1.0)),
    *_principled("Principled sheen", "sheen 0.2", Sheen_Weight=0.8, Sheen_Roughness=0.2, Sheen_Tint=BLUE),
    *_principled("Principled sheen", "sheen 0.6 over metal", Metallic=1.0, Sheen_Weight=1.0, Sheen_Roughness=0.6),
    *_principled("Principled sheen", "sheen over coat", Specular_IOR_Level=0.0, Sheen_Weight=1.0, Sheen_Roughness=0.5,
                 Sheen_Tint=BLUE, **COAT),
    *(
        Probe("toon", f"Toon {component} {size} {smooth}", "front", "BsdfToon",
              {"Color": RED, "Size": size, "Smooth": smooth}, component)
        for component, size, smooth in (("DIFFUSE", 0.6, 0.3), ("DIFFUSE", 0.9, 0.6), ("GLOSSY", 0.5, 0.4), ("GLOSSY", 0.8, 0.0))
    ),
    _mapped("Sheen", "BsdfSheen", "MICROFIBER", Roughness=0.5),
    _mapped("sheen", "BsdfPrincipled", "GGX", Roughness=0.6, Metallic=1.0, **{"Sheen Weight": 0.8, "Coat Weight": 0.5}),
    _mapped("Toon", "BsdfToon", "GLOSSY", Size=0.7, Smooth=0.4),
    _mapped("Diffuse", "BsdfDiffuse", Color=RED),
    _mapped("rough Diffuse", "BsdfDiffuse", Color=WHITE, Roughness=0.4),
    _mapped("Glossy", "BsdfGlossy", "GGX", Roughness=0.5),
    _mapped("Glass", "BsdfGlass", "GGX", Roughness=0.5, IOR=1.5),
    _mapped("Metallic", "BsdfMetallic", "GGX", Roughness=0.4, **F82),
    _mapped("metal", "BsdfPrincipled", "GGX", Roughness=0.6, Metallic=1.0),
)  # fmt: skip
"""Every probe. A fact that a probe shows besides its own must have a probe of its own, too."""


def probes_of(release):
    """The probes whose sockets a release of Blender has."""
    return tuple(probe for probe in PROBES if release in probe.versions)


def facts_of(release):
    """What the probes of a release show, in their order."""
    return tuple(dict.fromkeys(probe.fact for probe in probes_of(release)))
