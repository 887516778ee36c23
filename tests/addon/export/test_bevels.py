# SPDX-License-Identifier: GPL-3.0-or-later
"""Bevel nodes: what is read, and the image beside Cycles'."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.materials import WeightedClosure
from etalon.lib.textures.fold import inputs, walk
from etalon.tests.addon.export.test_visibility import FEW_SAMPLES, SAMPLES, apart, below_a_sky, shader, square
from mathutils import Euler, Matrix


def box(studio, turn=(0.3, 0.2, 0.5), scale=(1.3, 0.9, 1.1), kind="BsdfDiffuse", samples=4, radius=0.5, **values):
    """A bevelled box above a floor, below a sun and a sky. Returns its tree, its Bevel node and its shader."""
    floor = shader("grey", "BsdfDiffuse", Color=(0.5, 0.5, 0.5, 1))
    square(studio, "floor", floor, 5.0, Matrix.Translation((0, 0, -1.6)))
    material = shader("box", kind, **values)
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    thing = bpy.context.object
    thing.name = "box"
    thing.data.materials.append(material)
    for vertex in thing.data.vertices:  # no right angles: there Cycles' rounding decides whether light counts
        if vertex.co.z > 0.0:
            vertex.co.x, vertex.co.y = 0.75 * vertex.co.x, 0.75 * vertex.co.y
    thing.matrix_world = Matrix.LocRotScale((0.0, 0.0, 0.2), Euler(turn), scale)
    tree = material.node_tree
    bevel = tree.nodes.new("ShaderNodeBevel")
    bevel.samples, bevel.inputs["Radius"].default_value = samples, radius
    (surface,) = (one for one in tree.nodes if "Normal" in one.inputs and one.outputs[0].type == "SHADER")
    tree.links.new(bevel.outputs[0], surface.inputs["Normal"])
    sun = studio.add("sun", bpy.data.lights.new("sun", "SUN"), Euler((0.8, 0.3, 0.2)).to_matrix().to_4x4())
    sun.data.energy = 3.0
    below_a_sky(studio, bounces=2)
    return tree, bevel, surface


def with_(**options):
    return lambda studio: box(studio, **options)


def over_a_map(studio):
    tree, bevel, _ = box(studio)
    mapped = tree.nodes.new("ShaderNodeNormalMap")
    mapped.space, mapped.inputs["Color"].default_value = "OBJECT", (0.7, 0.6, 0.9, 1.0)
    mapped.inputs["Strength"].default_value = 0.4
    tree.links.new(mapped.outputs[0], bevel.inputs["Normal"])


def below_a_bump(studio):
    tree, bevel, surface = box(studio)
    bump, waves, place = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Bump", "TexWave", "TexCoord"))
    bump.inputs["Distance"].default_value, waves.inputs["Scale"].default_value = 0.1, 0.5
    tree.links.new(place.outputs["Object"], waves.inputs["Vector"])
    tree.links.new(waves.outputs["Fac"], bump.inputs["Height"])
    tree.links.new(bevel.outputs[0], bump.inputs["Normal"])
    tree.links.new(bump.outputs[0], surface.inputs["Normal"])


def worn_edges(studio):
    """A mix of two shaders by how far the bevelled normal is from the face's; and neither is bevelled."""
    tree, bevel, surface = box(studio, Color=(0.1, 0.2, 0.6, 1))
    geometry, dot, mix, bare = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("NewGeometry", "VectorMath", "MixShader", "BsdfDiffuse")
    )
    dot.operation, bare.inputs["Color"].default_value = "DOT_PRODUCT", (0.9, 0.6, 0.3, 1.0)
    tree.links.remove(surface.inputs["Normal"].links[0])
    tree.links.new(bevel.outputs[0], dot.inputs[0])
    tree.links.new(geometry.outputs["Normal"], dot.inputs[1])
    tree.links.new(dot.outputs["Value"], mix.inputs[0])
    tree.links.new(bare.outputs[0], mix.inputs[1])
    tree.links.new(surface.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def textured(studio):
    tree, bevel, _ = box(studio)
    checker, times = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeMath")
    checker.inputs["Scale"].default_value = 2.0
    times.operation, times.inputs[1].default_value = "MULTIPLY", 0.6
    tree.links.new(checker.outputs["Fac"], times.inputs[0])
    tree.links.new(times.outputs[0], bevel.inputs["Radius"])


def smooth(studio):
    box(studio)
    data = bpy.data.objects["box"].data
    data.polygons.foreach_set("use_smooth", [True] * len(data.polygons))


def mirrored(roughness):
    """The box as a wall shows it, whose reflections are sharp, or too wide for a bevel."""

    def make(studio):
        box(studio)
        upright = Euler((np.pi / 2, 0, 0)).to_matrix().to_4x4()
        wall = shader("wall", "BsdfGlossy", Roughness=roughness)
        if roughness:
            (node,) = (one for one in wall.node_tree.nodes if one.bl_idname.endswith(("Glossy", "Anisotropic")))
            node.distribution = "GGX"
        square(studio, "wall", wall, 4.0, Matrix.Translation((0, 2.4, 2)), upright)

    return make


def beside_others(studio):
    """Another object reaches into the box; and an instance of the box has its own faces."""
    box(studio)
    square(studio, "card", bpy.data.materials["grey"], 1.4, Matrix.Translation((0.4, -0.4, 0.4)))
    copy = studio.add("copy", bpy.data.objects["box"].data, Matrix.Translation((2.2, -0.2, -0.6)))
    copy.scale = (0.5, 0.5, 0.5)


def inside(studio):
    """From inside a box without a front."""
    box(studio, turn=(0.0, 0.0, 0.1), scale=(2.0, 2.4, 1.6), radius=0.8)
    mesh = bpy.data.objects["box"].data
    faces = [tuple(face.vertices) for face in mesh.polygons if face.normal.y > -0.5]
    corners = [tuple(vertex.co) for vertex in mesh.vertices]
    mesh.clear_geometry()
    mesh.from_pydata(corners, [], faces)


ROUGH = mirrored(0.35)
FAINT = (smooth, ROUGH)
CASES = {
    "4 samples": with_(),
    "2 samples": with_(samples=2),
    "3 samples": with_(samples=3),
    "8 samples": with_(samples=8),
    "a mirrored box": with_(scale=(-1.3, 0.9, 1.1)),
    "upright": with_(turn=(0.0, 0.0, 0.6)),
    "glossy": with_(kind="BsdfGlossy", Roughness=0.4),
    "metallic": with_(kind="BsdfMetallic", Roughness=0.3),
    "principled": with_(kind="BsdfPrincipled", Roughness=0.4),
    "over a normal map": over_a_map,
    "below a bump": below_a_bump,
    "worn edges": worn_edges,
    "a textured radius": textured,
    "smooth": smooth,
    "in a mirror": mirrored(0.0),
    "in a rough mirror": ROUGH,
    "beside other objects": beside_others,
    "inside": inside,
}
if bpy.app.version < (4, 3):
    del CASES["metallic"]
# What nearly repeats another case.
MORE = {"3 samples", "8 samples", "a mirrored box", "upright", "metallic", "worn edges", "in a mirror"}
PARAMETERS = [
    pytest.param(make, id=name, marks=pytest.mark.benchmark if name in MORE else pytest.mark.slow)
    for name, make in CASES.items()
]


def blind(scene):
    """The scene with bevels of radius 0."""

    def one(node):
        if isinstance(node, ex.Bevel):
            return replace(node, radius=ex.ZERO)
        return replace(node, **{name: one(part) for name, part in inputs(node).items()})

    def lobe(lobe):
        sockets = {name: one(part) for name, part in vars(lobe.closure).items() if isinstance(part, ex.Expression)}
        return WeightedClosure(replace(lobe.closure, **sockets), one(lobe.weight))

    return replace(scene, materials=tuple(replace(m, lobes=tuple(map(lobe, m.lobes))) for m in scene.materials))


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("make", PARAMETERS)
def test_bevels_are_those_of_cycles(studio, make):
    """And the comparison notices where nothing is bevelled, less on a smooth box and in a rough mirror."""
    make(studio)
    aware = studio.export()
    found = apart(studio, aware, blind(aware), samples=SAMPLES if make in FAINT else FEW_SAMPLES)
    assert found[0] < 1.5
    assert found[1] > (2.0 if make in FAINT else 5.0)


def test_the_sockets_are_read(studio):
    box(studio, samples=7, radius=0.25)
    (material,) = (one for one in studio.export().materials if one.name == "box")
    (bevel,) = (n for n in walk(material.lobes[0].closure.normal) if isinstance(n, ex.Bevel))
    assert bevel == ex.Bevel(ex.Constant(0.25), 7)
