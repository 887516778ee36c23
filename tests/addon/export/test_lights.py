# SPDX-License-Identifier: GPL-3.0-or-later
"""Exported lights against the irradiance that Cycles measures.

It is measured on a white Lambertian square below them.
"""

import math

import bpy
import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.scene.lights import AreaLight, Falloff, PointLight, SphereLight, SpotLight, SunLight
from etalon.lib.scene.rays import GLOSSY, SCATTERED, SEEN
from mathutils import Euler, Matrix

COLOR = (0.9, 0.5, 0.25)
GRID = 600


def above(studio, kind, matrix=None, **properties):
    """A light 3 m above the square, facing down."""
    data = bpy.data.lights.new("lamp", kind)
    data.energy, data.color = 40.0, COLOR
    if hasattr(data, "use_soft_falloff"):
        data.use_soft_falloff = False
    for name, value in properties.items():
        setattr(data, name, value)
    return studio.add("lamp", data, Matrix.Translation((0.0, 0.0, 3.0)) if matrix is None else matrix)


def measured(studio, samples):
    """(3,) irradiance at the origin, by Cycles."""
    studio.look_down(0.001)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 16
    studio.scene.cycles.max_bounces = 0
    material = bpy.data.materials.new("white")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    diffuse, out = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(diffuse.outputs[0], out.inputs["Surface"])
    bpy.data.objects["quad"].data.materials[0] = material
    return math.pi * studio.cycles(samples).mean(axis=(0, 1))


def area_irradiance(light):
    """(3,) at the origin, normal +z, by midpoint quadrature over the light."""
    u, v = np.meshgrid(*2 * [(np.arange(GRID) + 0.5) / GRID - 0.5])
    inside = (u**2 + v**2 <= 0.25) if light.shape == "ELLIPSE" else np.ones_like(u, bool)
    edges = np.array([light.edge_u, light.edge_v])
    to = np.array(light.center)[:, None, None] + np.einsum("ei,ehw->ihw", edges, np.stack([u, v]))
    distance = np.linalg.norm(to, axis=0)
    cos_light = -np.einsum("ihw,i->hw", to, light.normal) / distance
    with np.errstate(divide="ignore"):
        tangent = np.sqrt(np.maximum(0.0, 1.0 - cos_light**2)) / np.maximum(cos_light, 1e-9)
    fall = 1.0
    if light.spread < math.pi - 1e-6:
        half = math.tan(light.spread / 2)
        fall = np.maximum(half - tangent, 0.0) / (half - light.spread / 2)
    integrand = inside * np.maximum(cos_light, 0.0) * fall * to[2] / distance**3
    cell = np.linalg.norm(np.cross(*edges)) / GRID**2
    return np.array(light.radiance) * integrand.sum() * cell


def spot_irradiance(light):
    """(3,) at the origin from a spot without a radius."""
    cone = light.cone
    to = -np.array(light.position)
    local = np.array([cone.x_axis, cone.y_axis, cone.axis]) @ (to / np.linalg.norm(to))
    t = (local[2] / np.linalg.norm(local) - cone.cos_half_angle) / ((1 - cone.cos_half_angle) * cone.blend)
    t = min(max(t, 0.0), 1.0)
    return np.array(light.emission) * (t * t * (3 - 2 * t)) * light.position[2] / np.linalg.norm(to) ** 3


def irradiance(light):
    """(3,) at the origin, normal +z, in closed form or by quadrature."""
    if isinstance(light, PointLight):
        return np.array(light.intensity) * light.position[2] / np.linalg.norm(light.position) ** 3
    if isinstance(light, SphereLight):
        return (
            math.pi
            * np.array(light.radiance)
            * light.radius**2
            * light.position[2]
            / np.linalg.norm(light.position) ** 3
        )
    if isinstance(light, SunLight):
        return np.array(light.irradiance) * light.direction[2]
    return spot_irradiance(light) if isinstance(light, SpotLight) else area_irradiance(light)


