# SPDX-License-Identifier: GPL-3.0-or-later
"""The probes as scenes of the reference, made without Blender, and what it shows of them."""

from dataclasses import replace

import numpy as np
from etalon.lib.blender_versions import Versions
from etalon.lib.departures.catalogue import relevant
from etalon.lib.scene import materials as mt
from etalon.lib.scene.converters import VectorMath
from etalon.lib.scene.expressions import (
    BLACK,
    ONE,
    WHITE,
    ZERO,
    Constant,
    Coordinates,
    Gamma,
    Math,
    Mix,
    NormalMap,
    ValueToColor,
)
from etalon.lib.scene.layers import BeneathLayer, BeneathSheen, CoatTint
from etalon.lib.scene.lights import SunLight
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.probes.definitions import FURNACES, IRRADIANCE, SUNS, tilts
from etalon.tests.scenes import orthographic, quad, scene

UV = mt.Tangent("UV", uv_map="UVMap")


def _single(value):
    return float(np.float32(value))


class Sockets:
    """The sockets of a probe as expressions."""

    def __init__(self, probe):
        self._probe = probe

    def __call__(self, name, default):
        """The socket `name`, or what Blender's default for it is; sockets are float32."""
        value = self._probe.inputs.get(name, default)
        return Constant(tuple(_single(v) for v in value[:3]) if isinstance(value, tuple) else _single(value))

    @property
    def normal(self):
        if self._probe.normal is None:
            return None
        color, strength = self._probe.normal
        return NormalMap(Constant(tuple(_single(v) for v in color[:3])), Constant(_single(strength)))

    @property
    def film(self):
        """Thickness and index of the film, where there is one."""
        thickness = self("Thin Film Thickness", 0.0)
        return {} if thickness == ZERO else {"film_thickness": thickness, "film_ior": self("Thin Film IOR", 1.33)}

    def stretch(self, anisotropy="Anisotropy", rotation="Rotation"):
        """What an anisotropic lobe has besides its roughness."""
        if not self._probe.is_stretched:
            return {"normal": self.normal}
        return {
            "anisotropy": self(anisotropy, 0.0),
            "rotation": self(rotation, 0.0),
            "tangent": UV,
            "normal": self.normal,
        }


GREY = (0.8, 0.8, 0.8)
ONES = (1.0, 1.0, 1.0)
DISPERSION = (("Scale", 0.0), ("Abbe Number", 20.0))


def _diffuse(probe, read):
    return mt.Diffuse(read("Color", GREY), read("Roughness", 0.0), read.normal)


def _glossy(probe, read):
    return mt.Glossy(probe.distribution, read("Color", GREY), read("Roughness", 0.5), **read.stretch())


def _metallic(probe, read):
    f82 = probe.fresnel == "F82"
    base, edge = (
        (read("Base Color", GREY), read("Edge Tint", ONES)) if f82 else (read("IOR", 1.5), read("Extinction", 1.5))
    )
    kind = "F82" if f82 else "CONDUCTOR"
    return mt.Metallic(probe.distribution, kind, base, edge, read("Roughness", 0.5), **read.stretch(), **read.film)


def _glass(probe, read):
    color, ior, roughness = read("Color", ONES), read("IOR", 1.5), read("Roughness", 0.0)
    if probe.distribution != "MULTI_GGX":
        return mt.Glass(color, ior, roughness, probe.distribution, **read.stretch(), **read.film)
    return mt.Glass(WHITE, ior, roughness, "MULTI_GGX", color, color, **read.stretch())


def _refraction(probe, read):
    return mt.Refraction(
        read("Color", ONES), read("IOR", 1.45), read("Roughness", 0.0), probe.distribution, read.normal
    )


def _sheen(probe, read):
    kind = mt.Velvet if probe.distribution == "ASHIKHMIN" else mt.Sheen
    return kind(read("Color", GREY), read("Roughness", 0.5), read.normal)


def _toon(probe, read):
    kind = mt.GlossyToon if probe.distribution == "GLOSSY" else mt.Toon
    return kind(read("Color", GREY), read("Size", 0.5), read("Smooth", 0.0), read.normal)


def _times(weight, factor):
    """The product of two weights, either of which may be a colour."""
    if weight == ONE:
        return factor
    if isinstance(weight, Mix):
        return Mix(ONE, weight, ValueToColor(factor), blend="MULTIPLY")
    return Math("MULTIPLY", weight, factor, ZERO)


def _beneath_coat(probe, read, release):
    """What a coat of weight w, albedo A and tint T leaves.

    1 - w + w (1 - A) T from Blender 5.3 on, before (1 - w A) (1 - w + w T).
    """
    ior, roughness, weight = read("Coat IOR", 1.5), read("Coat Roughness", 0.03), read("Coat Weight", 0.0)
    covers = release in Versions("5.3")
    tinted = "Coat Tint" in probe.inputs
    share = ONE if covers and tinted else weight
    below = BeneathLayer(ior, WHITE, roughness, share, "MULTI_GGX", coat=True)
    if not tinted:
        return below
    colored = Mix(ONE, CoatTint(ior, read("Coat Tint", ONES), share), ValueToColor(below), blend="MULTIPLY")
    return Mix(weight, WHITE, colored) if covers else colored


def _sheen_normal(normal, coat):
    """The node's normal, turned towards the shading normal.

    That is the coat's, and the coat's weight turns it.
    """
    if normal is None or coat == ZERO:
        return normal
    return VectorMath("NORMALIZE", Mix(coat, normal, Coordinates("SHADING_NORMAL")), BLACK, BLACK, ONE)


