# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that materials displace, against Cycles.

The tests compare places, shading normals and coordinates at each pixel's centre.
"""

import itertools

import bpy
import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.tests.addon.export.nodes.node_cells import glowing, node
from etalon.tests.addon.export.nodes.test_normals_against_cycles import (
    BENT,
    MIRRORED,
    OFFSET,
    lifted,
    mapped,
    seen,
    sheet,
    uv,
    waves,
)
from mathutils import Matrix


def picture(tree):
    """An image of 9 x 7 numbers."""
    image = bpy.data.images.new("heights", 9, 7, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    x, y = np.meshgrid(np.arange(9), np.arange(7))
    image.pixels.foreach_set(np.repeat((x * y + 3 * x) % 11 / 10.0, 4).astype(np.float32))
    image.pack()
    return node(tree, "TexImage", {"Vector": uv(tree)}, image=image)


def along_normal(height, space):
    def build(tree):
        inputs = {"Height": height(tree), "Midlevel": 0.2, "Scale": 0.4}
        return node(tree, "Displacement", inputs, space=space)

    return build


def along_vector(space):
    def build(tree):
        where = node(tree, "TexCoord", output="Object")
        bent = node(tree, "VectorMath", {"Vector": where}, operation="SINE")
        return node(tree, "VectorDisplacement", {"Vector": bent, "Midlevel": 0.1, "Scale": 0.2}, space=space)

    return build


def displaced(material, build):
    tree = material.node_tree
    (out,) = (n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(build(tree), out.inputs["Displacement"])
    material.displacement_method = "DISPLACEMENT"
    return material


def shine(output):
    """A material that glows with the output of a node."""
    return glowing("glow", lambda t: node(t, "Emission", {"Color": lifted(t, node(t, output[0], output=output[1]))}))


def compare(studio, rays, hits, mesh, matrix, build, output):
    """How far a node's output in Cycles is from that of the export, (k,).

    It is at the pixels that meet the displaced mesh.
    """
    mesh.materials.clear()
    mesh.materials.append(displaced(shine(output), build))
    sheet = studio.add("sheet", mesh, matrix)
    off = difference(studio, rays, hits)
    bpy.data.objects.remove(sheet)
    return off


def difference(studio, rays, hits):
    """The same for all that the studio holds, if it glows alike."""
    studio.look_down(2.0)
    scene = studio.export()
    (lobe,) = scene.materials[0].lobes
    shown, got = seen(studio, scene, lobe.closure.color, rays, hits)
    return np.abs(shown - (got - OFFSET)).max(axis=0)


HEIGHTS = {
    "waves": waves,
    "image": picture,
    "attribute": lambda t: node(t, "Attribute", attribute_name="corners", output="Fac"),
    "normal": lambda t: node(t, "SeparateXYZ", {"Vector": node(t, "NewGeometry", output="Normal")}, output="X"),
    "true normal": lambda t: node(
        t, "SeparateXYZ", {"Vector": node(t, "NewGeometry", output="True Normal")}, output="X"
    ),
    "position": lambda t: node(t, "SeparateXYZ", {"Vector": node(t, "NewGeometry", output="Position")}, output="X"),
    "noise": lambda t: node(t, "TexNoise", {"Vector": node(t, "TexCoord", output="Generated")}, output="Fac"),
}
CASES = {
    **{f"{name} {space}": along_normal(height, space) for name, height in HEIGHTS.items() for space in ("OBJECT", "WORLD")},
    **{f"vector {space}": along_vector(space) for space in ("OBJECT", "TANGENT", "WORLD")},
}  # fmt: skip


OUTPUTS = (("NewGeometry", "Position"), ("NewGeometry", "Normal"), ("TexCoord", "Object"))


@pytest.mark.parametrize("name", CASES)
def test_faces_and_normals_are_where_cycles_has_them(name, studio, rays, hits, rng):
    for smooth, matrix in itertools.product((True, False), (BENT, MIRRORED)):
        mesh = sheet(studio, smooth, rng)
        for output in OUTPUTS:
            off = compare(studio, rays, hits, mesh, matrix, CASES[name], output)
            assert np.median(off) < 2e-5
            # Pixels whose ray meets an edge between triangles fall to either side.
            assert np.mean(off > 1e-3) < 0.02


@pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="before Blender 5.2 Cycles tears such meshes apart")
@pytest.mark.parametrize("kind", ["sharp faces", "sharp edges", "custom normals"])
def test_corners_with_normals_of_their_own_turn_as_their_vertex_does(kind, studio, rays, hits, rng):
    mesh = sheet(studio, True, rng)
    if kind == "sharp faces":
        mesh.polygons.foreach_set("use_smooth", rng.random(len(mesh.polygons)) < 0.5)
    elif kind == "sharp edges":
        mesh.edges.foreach_set("use_edge_sharp", rng.random(len(mesh.edges)) < 0.3)
    else:
        mesh.normals_split_custom_set((rng.random((len(mesh.loops), 3)) - 0.5 + (0.0, 0.0, 1.0)).tolist())
    assert mesh.normals_domain == "CORNER"
    for name, output in itertools.product(("waves OBJECT", "image WORLD"), OUTPUTS):
        off = compare(studio, rays, hits, mesh, MIRRORED, CASES[name], output)
        assert np.median(off) < 5e-5  # Cycles packs such a normal into 32 bits twice
        assert np.mean(off > 1e-3) < 0.02


@pytest.mark.parametrize("output", OUTPUTS)
def test_only_faces_of_a_displaced_material_move(output, studio, rays, hits, rng):
    """A vertex that both have moves, with the normal of the faces that move."""
    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(shine(output), CASES["waves OBJECT"]))
    mesh.materials.append(shine(output))
    mesh.polygons.foreach_set("material_index", (rng.random(len(mesh.polygons)) < 0.7).astype(np.int32))
    studio.add("sheet", mesh, BENT)
    off = difference(studio, rays, hits)
    assert np.median(off) < 2e-5
    assert np.mean(off > 1e-3) < 0.02


@pytest.mark.parametrize("output", OUTPUTS)
def test_users_of_one_mesh_are_displaced_alike_in_object_space(output, studio, rays, hits, rng):
    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(shine(output), CASES["waves OBJECT"]))
    studio.add("sheet", mesh, Matrix.Translation((-0.4, 0.0, 0.0)) @ BENT)
    studio.add("other", mesh, Matrix.Translation((0.9, 0.3, 0.2)) @ MIRRORED)
    off = difference(studio, rays, hits)
    assert np.median(off) < 2e-5
    assert np.mean(off > 1e-3) < 0.02


@pytest.mark.parametrize("name", ["waves WORLD", "position OBJECT"])
def test_users_of_one_mesh_that_would_move_otherwise_are_refused(name, studio, rng):
    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(shine(OUTPUTS[0]), CASES[name]))
    studio.add("sheet", mesh, BENT)
    studio.export()
    studio.add("other", mesh, MIRRORED)
    is_refused(studio, "object 'sheet': the displacement of 'glow', which depends on the object")


@pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="before Blender 5.2 tangents are not displaced")
@pytest.mark.usefixtures("_normal_of_unit_length")
@pytest.mark.parametrize("smooth", [True, False])
def test_normal_maps_follow_the_displaced_mesh(smooth, studio, rays, hits, rng):
    mesh = sheet(studio, smooth, rng)
    glow = glowing("glow", lambda t: node(t, "Emission", {"Color": lifted(t, mapped()(t))}))
    mesh.materials.append(displaced(glow, CASES["waves OBJECT"]))
    studio.add("sheet", mesh, BENT)
    off = difference(studio, rays, hits)
    assert np.median(off) < 5e-5
    assert np.mean(off > 1e-3) < 0.02


def is_refused(studio, what):
    with pytest.raises(Refused) as caught:
        studio.export()
    (refusal,) = map(str, caught.value.refusals)
    assert what in refusal


def test_users_of_one_mesh_with_other_materials_are_refused(studio, rng):
    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(shine(OUTPUTS[0]), CASES["waves OBJECT"]))
    studio.add("sheet", mesh, BENT)
    slot = studio.add("other", mesh, MIRRORED).material_slots[0]
    slot.link, slot.material = "OBJECT", studio.plain
    is_refused(studio, "the displacement of 'glow' on a mesh whose users have other materials, is not simulated")


def test_tangents_without_a_uv_map_are_refused(studio, rng):
    mesh = sheet(studio, True, rng)
    mesh.uv_layers.remove(mesh.uv_layers[0])
    mesh.materials.append(displaced(shine(OUTPUTS[0]), CASES["vector TANGENT"]))
    studio.add("sheet", mesh, BENT)
    is_refused(studio, "displacement in tangent space of a mesh without a UV map is not simulated; give it a UV map")


@pytest.mark.skipif(bpy.app.version >= (5, 2, 0), reason="simulated since Blender 5.2")
@pytest.mark.parametrize("reason", ["custom normals or sharp edges", "a normal map or UV tangents of 'glow'"])
def test_corners_and_tangents_are_refused_before_5_2(reason, studio, rng):
    mesh = sheet(studio, True, rng)
    glow = shine(OUTPUTS[0])
    if "UV" in reason:
        glow = glowing("glow", lambda t: node(t, "Emission", {"Color": mapped()(t)}))
    else:
        mesh.edges[20].use_edge_sharp = True
    mesh.materials.append(displaced(glow, CASES["waves OBJECT"]))
    studio.add("sheet", mesh, BENT)
    is_refused(studio, reason)


UNKNOWN_THERE = {
    "a Normal Map node": lambda t: node(t, "SeparateXYZ", {"Vector": mapped()(t)}, output="X"),
    "a Bump node": lambda t: node(t, "SeparateXYZ", {"Vector": node(t, "Bump", {"Height": waves(t)})}, output="X"),
    "a Bevel node": lambda t: node(t, "SeparateXYZ", {"Vector": node(t, "Bevel")}, output="X"),
    "an Ambient Occlusion node": lambda t: node(t, "AmbientOcclusion", output="AO"),
    "a Wireframe node": lambda t: node(t, "Wireframe"),
    "a Light Path node": lambda t: node(t, "LightPath", output="Is Camera Ray"),
    "a Fresnel node": lambda t: node(t, "Fresnel"),
    "a Layer Weight node": lambda t: node(t, "LayerWeight", output="Facing"),
    "Incoming of a Geometry node": lambda t: node(
        t, "SeparateXYZ", {"Vector": node(t, "NewGeometry", output="Incoming")}, output="X"
    ),
}


@pytest.mark.parametrize("what", UNKNOWN_THERE)
def test_what_has_no_value_at_a_vertex_is_refused(what, studio, rng):
    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(shine(OUTPUTS[0]), along_normal(UNKNOWN_THERE[what], "OBJECT")))
    studio.add("sheet", mesh, BENT)
    is_refused(studio, f"material 'glow': {what} in a displacement is not simulated; bake it to an image, or unlink it")


@pytest.mark.parametrize(
    ("build", "method", "remedy"),
    [
        (waves, "DISPLACEMENT", "unlink Displacement, or link a Displacement or Vector Displacement node"),
        (waves, "BUMP", "unlink Displacement, or link a Displacement node"),
        (CASES["waves OBJECT"], "BOTH", "choose Displacement Only or Bump Only"),
    ],
)
def test_other_nodes_and_both_methods_at_once_are_refused(build, method, remedy, studio, rng):
    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(shine(OUTPUTS[0]), build))
    mesh.materials[0].displacement_method = method
    studio.add("sheet", mesh, BENT)
    is_refused(studio, f"socket 'Displacement') is not simulated; {remedy}")


def test_a_displaced_material_that_is_not_simulated_is_passive_where_its_faces_are_known(studio, rng):
    mesh = sheet(studio, True, rng)
    for method in ("DISPLACEMENT", "BOTH"):
        hair = displaced(glowing("hair", lambda t: node(t, "BsdfHair")), CASES["waves OBJECT"])
        hair.displacement_method = method
        mesh.materials.clear()
        mesh.materials.append(hair)
        thing = studio.add("sheet", mesh)
        scene = studio.export(partial=True)
        bpy.data.objects.remove(thing)
        assert scene.materials[0].unknown
        assert scene.materials[0].passive == (method == "DISPLACEMENT")
        was = np.array([v.co for v in mesh.vertices]).T
        assert (np.abs(scene.mesh.vertices - was).max() > 0.05) == (method == "DISPLACEMENT")
