# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue: every known departure of Cycles from the book, where it stands in Cycles, and when it can matter."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ..scene.expressions import BeneathLayer, ColorRamp, EnvironmentTexture, Expression, ImageTexture
from ..scene.lights import AreaLight
from ..scene.materials import Anisotropic, Closure, Diffuse, Emission, Glass, Refraction
from ..scene.scene import Scene
from ..textures.fold import fold, is_constant, walk
from .scene import NARROW

SEEN = ("4.5", "5.2")


@dataclass(frozen=True)
class Departure:
    """One departure.

    `statement` says what Cycles does and what the book has; `source` is the file in Cycles' tree, `versions` the Blender releases it
    was seen in. `relevant` asks a scene whether it can change anything. `neutralised` names the setting by which Étalon's
    neutral state removes it from Cycles; such a departure has no switch in the reference.
    """

    name: str
    statement: str
    source: str
    versions: tuple[str, ...] = SEEN
    relevant: Callable[[Scene], bool] = lambda scene: False
    neutralised: str = ""


def relevant(scene: Scene, masking: str = "correlated") -> tuple[Departure, ...]:
    """The departures with a switch that can change the image of `scene` where the reference has this form of masking."""
    same = {"correlated": "correlated masking", "separable": "separable masking"}.get(masking)
    return tuple(d for d in DEPARTURES if not d.neutralised and d.name != same and d.relevant(scene))


def _closures(scene: Scene) -> Iterator[Closure]:
    for material in scene.materials:
        for lobe in material.lobes:
            yield lobe.closure


def _nodes(scene: Scene) -> Iterator[Expression]:
    """Every node of every socket, constant parts worked out."""
    sockets = [scene.world.radiance]
    for material in scene.materials:
        for lobe in material.lobes:
            sockets += [lobe.weight, *(v for v in vars(lobe.closure).values() if isinstance(v, Expression))]
    for socket in sockets:
        yield from walk(fold(socket))


def _is_rough(closure: Closure) -> bool:
    socket = fold(closure.roughness)
    return not (is_constant(socket) and float(socket.value) == 0.0)


def _reflects_by(*distributions: str) -> Callable[[Scene], bool]:
    """Whether a rough lobe, of reflection or refraction, has one of these distributions."""
    kinds = (Anisotropic, Glass, Refraction)
    return lambda scene: any(
        isinstance(c, kinds) and c.distribution in distributions and _is_rough(c) for c in _closures(scene)
    )


def _rough_glass(scene: Scene) -> bool:
    """Whether light is sampled through rough glass; that of a constant world is not."""
    sampled = (
        scene.lights
        or not is_constant(fold(scene.world.radiance))
        or any(isinstance(c, Emission) for c in _closures(scene))
    )
    return bool(sampled) and any(isinstance(c, Glass | Refraction) and _is_rough(c) for c in _closures(scene))


def _disperses(glass: Glass) -> bool:
    dispersion = fold(glass.dispersion)
    return not (is_constant(dispersion) and float(dispersion.value) == 0.0)


def _rough_facets(scene: Scene) -> bool:
    return _reflects_by("BECKMANN", "GGX", "MULTI_GGX")(scene)


def _smooth(scene: Scene) -> bool:
    return bool(scene.mesh.corner_normals.shape[2] and scene.mesh.smooth.any())


def _srgb_textures(scene: Scene) -> bool:
    read = {
        n.image
        for n in _nodes(scene)
        if isinstance(n, ImageTexture | EnvironmentTexture) and n.interpolation != "CLOSEST"
    }
    return any(scene.images[k].encoding == "SRGB" for k in read)


def _narrow_spread(scene: Scene) -> bool:
    return any(isinstance(light, AreaLight) and 0.0 < light.spread <= NARROW for light in scene.lights)


