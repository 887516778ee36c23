# SPDX-License-Identifier: GPL-3.0-or-later
"""Exported triangles against hand-made arrays.

They are also compared with what Cycles finds under every pixel.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.export.mesh import read_mesh
from etalon.lib.errors import EtalonError
from etalon.lib.scene.mesh import Object
from etalon.lib.scene.placements import Placements
from mathutils import Euler, Matrix

MIRROR = Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0))
ODD = (
    Matrix.Translation((1, 2, 3)) @ Euler((0.3, 0.4, 0.5)).to_matrix().to_4x4() @ Matrix.Diagonal((2.0, 0.5, 1.5, 1.0))
)

CUBE = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
OUTWARD = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def normals(mesh):
    """(3, t) unit geometric normals."""
    a, b, c = (mesh.vertices[:, mesh.triangles[k]] for k in range(3))
    n = np.cross(b - a, c - a, axis=0)
    return n / np.linalg.norm(n, axis=0)


def same_as_cycles(studio, rays, hits, expected, node, output, tolerance, size=12, offset=0.0, scale=1.0):
    """Compare an expectation with a node's output in Cycles.

    It is expected(mesh, triangle, weights (3, n), points (3, n)) -> (3, n).
    """
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = size
    scene = studio.export()
    origin, direction = rays(scene.camera)
    index, weights, distance = hits(scene.mesh, origin, direction)
    shown = studio.probe(node, output, offset, scale).transpose(2, 0, 1)
    met = index >= 0
    assert met.any()
    assert np.array_equal(met, ~np.isnan(shown[0]))
    points = origin[:, met] + distance[met] * direction[:, met]
    ours = expected(scene.mesh, index[met], weights[:, met], points)
    assert np.abs(ours - shown[:, met]).max() < tolerance
    return scene


def position(mesh, index, weights, points):
    return points


def barycentric(corners, index, weights):
    """(c, n) interpolation of corner values (3 corners, c, t)."""
    return np.einsum("kcn,kn->cn", corners[:, :, index], weights)


def shading_normal(mesh, index, weights, points):
    flat = normals(mesh)[:, index]
    if mesh.corner_normals.size == 0:
        return flat
    smooth = barycentric(mesh.corner_normals, index, weights)
    return np.where(mesh.smooth[index], smooth / np.linalg.norm(smooth, axis=0), flat)


@pytest.mark.parametrize(
    "matrix", [Matrix(), ODD, MIRROR, ODD @ MIRROR], ids=["as made", "odd", "mirrored", "odd mirrored"]
)
def test_a_cube_keeps_its_outside(studio, matrix):
    cube = studio.add("cube", studio.mesh("cube", CUBE, OUTWARD), matrix)
    mesh = studio.export().mesh
    world = np.array(cube.matrix_world, np.float64)
    assert world == pytest.approx(np.array(matrix), abs=1e-6)
    assert mesh.vertices == pytest.approx(world[:3, :3] @ np.array(CUBE).T + world[:3, 3:], rel=1e-6, abs=1e-6)
    assert mesh.triangle_count == 12
    assert not mesh.smooth.any()
    assert mesh.corner_normals.shape == (3, 3, 0)
    centers = mesh.vertices[:, mesh.triangles].mean(axis=1) - world[:3, 3:]
    assert np.all(np.einsum("it,it->t", normals(mesh), centers) > 0.0)
    assert mesh.objects[0].name == "cube"
    assert mesh.objects[0].world_from_object == pytest.approx(world[:3])
    assert [a.dtype for a in (mesh.vertices, mesh.triangles, mesh.smooth)] == [np.float64, np.int32, bool]


def test_faces_turn_their_backs_as_in_cycles(studio, rays, hits, rng):
    """Alone and as instances of one mesh, mirrored and not.

    Cycles' Backfacing is the sign of our normal.
    """
    shared = studio.mesh("shared", [(-1, -1, 0), (1, -1, 0.2), (0, 1, -0.1)], [(0, 1, 2)])
    for i in range(12):
        single = shared if i % 2 else shared.copy()
        scale = Matrix.Diagonal([*(float(s) for s in rng.uniform(0.4, 0.9, 3) * rng.choice([-1, 1], 3)), 1.0])
        turn = Euler([float(a) for a in rng.uniform(-0.8, 0.8, 3)]).to_matrix().to_4x4()
        studio.add(
            f"face {i}", single, Matrix.Translation((2.0 * (i % 4) - 3.0, 2.0 * (i // 4) - 2.0, 0.0)) @ turn @ scale
        )
    studio.look_down(8.0)

    def backfacing(mesh, index, weights, points):
        return np.broadcast_to(normals(mesh)[2, index] < 0.0, points.shape)

    scene = same_as_cycles(studio, rays, hits, backfacing, "ShaderNodeNewGeometry", "Backfacing", 1e-6, size=32)
    facing = normals(scene.mesh)[2] > 0.0
    assert 0 < facing.sum() < 12


def folded(studio, matrix=None):
    """Three faces in a row."""
    rows = [(x, y, z) for x, z in ((-1, 0), (-0.3, 0.5), (0.3, 0.2), (1, -0.6)) for y in (-1, 1)]
    return studio.add("folded", studio.mesh("folded", rows, [(0, 2, 3, 1), (2, 4, 5, 3), (4, 6, 7, 5)]), matrix)


def all_smooth(mesh):
    mesh.polygons.foreach_set("use_smooth", [True] * 3)


def one_sharp_face(mesh):
    mesh.polygons.foreach_set("use_smooth", [False, True, True])


def one_sharp_edge(mesh):
    all_smooth(mesh)
    next(e for e in mesh.edges if set(e.vertices) == {2, 3}).use_edge_sharp = True


def sharp_face_and_edge(mesh):
    one_sharp_face(mesh)
    next(e for e in mesh.edges if set(e.vertices) == {4, 5}).use_edge_sharp = True


def only_sharp_edges(mesh):
    all_smooth(mesh)
    mesh.edges.foreach_set("use_edge_sharp", [True] * len(mesh.edges))


def only_sharp_edges_and_no_word_of_faces(mesh):
    only_sharp_edges(mesh)
    mesh.attributes.remove(mesh.attributes["sharp_face"])


def custom(mesh):
    one_sharp_edge(mesh)
    mesh.normals_split_custom_set([(0.1 * i - 0.5, 0.3, 1.0) for i in range(12)])


def custom_on_a_sharp_face(mesh):
    one_sharp_face(mesh)
    mesh.normals_split_custom_set([(0.1 * i - 0.5, 0.3, 1.0) for i in range(12)])


SHADINGS = [
    all_smooth,
    one_sharp_face,
    one_sharp_edge,
    sharp_face_and_edge,
    only_sharp_edges,
    only_sharp_edges_and_no_word_of_faces,
    custom,
    custom_on_a_sharp_face,
]


@pytest.mark.parametrize("shade", SHADINGS)
def test_shading_normals_are_those_of_cycles(studio, rays, hits, shade):
    shade(folded(studio).data)
    studio.look_down(2.47)
    # Cycles from 5.1 on keeps corner normals in 2 x 16 bits.
    same_as_cycles(studio, rays, hits, shading_normal, "ShaderNodeNewGeometry", "Normal", 1e-4, offset=2.0)


def test_normals_of_a_stretched_mirrored_instance(studio, rays, hits):
    turn = Euler((0.2, -0.3, 0.4)).to_matrix().to_4x4()
    first = folded(studio, turn @ Matrix.Diagonal((-0.7, 1.4, 0.8, 1.0)))
    custom(first.data)
    studio.add("second", first.data, Matrix.Translation((5, 0, 0)))
    studio.look_down(2.47)
    same_as_cycles(studio, rays, hits, shading_normal, "ShaderNodeNewGeometry", "Normal", 1e-4, offset=2.0)


def test_a_flattened_object_keeps_its_normal(studio):
    flat = folded(studio, Matrix.Diagonal((1.0, 1.0, 0.0, 1.0)))
    all_smooth(flat.data)
    mesh = studio.export().mesh
    assert mesh.corner_normals[:, 2] == pytest.approx(1.0)


def line_of_instances(material):
    """A geometry node tree: a line of points, an icosphere of `material` on each."""
    tree = bpy.data.node_groups.new("line", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    line, ball = tree.nodes.new("GeometryNodeMeshLine"), tree.nodes.new("GeometryNodeMeshIcoSphere")
    place, out = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("NodeGroupOutput")
    line.inputs["Count"].default_value = 4
    line.inputs["Offset"].default_value = (0.9, 0.3, 0.2)
    ball.inputs["Radius"].default_value = 0.4
    tree.links.new(line.outputs[0], place.inputs["Points"])
    paint = tree.nodes.new("GeometryNodeSetMaterial")
    paint.inputs["Material"].default_value = material
    tree.links.new(ball.outputs[0], paint.inputs["Geometry"])
    tree.links.new(paint.outputs[0], place.inputs["Instance"])
    place.inputs["Scale"].default_value = (1.0, -0.7, 0.8)
    tree.links.new(place.outputs[0], out.inputs[0])
    return tree


def everything(studio, material):
    """One object of each kind that renders as a mesh.

    Modifiers differ between viewport and render.
    """
    studio.plain = material
    ball = studio.add("ball", studio.mesh("ball", CUBE, OUTWARD), Matrix.Translation((-3, 3, 0)))
    levels = ball.modifiers.new("levels", "SUBSURF")
    levels.levels, levels.render_levels = 0, 3
    wavy = studio.quad("wavy")
    wavy.location = (0, 3, 0)
    array = wavy.modifiers.new("array", "ARRAY")
    array.count, array.show_viewport = 3, False
    hidden = wavy.modifiers.new("hidden", "WIREFRAME")
    hidden.show_render = False
    curve = bpy.data.curves.new("curve", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.3
    curve.resolution_u, curve.render_resolution_u = 2, 5
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(1)
    for point, x in zip(spline.bezier_points, (-1.0, 1.0), strict=True):
        point.co, point.handle_left, point.handle_right = (x, 0, 0), (x - 0.5, x, 0), (x + 0.5, -x, 0.4)
    studio.add("curve", curve, Matrix.Translation((-3, 0, 0)))
    text = bpy.data.curves.new("text", "FONT")
    text.body, text.extrude = "ij", 0.2
    studio.add("text", text, Matrix.Translation((0, 0, 0)))
    blob = bpy.data.metaballs.new("blob")
    blob.resolution, blob.render_resolution = 0.8, 0.35
    blob.elements.new().co = (3, 0, 0)
    blob.elements.new().co = (3.8, 0.3, 0.5)
    studio.add("blob", blob)
    inner = bpy.data.collections.new("inner")
    inner.objects.link(bpy.data.objects.new("part", ball.data))
    group = studio.add(
        "group", None, Matrix.Translation((-3, -3, 0)) @ Euler((0.5, 0.6, 0.7)).to_matrix().to_4x4() @ MIRROR
    )
    group.instance_type, group.instance_collection = "COLLECTION", inner
    line = studio.quad("line")
    line.location = (-0.5, -3, 0)
    line.modifiers.new("nodes", "NODES").node_group = line_of_instances(material)
    vertices = studio.quad("vertices", half=0.6)
    vertices.location, vertices.rotation_euler = (3.5, -3, 0), (0.3, 0.2, 0.1)
    studio.add("leaf", studio.mesh("leaf", [(0, 0, 0), (0.5, 0, 0.2), (0, 0.5, 0.1)], [(0, 1, 2)])).parent = vertices
    vertices.instance_type = "VERTS"
    vertices.show_instancer_for_render = False
    for thing, viewport, render in (("rendered", True, False), ("unrendered", False, True)):
        quad = studio.quad(thing, half=0.4, z=3.0)
        quad.hide_viewport, quad.hide_render = viewport, render
        quad.location.x = -5.0 if render else 5.0
    aside = studio.quad("aside", z=4.0)
    studio.scene.collection.objects.unlink(aside)
    excluded = bpy.data.collections.new("excluded")
    excluded.objects.link(aside)
    studio.scene.collection.children.link(excluded)
    studio.layer.layer_collection.children["excluded"].exclude = True


def test_every_kind_of_object_is_where_cycles_has_it(studio, rays, hits):
    everything(studio, studio.plain)
    studio.look_down(12.0)
    scene = same_as_cycles(
        studio, rays, hits, position, "ShaderNodeNewGeometry", "Position", 2e-3, size=32, offset=10.0
    )
    names = [thing.name for thing in scene.mesh.objects]
    assert {"ball", "wavy", "curve", "text", "blob", "part", "leaf", "rendered"} <= set(names)
    assert not {"unrendered", "aside", "vertices", "camera"} & set(names)
    assert names.count("line") == 4
    assert names.count("leaf") == 4
    ball = scene.mesh.object_index == names.index("ball")
    assert ball.sum() == 6 * 4**3 * 2


def glowing(studio, node, output):
    """A probe that the exporter can read, too: it glows with a node's output as it is."""
    material = studio.probe_material(node, output)
    tree = material.node_tree
    tree.nodes.remove(next(n for n in tree.nodes if n.bl_idname == "ShaderNodeVectorMath"))
    find = {n.bl_idname: n for n in tree.nodes}
    tree.links.new(find[node].outputs[output], find["ShaderNodeEmission"].inputs["Color"])
    return material


