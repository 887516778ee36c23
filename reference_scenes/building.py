# SPDX-License-Identifier: GPL-3.0-or-later
"""Building blocks of the reference scenes.

They are meshes of flat triangles, materials by their alpha, lights, and a camera.
"""

from __future__ import annotations

import math

import bpy
import mathutils
import numpy as np

Color = tuple[float, float, float]
Point = tuple[float, float, float]

# A turn that lines up with nothing: no edge of a mesh then lies in the middle of a column or row of pixels.
ODD_TURN = 0.3217


def start(name: str, width: int, height: int, max_bounces: int) -> bpy.types.Scene:
    """Replace what is open by an empty scene with Cycles.

    It has square pixels and the plain sRGB view.
    """
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.name = name
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.cycles.samples = 256
    for kind in ("max", "diffuse", "glossy", "transmission"):
        setattr(scene.cycles, f"{kind}_bounces", max_bounces)
    return scene


def _link(name: str, data: bpy.types.ID, location: Point) -> bpy.types.Object:
    item = bpy.data.objects.new(name, data)
    item.location = location
    bpy.context.scene.collection.objects.link(item)
    return item


def _nodes(owner: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree:
    if bpy.app.version < (5, 0):
        owner.use_nodes = True
    owner.node_tree.nodes.clear()
    return owner.node_tree


def _material(name: str, node_type: str, color: Color) -> tuple[bpy.types.Material, bpy.types.Node]:
    material = bpy.data.materials.new(name)
    tree = _nodes(material)
    shader = tree.nodes.new(node_type)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (250, 0)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    shader.inputs["Color"].default_value = (*color, 1.0)
    material.diffuse_color = (*color, 1.0)
    return material, shader


def glossy(name: str, distribution: str, alpha: float, color: Color) -> bpy.types.Material:
    """Single-scatter microfacets of width `alpha`; the node's roughness is its square root."""
    material, shader = _material(name, "ShaderNodeBsdfAnisotropic", color)
    shader.distribution = distribution
    shader.inputs["Roughness"].default_value = math.sqrt(alpha)
    return material


def diffuse(name: str, color: Color) -> bpy.types.Material:
    """A Lambertian surface of albedo `color`."""
    return _material(name, "ShaderNodeBsdfDiffuse", color)[0]


def mesh(
    name: str,
    vertices: np.ndarray,
    faces: np.ndarray,
    materials: list[bpy.types.Material],
    location: Point = (0.0, 0.0, 0.0),
    material_index: np.ndarray | None = None,
) -> bpy.types.Object:
    """A flat-shaded mesh of `vertices` (v, 3) and `faces` (f, corners)."""
    data = bpy.data.meshes.new(name)
    _fill(data, vertices, faces)
    for material in materials:
        data.materials.append(material)
    if material_index is not None:
        data.polygons.foreach_set("material_index", material_index)
    return _link(name, data, location)


def _fill(data: bpy.types.Mesh, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Do what `from_pydata` does, from arrays of Blender's own types.

    Through its lists a large sphere takes ten times as long.
    """
    data.vertices.add(len(vertices))
    data.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    data.loops.add(faces.size)
    data.loops.foreach_set("vertex_index", faces.astype(np.int32).ravel())
    data.polygons.add(len(faces))
    data.polygons.foreach_set("loop_start", np.arange(0, faces.size, faces.shape[1], dtype=np.int32))
    sharp = data.attributes.new("sharp_face", "BOOLEAN", "FACE")
    sharp.data.foreach_set("value", np.ones(len(faces), bool))
    data.update(calc_edges=True)


def sphere(
    name: str, material: bpy.types.Material, location: Point, radius: float, segments: int, rings: int
) -> bpy.types.Object:
    """Add a sphere of 2 `segments` (`rings` - 1) flat triangles.

    Its vertices lie on the true sphere.
    """
    theta, phi = np.meshgrid(
        np.pi * np.arange(1, rings) / rings, 2 * np.pi * np.arange(segments) / segments, indexing="ij"
    )
    body = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1).reshape(-1, 3)
    vertices = radius * np.concatenate([body, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    here = np.arange((rings - 1) * segments).reshape(rings - 1, segments)
    right = np.roll(here, -1, axis=1)
    top, bottom = len(body), len(body) + 1
    faces = np.concatenate(
        [
            np.stack([here[:-1], here[1:], right[:-1]], axis=-1).reshape(-1, 3),
            np.stack([right[:-1], here[1:], right[1:]], axis=-1).reshape(-1, 3),
            np.stack([np.full(segments, top), here[0], right[0]], axis=-1),
            np.stack([np.full(segments, bottom), right[-1], here[-1]], axis=-1),
        ]
    )
    item = mesh(name, vertices, faces, [material], location)
    item.rotation_euler = (ODD_TURN, 0.5 * ODD_TURN, ODD_TURN)
    return item


def rectangle(name: str, material: bpy.types.Material, center: Point, edge_u: Point, edge_v: Point) -> bpy.types.Object:
    """One flat rectangle about `center`, facing edge_u x edge_v."""
    u, v = np.array(edge_u), np.array(edge_v)
    corners = np.array([-u - v, u - v, u + v, v - u]) / 2
    return mesh(name, corners, np.array([[0, 1, 2, 3]]), [material], center)


def box(
    name: str, material: bpy.types.Material, center: Point, size: Point, turn: float = ODD_TURN
) -> bpy.types.Object:
    """A box of `size`, turned by `turn` radians about the vertical."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    faces = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    item = mesh(name, signs * np.array(size) / 2, faces, [material], center)
    item.rotation_euler = (0.0, 0.0, turn)
    return item


def _aim(item: bpy.types.Object, target: Point) -> None:
    """Turn the object's -z axis to `target`, its y axis up."""
    direction = mathutils.Vector(target) - item.location
    item.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def camera(location: Point, target: Point, lens: float = 50.0, ortho_scale: float | None = None) -> bpy.types.Object:
    """Add the scene's camera, which looks at `target`.

    It is orthographic where `ortho_scale` (metres across the longer side) is given.
    """
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    if ortho_scale is not None:
        data.type, data.ortho_scale = "ORTHO", ortho_scale
    item = _link("Camera", data, location)
    _aim(item, target)
    bpy.context.scene.camera = item
    return item


def area_light(name: str, location: Point, target: Point, size: tuple[float, float], radiance: Color) -> None:
    """Add a rectangular light of the given radiance: power = pi x area x radiance.

    All but camera rays see it.
    """
    data = bpy.data.lights.new(name, "AREA")
    data.shape = "RECTANGLE"
    data.size, data.size_y = size
    data.energy = math.pi * size[0] * size[1] * max(radiance)
    data.color = tuple(c / max(radiance) for c in radiance)
    _aim(_link(name, data, location), target)


def sphere_light(name: str, location: Point, radius: float, radiance: Color) -> None:
    """A spherical light of the given radiance: power = 4 pi^2 r^2 x radiance."""
    data = bpy.data.lights.new(name, "POINT")
    data.shadow_soft_size = radius
    data.use_soft_falloff = False
    data.energy = 4 * math.pi**2 * radius**2 * max(radiance)
    data.color = tuple(c / max(radiance) for c in radiance)
    _link(name, data, location)


def world(radiance: Color) -> bpy.types.World:
    """A world of constant radiance."""
    data = bpy.data.worlds.new("World")
    bpy.context.scene.world = data
    tree = _nodes(data)
    background = tree.nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (*radiance, 1.0)
    output = tree.nodes.new("ShaderNodeOutputWorld")
    output.location = (250, 0)
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    return data