DEPARTURES: tuple[Departure, ...] = (
    Departure(
        "separable masking",
        "Masking and shadowing are taken as independent, G1(i) G1(o); the reference, like Cycles, correlates them by the facet's height.",
        "kernel/closure/bsdf_microfacet.h",
        (),
        _rough_facets,
    ),
    Departure(
        "correlated masking",
        "Masking and shadowing are correlated by the facet's height, 1 / (1 + Lambda(i) + Lambda(o)), which is exact for Smith's surfaces; "
        "the reference was asked for another form.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=_rough_facets,
    ),
    Departure(
        "rational Beckmann Lambda",
        "Smith's Lambda of Beckmann's distribution is a rational fit, 0 beyond its bound; 1 + Lambda is up to 0.31 % off the exact one.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=_reflects_by("BECKMANN"),
    ),
    Departure(
        "rational Beckmann density",
        "Visible normals of Beckmann's distribution are sampled exactly, but their density is stated with the rational Lambda: "
        "light found by BSDF sampling is multiplied by (1 + fit) / (1 + exact), light found by light sampling is not.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=_reflects_by("BECKMANN"),
    ),
    Departure(
        "refraction from behind",
        "Light sampling through rough glass counts facets that the viewer or the light sees from behind, through which nothing passes; "
        "BSDF sampling does not.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=_rough_glass,
    ),
    Departure(
        "light below the face",
        "On smooth-shaded faces BSDF sampling rejects directions below the face, light sampling does not: what arrives from "
        "there counts by its share in multiple importance sampling.",
        "kernel/closure/bsdf.h",
        relevant=_smooth,
    ),
    Departure(
        "undispersed reflectance",
        "What dispersive glass reflects at normal incidence is that of its index at Fraunhofer's line d, at every wavelength; by Fresnel's "
        "equations it follows the index.",
        "kernel/closure/bsdf_microfacet.h",
        ("5.3",),
        lambda scene: any(isinstance(c, Glass) and _disperses(c) for c in _closures(scene)),
    ),
    Departure(
        "texture interpolation",
        "8-bit sRGB texels are interpolated as code values and decoded afterwards; light mixes linearly, so the reference decodes "
        "them first.",
        "kernel/svm/image.h",
        relevant=_srgb_textures,
    ),
    Departure(
        "multiple-scattering tables",
        "The albedos behind Multiscatter GGX are read from 32 x 32 nodes, those of glass from 16 x 16 x 16: up to 0.9 % "
        "and 8 % off the integral, most at grazing.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=_reflects_by("MULTI_GGX"),
    ),
    Departure(
        "layer albedo table",
        "What a glossy layer leaves to those beneath it is estimated from 16 x 16 x 16 nodes that leave masking between facets out: "
        "light is taken from below that the layer itself does not give, or the other way round.",
        "kernel/closure/bsdf_microfacet.h",
        relevant=lambda scene: any(isinstance(n, BeneathLayer) for n in _nodes(scene)),
    ),
    Departure(
        "Oren-Nayar colour",
        "Light that a rough diffuse surface scatters k times carries its colour k times; Cycles multiplies all but the first by the "
        "colour once more.",
        "kernel/closure/bsdf_oren_nayar.h",
        relevant=lambda scene: any(isinstance(c, Diffuse) and _is_rough(c) for c in _closures(scene)),
    ),
    Departure(
        "colour-ramp table",
        "A Color Ramp is read from a table of 257 entries: corners are rounded off and steps move by up to 1/256.",
        "kernel/svm/ramp.h",
        relevant=lambda scene: any(isinstance(n, ColorRamp) for n in _nodes(scene)),
    ),
    Departure(
        "narrow spread",
        "An area light whose spread is at most 0.1 radians is normalised by 3 / h^3 in place of 1 / (tan h - h), h half the "
        "spread: up to 0.1 % too bright.",
        "scene/light.cpp",
        relevant=_narrow_spread,
    ),
    Departure(
        "corrected glossy normal",
        "Glossy closures turn the shading normal until the mirror direction rises above the face.",
        "kernel/closure/bsdf_util.h",
        ("5.2",),
        neutralised="material.cycles.use_bump_map_correction",
    ),
    Departure(
        "disk for sphere",
        "Point and spot lights with a radius are disks turned to the shading point.",
        "kernel/light/point.h",
        ("5.0", "5.2"),
        neutralised="light.use_soft_falloff",
    ),
    Departure(
        "shadow terminator offset",
        "Shadow rays from smooth meshes start off the surface.",
        "kernel/light/sample.h",
        ("5.2",),
        neutralised="object.shadow_terminator_geometry_offset",
    ),
    Departure(
        "sample 0",
        "The first sample of each pixel goes through its centre, whatever the seed.",
        "kernel/integrator/init_from_camera.h",
        ("5.0", "5.2"),
        neutralised="cycles.use_sample_subset",
    ),
    Departure(
        "filter table",
        "Pixel filters but the box are read from a table whose last entry is 0: one sample in 1023 per axis is displaced.",
        "scene/film.cpp",
        ("5.2",),
        neutralised="cycles.pixel_filter_type",
    ),
    Departure(
        "float32 accumulation",
        "Samples are added up in single precision: 5e-5 after 4,096, 6e-4 after 65,536.",
        "kernel/film/write.h",
        ("5.0", "5.2"),
        neutralised="cycles.samples, partial sums of at most 4,096 added up in double precision",
    ),
)

SWITCHES = frozenset(d.name for d in DEPARTURES if not d.neutralised)
"""The names that Options.departures takes."""
