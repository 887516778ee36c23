# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that materials displace, against Cycles.

The tests compare places, shading normals and coordinates at each pixel's centre.
"""

import itertools

import bpy
import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
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
from mathutils import Euler, Matrix


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
    if "UV" in reason:
        glow = glowing("glow", lambda t: node(t, "Emission", {"Color": mapped()(t)}))
    else:
        glow = shine(OUTPUTS[0])
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


@pytest.mark.parametrize("method", ["DISPLACEMENT", "BUMP"])
def test_other_nodes_are_refused(method, studio, rng):
    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(shine(OUTPUTS[0]), waves))
    mesh.materials[0].displacement_method = method
    studio.add("sheet", mesh, BENT)
    is_refused(studio, "'Displacement') is not simulated; unlink Displacement, or link a Displacement node")


def test_a_displaced_material_that_is_not_simulated_is_passive_where_its_faces_are_known(studio, rng):
    mesh = sheet(studio, True, rng)
    for height, known in ((waves, True), (UNKNOWN_THERE["a Wireframe node"], False)):
        hair = displaced(glowing("hair", lambda t: node(t, "BsdfHair")), along_normal(height, "OBJECT"))
        mesh.materials.clear()
        mesh.materials.append(hair)
        thing = studio.add("sheet", mesh)
        scene = studio.export(partial=True)
        bpy.data.objects.remove(thing)
        assert scene.materials[0].unknown
        assert scene.materials[0].passive == known
        was = np.array([v.co for v in mesh.vertices]).T
        assert (np.abs(scene.mesh.vertices - was).max() > 0.05) == known


UNSCALED = Matrix.LocRotScale((0.1, -0.2, 0.0), Euler((0.3, -0.4, 0.5)), (1.0, 1.0, 1.0))
REFLECTED = Matrix.LocRotScale((0.1, -0.2, 0.0), Euler((0.3, -0.4, 0.5)), (-1.0, 1.0, 1.0))
simulates_both = pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="Displacement and Bump is refused there")


def bumped(material, build):
    displaced(material, build).displacement_method = "BOTH"
    return material


@simulates_both
@pytest.mark.parametrize("name", ["waves OBJECT", "waves WORLD", "attribute OBJECT"])
def test_displacement_and_bump_has_the_normal_of_a_bump_on_the_surface_as_it_was(name, studio, rays, hits, rng):
    for smooth, matrix in itertools.product((True, False), (UNSCALED, REFLECTED)):
        mesh = sheet(studio, smooth, rng)
        mesh.materials.append(bumped(glowing("plain", lambda t: node(t, "BsdfDiffuse")), CASES[name]))
        thing = studio.add("sheet", mesh, matrix)
        studio.look_down(2.0)
        scene = studio.export()
        mesh.materials[0] = bumped(shine(("NewGeometry", "Normal")), CASES[name])
        shown, got = seen(studio, scene, scene.materials[0].lobes[0].closure.normal, rays, hits)
        assert np.median(np.abs(shown - got).max(axis=0)) < 4e-3
        mesh.materials[0] = bumped(shine(("NewGeometry", "Position")), CASES[name])
        assert np.median(difference(studio, rays, hits)) < 2e-5
        bpy.data.objects.remove(thing)


@simulates_both
def test_faces_beside_a_displacement_and_bump_keep_their_normals_or_turn_by_their_own(studio, rays, hits, rng):
    """The materials are one that is bumped, one that only moves, and one that stays."""
    mesh, output = sheet(studio, True, rng), ("NewGeometry", "Normal")
    mesh.materials.append(shine(output))
    mesh.materials.append(displaced(shine(output), CASES["waves OBJECT"]))
    mesh.materials.append(bumped(glowing("dark", lambda t: node(t, "BsdfDiffuse")), CASES["waves OBJECT"]))
    mesh.polygons.foreach_set("material_index", rng.integers(0, 3, len(mesh.polygons)).astype(np.int32))
    studio.add("sheet", mesh, UNSCALED)
    studio.look_down(2.0)
    scene = studio.export()
    shown, got = seen(studio, scene, scene.materials[0].lobes[0].closure.color, rays, hits)
    off = np.abs(shown - (got - OFFSET)).max(axis=0)[shown[0] > -0.5 * OFFSET]
    assert off.size > 200
    assert np.median(off) < 2e-5
    assert np.mean(off > 1e-3) < 0.02


@simulates_both
@pytest.mark.parametrize("smooth", [True, False])
@pytest.mark.parametrize("angle", [30.0, 70.0])
def test_a_sun_lights_what_is_displaced_and_bumped_as_in_cycles(angle, smooth, studio, rng):
    mesh = sheet(studio, smooth, rng)
    mesh.materials.append(bumped(glowing("plain", lambda t: node(t, "BsdfDiffuse")), CASES["waves OBJECT"]))
    studio.add("sheet", mesh, UNSCALED)
    sun = bpy.data.lights.new("sun", "SUN")
    sun.angle = 0.0
    studio.add("sun", sun, Euler((np.radians(angle), 0.0, 1.0)).to_matrix().to_4x4())
    studio.look_down(2.0)
    studio.scene.cycles.max_bounces = 0
    shown = studio.cycles(64).mean()
    got = ReferenceRenderer(studio.export(), Options(threads=1)).render(0, 64).radiance.mean()
    assert abs(shown / got - 1.0) < 0.01


@pytest.mark.parametrize("method", ["DISPLACEMENT", "BUMP"])
def test_a_linked_normal_is_refused_by_its_own_name(method, studio, rng):
    def build(tree):
        return node(tree, "Displacement", {"Height": waves(tree), "Normal": node(tree, "NewGeometry", output="Normal")})

    mesh = sheet(studio, True, rng)
    mesh.materials.append(displaced(shine(OUTPUTS[0]), build))
    mesh.materials[0].displacement_method = method
    studio.add("sheet", mesh, BENT)
    is_refused(studio, "(Displacement), socket 'Normal' (linked), is not simulated; unlink Normal")


@pytest.mark.parametrize(
    ("height", "matrix", "what"),
    [
        (HEIGHTS["position"], UNSCALED, "Displacement and Bump by coordinates other than UV and Generated"),
        (waves, BENT, "Displacement and Bump of a scaled object"),
    ],
)
def test_what_cycles_bumps_wrongly_is_refused(height, matrix, what, studio, rng):
    mesh = sheet(studio, True, rng)
    mesh.materials.append(bumped(glowing("plain", lambda t: node(t, "BsdfDiffuse")), along_normal(height, "OBJECT")))
    studio.add("sheet", mesh, matrix)
    with pytest.raises(
        Refused, match=what if bpy.app.version >= (5, 2, 0) else "Displacement and Bump, before Blender 5.2"
    ):
        studio.export()


@simulates_both
def test_vectors_and_tangents_are_refused_beside_a_bump(studio, rng):
    mesh = sheet(studio, True, rng)
    mesh.materials.append(bumped(glowing("plain", lambda t: node(t, "BsdfDiffuse")), along_vector("OBJECT")))
    studio.add("sheet", mesh, UNSCALED)
    with pytest.raises(Refused, match="with Displacement and Bump is not simulated; choose Displacement Only"):
        studio.export()
    mapped_one = glowing("mapped", lambda t: node(t, "BsdfDiffuse", {"Normal": mapped()(t)}))
    mesh.materials[0] = bumped(mapped_one, CASES["waves OBJECT"])
    is_refused(studio, "a normal map or UV tangents of 'mapped' beside Displacement and Bump")