ASIDE = Matrix.Translation((0.7, -0.4, 3.0))
TURNED = ASIDE @ Euler((0.2, 0.1, 0.6)).to_matrix().to_4x4()
TILTED = ASIDE @ Euler((0.35, 0.1, 0.6)).to_matrix().to_4x4() @ Matrix.Diagonal((1.7, 0.6, 1.2, 1.0))
STRETCHED = TURNED @ Matrix.Diagonal((1.7, 0.6, 1.2, 1.0))
CASES = {
    "point": ("POINT", ASIDE, {"shadow_soft_size": 0.0}),
    "sphere": ("POINT", STRETCHED, {"shadow_soft_size": 0.5}),
    "spot": ("SPOT", TILTED, {"shadow_soft_size": 0.0, "spot_size": 0.9, "spot_blend": 1.0}),
    "sun": ("SUN", TURNED, {"angle": 0.0}),
    "wide sun": ("SUN", TURNED, {"angle": 0.6}),
    "sun of 180 degrees": ("SUN", ASIDE, {"angle": math.pi}),
    "square": ("AREA", TURNED, {"shape": "SQUARE", "size": 0.8}),
    "rectangle": ("AREA", STRETCHED, {"shape": "RECTANGLE", "size": 0.8, "size_y": 1.4}),
    "disk": ("AREA", TURNED, {"shape": "DISK", "size": 1.1}),
    "ellipse": ("AREA", STRETCHED, {"shape": "ELLIPSE", "size": 0.8, "size_y": 1.4}),
    "spread": ("AREA", TURNED, {"shape": "SQUARE", "size": 1.2, "spread": 1.1}),
    "mirrored": ("AREA", TURNED @ Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0)), {"shape": "SQUARE", "size": 0.8}),
}
NEW = {
    "exposure": ("POINT", ASIDE, {"shadow_soft_size": 0.0, "exposure": 1.5}),
    "temperature": ("POINT", ASIDE, {"shadow_soft_size": 0.0, "use_temperature": True, "temperature": 3200.0}),
    "point not normalised": ("POINT", ASIDE, {"shadow_soft_size": 0.0, "normalize": False}),
    "sphere not normalised": ("POINT", ASIDE, {"shadow_soft_size": 0.5, "normalize": False}),
    "sun not normalised": ("SUN", TURNED, {"angle": 0.6, "normalize": False}),
    "ellipse not normalised": ("AREA", STRETCHED, {"shape": "ELLIPSE", "size": 0.8, "size_y": 1.4, "normalize": False}),
}


def compare(studio, case):
    kind, matrix, properties = case
    studio.quad()
    above(studio, kind, matrix, **properties)
    (light,) = studio.export().lights
    noiseless = properties.get("shadow_soft_size") == 0.0 or properties.get("angle") == 0.0
    # 256 pixels times the samples: their noise was measured to be under a tenth of the tolerance.
    cycles = measured(studio, 1 if noiseless else 128)
    assert np.all(cycles > 0.0)
    assert irradiance(light) == pytest.approx(cycles, rel=2e-5 if noiseless else 3e-3)


@pytest.mark.parametrize("name", CASES)
def test_watts_become_the_irradiance_that_cycles_measures(studio, name):
    compare(studio, CASES[name])


@pytest.mark.skipif(bpy.app.version < (4, 5, 0), reason="lights have these properties from Blender 4.5 on")
@pytest.mark.parametrize("name", NEW)
def test_exposure_temperature_and_normalise(studio, name):
    compare(studio, NEW[name])


def test_an_emission_node_multiplies(studio):
    studio.quad()
    lamp = above(studio, "POINT", shadow_soft_size=0.0)
    if lamp.data.node_tree is None:
        lamp.data.use_nodes = True
    (emission,) = (n for n in lamp.data.node_tree.nodes if n.bl_idname == "ShaderNodeEmission")
    emission.inputs["Color"].default_value = (0.5, 1.0, 0.25, 1.0)
    emission.inputs["Strength"].default_value = 3.0
    (light,) = studio.export().lights
    assert irradiance(light) == pytest.approx(measured(studio, 1), rel=2e-5)


