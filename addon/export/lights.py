# SPDX-License-Identifier: GPL-3.0-or-later
"""Light objects in radiometric units.

Blender's watts, sizes and switches are converted by Cycles' rules.
"""

from __future__ import annotations

import math
from dataclasses import replace

import bpy
import numpy as np

from ...lib.errors import Refusal
from ...lib.scene.lights import (
    USUAL_FALLOFF,
    AreaLight,
    Cone,
    Falloff,
    Light,
    PointLight,
    SphereLight,
    SpotLight,
    SunLight,
    Vector,
)
from ...lib.scene.links import Links
from ...lib.scene.matrices import is_sheared
from ...lib.scene.rays import SEEN
from ...lib.textures.fold import fold, is_constant
from .nodes.images import ImageTable
from .nodes.tree import Scope, Source, TreeReader
from .nodes.values import VALUES
from .refusals import is_portal, refuse_light

_POWERS = {"Quadratic": 0, "Linear": 1, "Constant": 2}
"""What is left of the square of the distance, by output of a Light Falloff node."""


def read_light(
    light: bpy.types.Object, matrix: np.ndarray, rays: int, links: Links, refusals: list[Refusal]
) -> Light | None:
    """Read the light object `light`; None where it gives no light or is refused.

    `matrix` is (3, 4), `rays` the mask of the rays that see the light, and `links` its light linking.
    """
    data = light.data
    if is_portal(data):
        return None
    owner = f"light '{light.name}'"
    before = len(refusals)
    refuse_light(light, refusals)
    emission, falloff = _emission(data, owner, refusals)
    if data.type in ("SPOT", "AREA"):
        if np.linalg.matrix_rank(matrix[:, :3]) == 3:
            if is_sheared(matrix):
                refusals.append(Refusal(owner, "a sheared matrix", "apply the scale of its parents"))
        elif data.type == "SPOT" or not matrix[:, 2].any():
            refusals.append(Refusal(owner, "a scale of 0 along an axis", "give it a scale above 0"))
    if data.type == "AREA" and data.spread <= 0.0:
        refusals.append(Refusal(owner, "a spread of 0", "widen the spread, or use a sun"))
    if len(refusals) > before or not emission.any():
        return None
    read = _READERS[data.type](light.name, data, matrix, emission)
    if read is None:
        return None
    switches = {"casts_shadow": data.use_shadow, "max_bounces": data.cycles.max_bounces, "falloff": falloff}
    return replace(read, rays=rays & SEEN, links=links, **switches)


def _emission(data: bpy.types.Light, owner: str, refusals: list[Refusal]) -> tuple[np.ndarray, Falloff]:
    """(3,) energy * colour * 2^exposure, times temperature and nodes, and how it falls off.

    These are the colour of the temperature and the emission of a plain Emission node.
    """
    falloff = USUAL_FALLOFF
    emission = np.array(data.color, dtype=np.float64) * data.energy
    # Exposure, normalise and temperature came to all lights in Blender 4.5; before, there is nothing to read.
    emission *= 2.0 ** getattr(data, "exposure", 0.0)
    if getattr(data, "use_temperature", False):
        emission *= np.array(data.temperature_color, dtype=np.float64)
    if data.node_tree is not None and (bpy.app.version >= (5, 0, 0) or data.use_nodes):
        of_nodes, falloff = _node_emission(data.node_tree, owner, refusals, data.type == "SUN")
        emission *= of_nodes
    if np.any(emission < 0.0):
        refusals.append(Refusal(owner, "negative power", "make the power positive"))
    return emission, falloff


def _node_emission(
    tree: bpy.types.NodeTree, owner: str, refusals: list[Refusal], is_sun: bool
) -> tuple[np.ndarray, Falloff]:
    """(3,) colour * strength of the one Emission node that a light's tree may end in, and how it falls off.

    The inputs of that node must be the same everywhere, but for a Light Falloff node as its strength.
    """
    black = np.zeros(3), USUAL_FALLOFF
    output = tree.get_output_node("CYCLES")
    if output is None:
        return black
    reader = TreeReader(owner, False, ImageTable(), refusals, VALUES)
    reader.check(output, Scope())
    source = reader.trace(output.inputs["Surface"], Scope())
    emission = source.socket.node
    if not source.linked:
        return black
    if emission.bl_idname != "ShaderNodeEmission":
        reader.refuse(emission, source.scope, "", "use one plain Emission node")
        return black
    reader.check(emission, source.scope)
    strength = reader.trace(emission.inputs["Strength"], source.scope)
    node = strength.socket.node
    falloff = USUAL_FALLOFF
    if strength.linked and node.bl_idname == "ShaderNodeLightFalloff" and set(strength.passed) <= {"VALUE"}:
        reader.check(node, strength.scope)
        falloff = _falloff(reader, strength)
        if is_sun and falloff != USUAL_FALLOFF:
            what = f", output '{strength.socket.name}', with its smoothness,"
            reader.refuse(node, strength.scope, what, "use Quadratic, and a Smooth of 0")
        strength = reader.trace(node.inputs["Strength"], strength.scope)
    product = np.ones(3)
    for name, origin, kind in (
        ("Color", reader.trace(emission.inputs["Color"], source.scope), "RGBA"),
        ("Strength", strength, "VALUE"),
    ):
        content = fold(reader.content(origin, kind))
        if not is_constant(content):
            reader.refuse(
                emission, source.scope, f", socket '{name}', which is not the same everywhere,", f"unlink {name}"
            )
            return black
        product *= np.array(content.value, dtype=np.float64)
    return product, falloff


