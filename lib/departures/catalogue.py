# SPDX-License-Identifier: GPL-3.0-or-later
"""Every known departure of Cycles from the model, its place in Cycles, when it can matter."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Set
from dataclasses import dataclass

from ..blender_versions import Release, Versions, format_release, parse_release
from ..effects.surface import has_film
from ..errors import EtalonError
from ..film.light_passes import Family, LightPass, direct, indirect
from ..scattering.subsurface import BY_DISK
from ..scene.converters import Curves
from ..scene.expressions import ColorRamp
from ..scene.findings import OVERLAPPING_FACES, OVERLAPPING_LIGHTS
from ..scene.layers import BeneathLayer
from ..scene.materials import Glass, Subsurface
from ..scene.scene import Scene
from ..textures.fold import fold_scene
from .relevance import (
    closures_of,
    disperses,
    has_faces_in_one_plane,
    has_leaning_normals,
    has_lights_in_one_plane,
    has_materials_in_one_plane,
    has_motion,
    has_narrow_spread,
    has_rough_diffuse,
    has_rough_facets,
    has_tilted_faces_in_one_plane,
    interpolates_codes,
    multiplies_alpha,
    nodes_of,
    reflects_by,
    samples_rough_glass,
)

ALL = Versions()
EVERYWHERE = frozenset(LightPass)


def scattered_by(*families: Family) -> frozenset[LightPass]:
    """Return the passes that lobes of `families` affect, at once or after more scattering."""
    return frozenset([*map(direct, families), *map(indirect, Family)])


DIFFUSE = scattered_by(Family.DIFFUSE)
GLOSSY = scattered_by(Family.GLOSSY)
FACETS = scattered_by(Family.GLOSSY, Family.TRANSMISSION)


@dataclass(frozen=True)
class Departure:
    """One departure.

    `statement` says what Cycles does and what is right; `source` is the file in Cycles' tree, `versions` the Blender releases that depart
    so, as read in Cycles' source since 4.2 and measured on 4.5, 5.2 and 5.3. `relevant` asks a folded scene whether it can change anything.
    `neutralised` names the setting by which Étalon's neutral state removes it from Cycles; such a departure has no switch in the reference.
    `by_rounding`: rounding, or how Cycles weighs light samples, decides how much of it acts, so that Cycles may lie anywhere between none
    and all of its effect. `form_of` names another departure of which it is a form: the two do not add up.
    `finding` is the check of the scene check that says what in the scene calls for it, where that is a fault of the scene.
    `passes` are the light passes that it can act on. `forms` are the releases, in order, from which on it has another form.
    """

    name: str
    statement: str
    source: str
    versions: Versions = ALL
    relevant: Callable[[Scene], bool] = lambda scene: False
    neutralised: str = ""
    by_rounding: bool = False
    form_of: str = ""
    finding: str = ""
    passes: frozenset[LightPass] = EVERYWHERE
    forms: tuple[str, ...] = ()

    def form(self, release: Release | None) -> int | None:
        """Return the form of a release, from 0, or None if it has none. No release: the newest."""
        if release is not None and release not in self.versions:
            return None
        return sum(release is None or release >= parse_release(first) for first in self.forms)


def changed(first: Scene, second: Scene, masking: str = "correlated") -> tuple[Departure, ...]:
    """Return the departures that affect a scene and differ between two exporting releases."""
    either = dict.fromkeys((*relevant(first, masking), *relevant(second, masking)))
    return tuple(d for d in either if d.form(first.blender) != d.form(second.blender))


def relevant(scene: Scene, masking: str = "correlated") -> tuple[Departure, ...]:
    """Return the departures with a switch that can affect `scene` under this masking.

    Those of the Blender that exported the scene; of any release where none did.
    """
    same = "correlated masking" if masking == "correlated" else None
    folded = fold_scene(scene)
    return tuple(d for d in _switches(scene) if d.name != same and d.relevant(folded))


def refuse_absent(scene: Scene, names: Set[str]) -> None:
    """Raise EtalonError if the Blender that exported `scene` lacks one of `names`."""
    if scene.blender is None:
        return
    present = {d.name for d in _switches(scene)}
    for departure in DEPARTURES:
        if departure.name in names - present:
            raise EtalonError(
                f"departure '{departure.name}' exists in Blender {departure.versions}, and this scene comes from Blender "
                f"{format_release(scene.blender)}; leave it out"
            )


def _switches(scene: Scene) -> Iterator[Departure]:
    """The departures with a switch that the Blender of `scene` has."""
    return (d for d in DEPARTURES if not d.neutralised and (scene.blender is None or scene.blender in d.versions))


DEPARTURES: tuple[Departure, ...] = (
    Departure(
        "correlated masking",
        "Masking and shadowing are correlated by the facet's height, 1 / (1 + Lambda(i) + Lambda(o)), which is exact for Smith's surfaces; "
        "the reference was asked for another form.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=has_rough_facets,
        passes=FACETS,
    ),
    Departure(
        "rational Beckmann Lambda",
        "Smith's Lambda of Beckmann's distribution is a rational fit, 0 beyond its bound; 1 + Lambda is up to 0.31 % off the exact one.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=reflects_by("BECKMANN"),
        passes=FACETS,
    ),
    Departure(
        "rational Beckmann density",
        "Visible normals of Beckmann's distribution are sampled exactly, but their density is stated with the rational Lambda: "
        "light found by BSDF sampling is multiplied by (1 + fit) / (1 + exact), light found by light sampling is not.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=reflects_by("BECKMANN"),
        passes=FACETS,
    ),
    Departure(
        "Ashikhmin-Shirley sampling",
        "A half vector that faces away from the viewer should give no sample. Cycles turns it round but keeps its old cosine, so that "
        "the sampled direction is no reflection and no unit vector: BSDF sampling adds light at grazing angles, +36 % at 80 degrees for "
        "roughness 0.7. Light sampling does not.",
        "kernel/closure/bsdf_ashikhmin_shirley.h",
        relevant=reflects_by("ASHIKHMIN_SHIRLEY"),
        passes=GLOSSY,
    ),
    Departure(
        "refraction from behind",
        "Light sampling through rough glass counts facets that the viewer or the light sees from behind, through which nothing passes; "
        "BSDF sampling does not.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=samples_rough_glass,
        passes=FACETS,
    ),
    Departure(
        "light below the face",
        "On smooth-shaded faces, and where a displacement bumps the surface, BSDF sampling rejects directions below the face, light "
        "sampling does not: what arrives from there counts by its share in multiple importance sampling.",
        "kernel/closure/bsdf.h",
        relevant=has_leaning_normals,
    ),
    Departure(
        "undispersed reflectance",
        "What dispersive glass reflects at normal incidence is that of its index at Fraunhofer's line d, at every wavelength; by Fresnel's "
        "equations it follows the index.",
        "kernel/closure/bsdf_microfacet.h",
        Versions("5.3"),
        lambda scene: any(isinstance(c, Glass) and disperses(c) for c in closures_of(scene)),
        passes=FACETS,
    ),
    Departure(
        "texture interpolation",
        "sRGB texels are interpolated as code values and decoded afterwards; light mixes linearly, so the reference decodes them first.",
        "kernel/svm/image.h",
        relevant=interpolates_codes,
    ),
    Departure(
        "alpha in code values",
        "Alpha is multiplied into the code values of a texture before they are decoded, of 8-bit textures with the result cut off to 8 bits. "
        "Alpha is a share of light, so the reference multiplies decoded colours. Where the texture's Alpha is not used, a grey of code 0.6 at "
        "alpha 0.5 becomes 0.073 in place of 0.159; where it is, alpha is divided out again, and the rounding stays.",
        "util/image_metadata.cpp",
        relevant=multiplies_alpha,
    ),
    Departure(
        "multiple-scattering tables",
        "The albedos behind Multiscatter GGX are read from tables, and the mean reflectance that colours it from fits. Up to Blender 5.2 "
        "there are 32 x 32 nodes, for glass 16 x 16 x 16: up to 1 % off the integral, for glass 19 % (from inside, where the reference "
        "reproduces a part of it), most at grazing. From 5.3 on the "
        "nodes crowd there, for glass 32 x 32 x 32: up to 0.3 % off.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=reflects_by("MULTI_GGX"),
        forms=("5.3",),
    ),
    Departure(
        "layer albedo table",
        "What a glossy layer leaves to those beneath it is estimated from a table that leaves masking between facets out, with "
        "16 x 16 x 16 nodes up to Blender 5.2 and 32 x 32 x 32 from 5.3 on: light is taken from below that the layer itself does not "
        "give, or the other way round. Under a thin film it is that of a smooth surface. "
        "An index below 1 is read as its reciprocal, without total reflection, so that light is made.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=lambda scene: any(isinstance(n, BeneathLayer) for n in nodes_of(scene)),
        forms=("5.3",),
    ),
    Departure(
        "lossless coat albedo",
        "What a coat takes from the layers beneath it is estimated as if its facets lost no light between each other: a factor "
        "E + Fms (1 - E) is missing, and light is lost, up to 1.7 times of what the coat reflects.",
        "kernel/closure/bsdf.h",
        Versions("5.3"),
        lambda scene: any(isinstance(n, BeneathLayer) and n.coat for n in nodes_of(scene)),
    ),
    Departure(
        "thin film series",
        "What a thin film reflects is summed to the third order of interference, from a table with an entry for every 18.7 nm of path "
        "difference: up to 2 % of white off on metals, 0.4 % on dielectrics, most near grazing.",
        "kernel/closure/bsdf_util.h",
        Versions("5.0"),
        lambda scene: any(map(has_film, closures_of(scene))),
        passes=FACETS,
    ),
    Departure(
        "thin film from inside",
        "From inside glass, the path of light in a film on it is counted in wavelengths of the glass, as if the film were thinner by the "
        "glass's index: it has other colours than from outside.",
        "kernel/closure/bsdf_microfacet.h",
        Versions("5.0"),
        lambda scene: any(isinstance(c, Glass) and has_film(c) for c in closures_of(scene)),
        passes=FACETS,
    ),
    Departure(
        "Oren-Nayar without multiple scattering",
        "A rough diffuse surface reflects what leaves after one scattering; the light that is scattered again is lost.",
        "kernel/closure/bsdf_oren_nayar.h",
        Versions(None, "4.2"),
        has_rough_diffuse,
        passes=DIFFUSE,
    ),
    Departure(
        "Oren-Nayar colour",
        "Light that a rough diffuse surface scatters k times carries its colour k times; Cycles multiplies all but the first by the "
        "colour once more.",
        "kernel/closure/bsdf_oren_nayar.h",
        Versions("4.3", "5.2"),
        has_rough_diffuse,
        passes=DIFFUSE,
    ),
    Departure(
        "short subsurface walks",
        "A walk below a surface ends after 256 free paths, and the light that has not left by then is lost: about 10 % of what a thick white "
        "body reflects, 5 % of a colour of 0.95, 0.2 % of 0.8. From the eleventh free path on scattering is isotropic, and as much weaker.",
        "kernel/integrator/subsurface_random_walk.h",
        relevant=lambda scene: any(isinstance(c, Subsurface) and c.mapping != BY_DISK for c in closures_of(scene)),
        passes=DIFFUSE,
    ),
    Departure(
        "colour-ramp table",
        "A Color Ramp is read from a table of 257 entries: corners are rounded off and steps move by up to 1/256.",
        "kernel/svm/ramp.h",
        relevant=lambda scene: any(isinstance(n, ColorRamp) for n in nodes_of(scene)),
    ),
    Departure(
        "curve table",
        "RGB, Vector and Float Curves are read from one table of 257 entries a channel. Beyond the ends of a curve Cycles goes on along "
        "the last two entries; Blender's own curve goes on along the handle of its last point.",
        "kernel/svm/ramp.h",
        relevant=lambda scene: any(isinstance(n, Curves) for n in nodes_of(scene)),
    ),
    Departure(
        "narrow spread",
        "An area light whose spread is at most 0.1 radians is normalised by 3 / h^3 in place of 1 / (tan h - h), h half the "
        "spread: up to 0.1 % too bright.",
        "scene/light.cpp",
        relevant=has_narrow_spread,
    ),
    Departure(
        "faces in one plane",
        "Faces that overlap in one plane are one surface. Cycles' rays skip only the face that they leave and meet the others at distance "
        "0, so that these hide all light from each other. Where the plane is not along two axes, rounding decides which rays meet them.",
        "kernel/bvh/util.h",
        relevant=has_faces_in_one_plane,
        by_rounding=True,
        finding=OVERLAPPING_FACES,
    ),
    Departure(
        "rounding in one plane",
        "Where faces overlap in a plane that is not along two axes, single precision decides at each point whether rays that leave one face "
        "meet the other. A part of the light is hidden, and some goes on behind the face, into closed bodies and out of them elsewhere.",
        "kernel/bvh/util.h",
        Versions("5.2"),  # 4.5 rounds otherwise; 5.0 and 5.1 were not measured
        relevant=has_tilted_faces_in_one_plane,
        by_rounding=True,
        form_of="faces in one plane",
        finding=OVERLAPPING_FACES,
    ),
    Departure(
        "other of two faces",
        "Where faces of different materials overlap in one plane, rounding decides which of them a ray meets. The reference meets one, "
        "and Cycles may meet the other.",
        "kernel/bvh/bvh.h",
        relevant=has_materials_in_one_plane,
        by_rounding=True,
        finding=OVERLAPPING_FACES,
    ),
    Departure(
        "lights in one plane",
        "Where area lights overlap in one plane, scattered rays meet only one of them, and the part of the others' light that light samples "
        "leave to these rays is lost. That part depends on Cycles' densities; at most all light of the others is lost.",
        "kernel/light/light.h",
        relevant=has_lights_in_one_plane,
        by_rounding=True,
        finding=OVERLAPPING_LIGHTS,
    ),
    Departure(
        "shutter ends",
        "With motion blur the shutter opens after 0.2 % of its time and closes 0.6 % before its end.",
        "util/math_cdf.cpp",
        relevant=has_motion,
    ),
    Departure(
        "corrected glossy normal",
        "Glossy closures turn the shading normal until the mirror direction rises above the face.",
        "kernel/closure/bsdf_util.h",
        neutralised="material.cycles.use_bump_map_correction",
    ),
    Departure(
        "disk for sphere",
        "Point and spot lights with a radius are disks turned to the shading point.",
        "kernel/light/point.h",
        neutralised="light.use_soft_falloff",
    ),
    Departure(
        "shadow terminator offset",
        "Shadow rays from smooth meshes start off the surface.",
        "kernel/light/sample.h",
        neutralised="object.shadow_terminator_geometry_offset",
    ),
    Departure(
        "sample 0",
        "The first sample of each pixel goes through its centre, whatever the seed.",
        "kernel/integrator/init_from_camera.h",
        neutralised="cycles.use_sample_subset",
    ),
    Departure(
        "filter table",
        "Pixel filters but the box are read from a table whose last entry is 0: one sample in 1023 per axis is displaced.",
        "scene/film.cpp",
        neutralised="cycles.pixel_filter_type",
    ),
    Departure(
        "float32 accumulation",
        "Samples are added up in single precision: 5e-5 after 4,096, 6e-4 after 65,536.",
        "kernel/film/write.h",
        neutralised="cycles.samples, partial sums of at most 4,096 added up in double precision",
    ),
)

SWITCHES = frozenset(d.name for d in DEPARTURES if not d.neutralised)
"""The names that Options.departures takes."""