def _principled(probe, read, release):
    """The layers that the probes use.

    They are a coat over metal, glass, or a dielectric with its diffuse base.
    """
    base, tint, roughness = read("Base Color", GREY), read("Specular Tint", ONES), read("Roughness", 0.5)
    lobes, weight, coat = [], ONE, read("Coat Weight", 0.0)
    if (sheen := read("Sheen Weight", 0.0)) != ZERO:
        how = read("Sheen Tint", ONES), read("Sheen Roughness", 0.5), _sheen_normal(read.normal, coat)
        lobes.append(mt.WeightedClosure(mt.Sheen(*how), sheen))
        weight = BeneathSheen(how[0], how[1], sheen, how[2])
    if coat != ZERO:
        closure = mt.Specular("MULTI_GGX", read("Coat IOR", 1.5), WHITE, read("Coat Roughness", 0.03))
        lobes.append(mt.WeightedClosure(closure, _times(weight, coat)))
        weight = _times(weight, _beneath_coat(probe, read, release))
    if read("Metallic", 0.0) == ONE:
        how = read.stretch("Anisotropic", "Anisotropic Rotation")
        lobes.append(
            mt.WeightedClosure(
                mt.Metallic(probe.distribution, "F82", base, tint, roughness, **how, **read.film), weight
            )
        )
    elif read("Transmission Weight", 0.0) == ONE:
        how = read.stretch("Anisotropic", "Anisotropic Rotation")
        if probe.is_stretched:  # as the Glass BSDF states what divides alpha along x by the root
            how["anisotropy"] = Constant(float(np.sqrt(1.0 - 0.9 * how["anisotropy"].value)) - 1.0)
        scale, abbe = (read(f"Transmission Dispersion {name}", value).value for name, value in DISPERSION)
        how |= {"transmission": Gamma(base, Constant(0.5)), "tint": tint, "dispersion": Constant(scale / abbe)}
        glass = mt.Glass(WHITE, read("IOR", 1.5), roughness, probe.distribution, **how, **read.film)
        lobes.append(mt.WeightedClosure(glass, weight))
    else:
        ior, level = read("IOR", 1.5).value, read("Specular IOR Level", 0.5).value
        if level:
            root = (ior - 1.0) / (ior + 1.0) * (2.0 * level) ** 0.5
            ior = Constant((1.0 + root) / (1.0 - root))
            lobes.append(mt.WeightedClosure(mt.Specular(probe.distribution, ior, tint, roughness, **read.film), weight))
            weight = _times(weight, BeneathLayer(ior, tint, roughness, ONE, probe.distribution, **read.film))
        lobes.append(mt.WeightedClosure(mt.Diffuse(base, read("Diffuse Roughness", 0.0)), weight))
    return lobes


_CLOSURES = {
    "BsdfDiffuse": _diffuse,
    "BsdfTranslucent": lambda probe, read: mt.Translucent(read("Color", GREY), read.normal),
    "BsdfGlossy": _glossy,
    "BsdfMetallic": _metallic,
    "BsdfGlass": _glass,
    "BsdfRefraction": _refraction,
    "BsdfSheen": _sheen,
    "BsdfToon": _toon,
}


def material(probe, release):
    """The probe's material, as the exporter should write it in a release of Blender."""
    read = Sockets(probe)
    if probe.node == "BsdfPrincipled":
        return mt.Material(probe.name, tuple(_principled(probe, read, release)))
    return mt.Material(probe.name, (mt.WeightedClosure(_CLOSURES[probe.node](probe, read)),))


def strips(materials, tilt, light):
    """A scene of one strip of each material on a plane that leans by `tilt` about x.

    Each strip is a pixel, the first on the lowest row. The strips lie in one plane, so that none hides or lights
    another.
    """
    count = len(materials)
    y = np.arange(count)
    parts = [quad((-0.5, k, k * np.tan(tilt)), (1.0, 0.0, 0.0), (0.0, 1.0, np.tan(tilt)), int(k)) for k in y]
    lights, world = (), 1.0
    if light not in FURNACES:
        sun = np.array(SUNS[light]) / np.linalg.norm(SUNS[light])
        lights, world = (SunLight("sun", tuple(sun), 0.0, (IRRADIANCE,) * 3),), 0.0
    height = count * abs(np.tan(tilt)) + 5.0
    camera = orthographic(1, count, 1.0, (0.0, 0.5 * count, height))
    made = scene(parts, materials, camera, lights, world)
    # u runs along x, v along the slope; every quad is the triangles (0, 1, 2) and (0, 2, 3).
    corners = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)  # triangle, corner, uv
    uv = np.tile(corners.transpose(1, 2, 0), (1, 1, count))
    return replace(made, mesh=replace(made.mesh, uvs={"UVMap": uv, "": uv}))


def departures_of(made, release):
    """Names of the departures that Cycles of `release` has in the scene `made`."""
    return frozenset(departure.name for departure in relevant(replace(made, blender=release)))


def shown(light, materials, release=None, samples=1):
    """What the reference shows of `materials` under a light, (materials, tilts, 3).

    With a `release` it has the departures of that release of Blender, else none.
    """
    columns = []
    for tilt in tilts(light):
        made = replace(strips(materials, tilt, light), blender=release)
        departures = frozenset() if release is None else departures_of(made, release)
        renderer = ReferenceRenderer(made, Options(threads=1, departures=departures))
        columns.append(renderer.render(0, samples).radiance[::-1, 0])
    return np.stack(columns, axis=1)