def _falloff(reader: TreeReader, source: Source) -> Falloff:
    """How a Light Falloff node has light fall off by the output that is the `source`."""
    node = source.socket.node
    smooth = fold(reader.read(node.inputs["Smooth"], source.scope))
    if not is_constant(smooth):
        reader.refuse(node, source.scope, ", socket 'Smooth', which is not the same everywhere,", "unlink Smooth")
        return USUAL_FALLOFF
    return Falloff(_POWERS[source.socket.name], max(smooth.number, 0.0))


def _point(name: str, data: bpy.types.PointLight, matrix: np.ndarray, emission: np.ndarray) -> Light:
    radius = data.shadow_soft_size
    position = _vector(matrix[:, 3])
    if radius == 0.0:
        return PointLight(name, position, _vector(_ball_emission(data, emission)))
    return SphereLight(name, position, radius, _vector(_ball_emission(data, emission)))


def _spot(name: str, data: bpy.types.SpotLight, matrix: np.ndarray, emission: np.ndarray) -> Light:
    inverse = np.linalg.inv(matrix[:, :3])
    inverse /= np.linalg.norm(inverse[2])
    x_axis, y_axis, z_axis = (_vector(row) for row in inverse * [[1.0], [1.0], [-1.0]])
    cone = Cone(z_axis, x_axis, y_axis, math.cos(data.spot_size / 2.0), data.spot_blend)
    emitted = _vector(_ball_emission(data, emission))
    return SpotLight(name, _vector(matrix[:, 3]), data.shadow_soft_size, emitted, cone)


def _ball_emission(data: bpy.types.Light, emission: np.ndarray) -> np.ndarray:
    """Radiance of a sphere light, or intensity of a point light.

    It is the flux of an isotropic emitter over 4 pi^2 r^2 for a sphere, over 4 pi for a point.
    """
    if not getattr(data, "normalize", True):
        return emission / math.pi
    radius = data.shadow_soft_size
    return emission / (4.0 * math.pi * (math.pi * radius**2 if radius > 0.0 else 1.0))


def _sun(name: str, data: bpy.types.SunLight, matrix: np.ndarray, emission: np.ndarray) -> Light | None:
    length = np.linalg.norm(matrix[:, 2])
    if length == 0.0:
        return None
    half_angle = min(data.angle / 2.0, math.pi / 2.0)  # of float32 pi, Blender's largest, the half is above pi / 2
    if half_angle > 0.0 and not getattr(data, "normalize", True):
        emission = emission * (math.pi * math.sin(half_angle) ** 2)
    return SunLight(name, _vector(matrix[:, 2] / length), half_angle, _vector(emission))


def _area(name: str, data: bpy.types.AreaLight, matrix: np.ndarray, emission: np.ndarray) -> Light | None:
    size_v = data.size_y if data.shape in ("RECTANGLE", "ELLIPSE") else data.size
    edge_u, edge_v = matrix[:, 0] * data.size, matrix[:, 1] * size_v
    ellipse = data.shape in ("DISK", "ELLIPSE")
    area = float(np.linalg.norm(edge_u) * np.linalg.norm(edge_v)) * (math.pi / 4.0 if ellipse else 1.0)
    if area == 0.0:
        return None
    radiance = emission / (math.pi * (area if getattr(data, "normalize", True) else 1.0))
    return AreaLight(
        name=name,
        center=_vector(matrix[:, 3]),
        edge_u=_vector(edge_u),
        edge_v=_vector(edge_v),
        normal=_vector(-matrix[:, 2] / np.linalg.norm(matrix[:, 2])),
        shape="ELLIPSE" if ellipse else "RECTANGLE",
        radiance=_vector(radiance),
        spread=data.spread,
    )


def _vector(values: np.ndarray) -> Vector:
    x, y, z = values.tolist()
    return x, y, z


_READERS = {"POINT": _point, "SPOT": _spot, "SUN": _sun, "AREA": _area}