@pytest.mark.parametrize("kind", ["POINT", "AREA"])
def test_what_feeds_an_emission_node_may_be_any_constant(studio, kind):
    """The constant is a blackbody, arithmetic in a group, or a falloff.

    The falloff leaves the square of the distance alone.
    """
    studio.quad()
    lamp = above(studio, kind, **({"shadow_soft_size": 0.0} if kind == "POINT" else {"size": 0.01}))
    if lamp.data.node_tree is None:
        lamp.data.use_nodes = True
    tree = lamp.data.node_tree
    (emission,) = (n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
    black, falloff, unused = (tree.nodes.new(f"ShaderNode{n}") for n in ("Blackbody", "LightFalloff", "TexNoise"))
    black.inputs["Temperature"].default_value = 3200.0
    tree.links.new(black.outputs[0], emission.inputs["Color"])
    group = bpy.data.node_groups.new("double", "ShaderNodeTree")
    group.interface.new_socket("Value", in_out="INPUT", socket_type="NodeSocketFloat")
    group.interface.new_socket("Value", in_out="OUTPUT", socket_type="NodeSocketFloat")
    begin, end, math_node = (group.nodes.new(n) for n in ("NodeGroupInput", "NodeGroupOutput", "ShaderNodeMath"))
    math_node.operation, math_node.inputs[1].default_value = "MULTIPLY", 2.0
    group.links.new(begin.outputs[0], math_node.inputs[0])
    group.links.new(math_node.outputs[0], end.inputs[0])
    double = tree.nodes.new("ShaderNodeGroup")
    double.node_tree = group
    double.inputs[0].default_value = 1.5
    tree.links.new(double.outputs[0], falloff.inputs["Strength"])
    tree.links.new(falloff.outputs["Quadratic"], emission.inputs["Strength"])
    (light,) = studio.export().lights
    value = irradiance(light) if kind == "POINT" else np.array(light.radiance) * np.pi * 0.01**2 / np.pi / 9.0
    assert value == pytest.approx(measured(studio, 1 if kind == "POINT" else 256), rel=1e-3)
    for output, to, told in ((unused.outputs[0], "Strength", "socket 'Strength', which is not the same everywhere"),):
        tree.links.new(output, emission.inputs[to])
        with pytest.raises(Refused, match=told):
            studio.export()


def behind_falloff(lamp, output, smooth):
    """Put a Light Falloff node before the lamp's emission."""
    if lamp.data.node_tree is None:
        lamp.data.use_nodes = True
    tree = lamp.data.node_tree
    (emission,) = (n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value, falloff.inputs["Smooth"].default_value = 1.5, smooth
    tree.links.new(falloff.outputs[output], emission.inputs["Strength"])
    return falloff


@pytest.mark.parametrize(("output", "power"), [("Quadratic", 0), ("Linear", 1), ("Constant", 2)])
@pytest.mark.parametrize("smooth", [0.0, 4.0])
@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA"])
def test_a_small_light_behind_a_light_falloff_node(studio, kind, output, power, smooth):
    """From 3 m away the strength is multiplied by 3^power and 9 / (smooth + 9)."""
    studio.quad()
    lamp = above(studio, kind, **({"size": 0.01} if kind == "AREA" else {"shadow_soft_size": 0.0}))
    (usual,) = studio.export().lights
    behind_falloff(lamp, output, smooth)
    (light,) = studio.export().lights
    assert light.falloff == Falloff(power, smooth)
    factor = 1.5 * 3.0**power * 9.0 / (9.0 + smooth)
    assert irradiance(usual) * factor == pytest.approx(measured(studio, 256 if kind == "AREA" else 1), rel=1e-3)


def test_a_sun_behind_a_light_falloff_node_is_refused(studio):
    behind_falloff(above(studio, "SUN"), "Linear", 0.0)
    with pytest.raises(Refused, match=r"light 'lamp': node 'Light Falloff' .* output 'Linear', with its smoothness"):
        studio.export()


def test_a_smoothness_that_varies_is_refused(studio):
    falloff = behind_falloff(above(studio, "POINT"), "Linear", 0.0)
    tree = falloff.id_data
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[0], falloff.inputs["Smooth"])
    with pytest.raises(Refused, match="socket 'Smooth', which is not the same everywhere"):
        studio.export()


def test_an_instanced_light_shines_from_its_instance(studio):
    studio.quad()
    lamp = above(studio, "POINT", shadow_soft_size=0.0)
    inner = bpy.data.collections.new("inner")
    inner.objects.link(lamp)
    studio.scene.collection.objects.unlink(lamp)
    empty = studio.add("empty", None, Matrix.Translation((1.0, 2.0, 0.5)))
    empty.instance_type, empty.instance_collection = "COLLECTION", inner
    (light,) = studio.export().lights
    assert light.position == pytest.approx((1.0, 2.0, 3.5))


def test_lights_that_give_no_light_are_left_out(studio):
    studio.quad()
    above(studio, "POINT", energy=0.0)
    above(studio, "AREA", shape="RECTANGLE", size=0.0, size_y=1.0)
    above(studio, "SUN", color=(0.0, 0.0, 0.0))
    hidden = above(studio, "POINT")
    hidden.hide_render = True
    assert studio.export().lights == ()


def test_visibility_to_rays(studio):
    studio.quad()
    lamp = above(studio, "AREA", size=0.5)
    lamp.visible_camera = False
    assert studio.export().lights[0].rays == SCATTERED
    lamp.visible_camera, lamp.visible_glossy = True, False
    assert studio.export().lights[0].rays == SEEN & ~GLOSSY
    assert isinstance(studio.export().lights[0], AreaLight)


REFUSED = {
    "shadow caustics": lambda lamp: setattr(lamp.data.cycles, "is_caustics_light", True),
    "a spread of 0": lambda lamp: setattr(lamp.data, "spread", 0.0),
    "negative power": lambda lamp: setattr(lamp.data, "energy", -1.0),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_not_simulated_is_refused_by_name(studio, what):
    studio.quad()
    REFUSED[what](above(studio, "AREA", size=0.5))
    with pytest.raises(Refused, match=f"light 'lamp': {what} is not simulated; "):
        studio.export()


@pytest.mark.parametrize(("kind", "scale"), [("SPOT", (0, 1, 1)), ("SPOT", (0, 0, 0)), ("AREA", (1, 1, 0))])
def test_a_light_without_an_axis_is_refused(studio, kind, scale):
    studio.quad()
    above(studio, kind, matrix=Matrix.Diagonal((*scale, 1.0)))
    with pytest.raises(Refused, match="light 'lamp': a scale of 0 along an axis"):
        studio.export()


def test_a_sheared_light_is_refused(studio):
    studio.quad()
    lamp = above(studio, "AREA", TURNED, size=0.5)
    lamp.parent = studio.add("parent", None, Matrix.Diagonal((1.0, 3.0, 1.0, 1.0)))
    with pytest.raises(Refused, match="light 'lamp': a sheared matrix"):
        studio.export()