def test_generated_coordinates_of_a_modified_mesh(studio, rays, hits):
    everything(studio, glowing(studio, "ShaderNodeTexCoord", "Generated"))
    bend = bpy.data.objects["ball"].modifiers.new("bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.factor = "TAPER", 0.7
    studio.look_down(12.0)

    def generated(mesh, index, weights, points):
        return np.einsum("ckn,kn->cn", mesh.generated[:, mesh.triangles[:, index]], weights)

    same_as_cycles(studio, rays, hits, generated, "ShaderNodeTexCoord", "Generated", 1e-3, size=32, offset=2.0)


@pytest.mark.parametrize("uv_map", ["", "second"])
def test_uv_maps_of_a_mirrored_mesh(studio, rays, hits, rng, uv_map):
    material = glowing(studio, "ShaderNodeUVMap", "UV")
    next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeUVMap").uv_map = uv_map
    studio.plain = material
    thing = folded(studio, Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0)))
    for name in ("first", "second", "third"):
        layer = thing.data.uv_layers.new(name=name)
        layer.uv.foreach_set("vector", rng.uniform(0.0, 1.0, 24).astype(np.float32))
    thing.data.uv_layers["third"].active_render = True
    studio.quad("bare", half=0.2, z=3.0)
    studio.look_down(2.47)

    def uv(mesh, index, weights, points):
        return np.vstack([barycentric(mesh.uvs[uv_map], index, weights), np.zeros(index.size)])

    studio.probe_material = lambda *_: material
    scene = same_as_cycles(studio, rays, hits, uv, "", "", 1e-4)
    assert set(scene.mesh.uvs) == {uv_map}


