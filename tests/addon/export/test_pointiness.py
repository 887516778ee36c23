# SPDX-License-Identifier: GPL-3.0-or-later
"""Pointiness of meshes against Cycles, pixel by pixel."""

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

PLACE = Matrix.LocRotScale((0.1, -0.1, 0.0), Euler((0.5, -0.4, 0.3)), (-0.9, 0.7, 1.2))
pytestmark = pytest.mark.compares_with_cycles


def monkey(made):
    bmesh.ops.create_monkey(made)


def apart(made):
    """Every face on its own, so that corners meet without sharing vertices."""
    bmesh.ops.create_icosphere(made, subdivisions=2, radius=1.0)
    for vertex in made.verts:
        vertex.co.x *= 0.4
    bmesh.ops.split_edges(made, edges=made.edges[:])


def with_loose_edges(made):
    """A box with wires from its corners, which count, and a wire of no length."""
    bmesh.ops.create_cube(made, size=1.3)
    for vertex in made.verts[:]:
        made.edges.new((vertex, made.verts.new(vertex.co * 1.4 + vertex.co.yzx * 0.3)))
    corner = next(iter(made.verts))
    made.edges.new((corner, made.verts.new(corner.co)))


def two_sided(made):
    """A sheet and its copy turned over, so that the normals at each place cancel."""
    bmesh.ops.create_grid(made, x_segments=3, y_segments=3, size=1.0)
    for vertex in made.verts:
        vertex.co.z = 0.3 * vertex.co.x**2
    copied = bmesh.ops.duplicate(made, geom=made.faces[:])["geom"]
    bmesh.ops.reverse_faces(made, faces=[item for item in copied if isinstance(item, bmesh.types.BMFace)])


SHAPES = {"monkey": monkey, "single faces": apart, "loose edges": with_loose_edges, "two sides": two_sided}


def shown_and_read(studio, rays, hits, build, smooth):
    """What Cycles shows and what the exported attribute is, (n,) each, at the pixels that meet the mesh."""
    mesh, made = bpy.data.meshes.new("shape"), bmesh.new()
    build(made)
    made.to_mesh(mesh)
    made.free()
    mesh.shade_smooth() if smooth else mesh.shade_flat()
    mesh.materials.append(studio.probe_material("ShaderNodeNewGeometry", "Pointiness"))
    studio.add("shape", mesh, PLACE)
    studio.look_down(3.0)
    image, scene = studio.cycles(), studio.export()
    triangle, weights, _ = hits(scene.mesh, *rays(scene.camera))
    met = triangle >= 0
    corners = scene.mesh.attributes["pointiness"][:, 4][:, triangle[met]]
    assert met.sum() > 140
    return image[met][:, 0], np.einsum("cn,cn->n", weights[:, met], corners)


@pytest.mark.parametrize("smooth", [True, False])
@pytest.mark.parametrize("name", SHAPES)
def test_pointiness_is_that_of_cycles(studio, rays, hits, name, smooth):
    shown, read = shown_and_read(studio, rays, hits, SHAPES[name], smooth)
    difference = np.abs(shown - read)
    assert np.median(difference) < 1e-5
    assert np.mean(difference > 1e-4) < 0.02  # a ray through an edge may fall to either side


def test_an_attribute_of_that_name_is_not_read(studio, rays, hits):
    def build(made):
        monkey(made)
        layer = made.verts.layers.float.new("pointiness")
        for vertex in made.verts:
            vertex[layer] = 5.0

    shown, read = shown_and_read(studio, rays, hits, build, True)
    assert np.median(np.abs(shown - read)) < 1e-5