def place(placements, local, count):
    for i in range(count):
        placements.add(Object(f"instance {i}", np.eye(3, 4)), local, np.zeros(1, np.int32))


def test_too_many_instances_are_refused_before_they_are_made(studio):
    cube = studio.mesh("cube", CUBE, OUTWARD)
    local = read_mesh(cube, "cube", (), False)
    placements = Placements(limit=100_000)
    with pytest.raises(EtalonError, match=r"instance 3\d: with this instance the scene needs more than 0.0 GB"):
        place(placements, local, 1000)


def test_a_mesh_that_needs_too_much_memory_is_refused_before_it_is_read(studio, monkeypatch):
    """20,000 triangles, at 201 bytes each or more, where 3 MB are half of the memory."""

    def read(*arguments):
        raise AssertionError("the mesh was read")

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=100, y_subdivisions=100)
    monkeypatch.setattr("etalon.lib.scene.placements._memory", lambda: 6 << 20)
    monkeypatch.setattr("etalon.addon.export.scene.read_mesh", read)
    with pytest.raises(EtalonError, match=r"^Grid: with this instance the scene needs more than 0.0 GB"):
        studio.export()


@pytest.mark.parametrize("shown_in_edit_mode", [True, False])
def test_an_object_in_edit_mode_is_exported_as_cycles_renders_it(studio, rays, hits, shown_in_edit_mode):
    quad = studio.quad(half=0.4)
    row = quad.modifiers.new("row", "ARRAY")
    row.count, row.show_in_editmode = 2, shown_in_edit_mode
    quad.data.materials.append(bpy.data.materials.new("second"))
    quad.data.polygons[0].material_index = 1
    studio.quad(half=0.5, z=-1.0)
    studio.layer.objects.active = quad
    bpy.ops.object.mode_set(mode="EDIT")
    studio.look_down(2.47)
    scene = same_as_cycles(studio, rays, hits, position, "ShaderNodeNewGeometry", "Position", 1e-5, offset=2.0)
    assert scene.mesh.triangle_count == (6 if shown_in_edit_mode else 4)
    names = np.array([material.name for material in scene.materials])[scene.mesh.material_index]
    assert sorted(names) == ["plain", "plain", *["second"] * (scene.mesh.triangle_count - 2)]
