# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes made by hand, for tests that run without Blender.

They are parts of meshes, cameras, and the whole around them.
"""

import functools
from dataclasses import dataclass

import numpy as np
from etalon.lib.scene.camera import Aperture, Camera
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.materials import Diffuse, Emission, Glass, Glossy, Material, Transparent, WeightedClosure
from etalon.lib.scene.mesh import Mesh, Object
from etalon.lib.scene.scene import Scene, Transport
from etalon.lib.scene.world import World


@dataclass(frozen=True)
class Part:
    """A part of a mesh.

    Vertices (3, v), triangles (3, t), one material for all or (t,), and normals (3, v) where it is shaded smooth.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    material: int | np.ndarray = 0
    normals: np.ndarray | None = None


def mesh(*parts: Part) -> Mesh:
    """One mesh of all parts, each an object of its own."""
    first = np.cumsum([0, *(part.vertices.shape[1] for part in parts)])
    count = [part.triangles.shape[1] for part in parts]
    smooth = np.repeat([part.normals is not None for part in parts], count)
    normals = np.zeros((3, 3, 0), np.float32)
    if smooth.any():
        given = [np.zeros_like(part.vertices) if part.normals is None else part.normals for part in parts]
        normals = np.concatenate(
            [n[:, part.triangles].transpose(1, 0, 2) for n, part in zip(given, parts, strict=True)], axis=2
        )
    return Mesh(
        vertices=np.concatenate([part.vertices for part in parts], axis=1),
        triangles=np.concatenate([p.triangles + k for p, k in zip(parts, first, strict=False)], axis=1).astype(
            np.int32
        ),
        material_index=np.concatenate([np.full(n, p.material) for p, n in zip(parts, count, strict=True)]).astype(
            np.int32
        ),
        object_index=np.repeat(np.arange(len(parts)), count).astype(np.int32),
        smooth=smooth,
        corner_normals=normals.astype(np.float32),
        objects=tuple(Object(f"object {k}", np.eye(4)[:3]) for k in range(len(parts))),
    )


def quad(corner, edge_u, edge_v, material=0) -> Part:
    """A parallelogram whose normal is edge_u x edge_v."""
    corner, u, v = (np.array(a, float) for a in (corner, edge_u, edge_v))
    return Part(
        np.stack([corner, corner + u, corner + u + v, corner + v], axis=1), np.array([[0, 0], [1, 2], [2, 3]]), material
    )


def floor(half=1.0, height=0.0, material=0) -> Part:
    """A square in the plane z = height, seen from above."""
    return quad((-half, -half, height), (2.0 * half, 0.0, 0.0), (0.0, 2.0 * half, 0.0), material)


def cube(half=1.0, center=(0.0, 0.0, 0.0), material=0) -> Part:
    """A watertight cube of 12 triangles that share 8 vertices, normals outwards."""
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float).T
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]).T
    return Part(corners * half + np.array(center, float)[:, None], triangles, material)


@functools.cache
def _unit_icosphere(subdivisions):
    """Vertices (3, v) on the unit sphere and faces (3, t)."""
    g = 0.5 * (1.0 + np.sqrt(5.0))
    corner = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    corner += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    vertices = [np.array(c) / np.linalg.norm(c) for c in corner]
    faces = [
        (0, 11, 5),
        (0, 5, 1),
        (0, 1, 7),
        (0, 7, 10),
        (0, 10, 11),
        (1, 5, 9),
        (5, 11, 4),
        (11, 10, 2),
        (10, 7, 6),
        (7, 1, 8),
    ]
    faces += [
        (3, 9, 4),
        (3, 4, 2),
        (3, 2, 6),
        (3, 6, 8),
        (3, 8, 9),
        (4, 9, 5),
        (2, 4, 11),
        (6, 2, 10),
        (8, 6, 7),
        (9, 8, 1),
    ]
    for _ in range(subdivisions):
        between: dict[tuple[int, int], int] = {}

        def middle(a, b, between=between):
            key = (min(a, b), max(a, b))
            if key not in between:
                between[key] = len(vertices)
                half = vertices[a] + vertices[b]
                vertices.append(half / np.linalg.norm(half))
            return between[key]

        split = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            split += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = split
    return np.array(vertices).T, np.array(faces).T


def icosphere(radius=1.0, subdivisions=3, material=0, smooth=False) -> Part:
    """A watertight sphere of 20 * 4^subdivisions triangles about the origin."""
    unit, faces = _unit_icosphere(subdivisions)
    return Part(unit * radius, faces, material, unit if smooth else None)


def fan(angles, materials=1) -> Part:
    """A convex strip of facets that `fan_camera` sees under `angles`.

    The angles are ascending, in radians: column k under angle k, row j in material j. No facet hides another, so that a
    reflected ray always leaves.
    """
    angles = np.asarray(angles, float)
    height = -np.concatenate([[0.0], np.cumsum(np.tan(angles))])
    columns = np.arange(angles.size + 1.0)
    x, y = np.meshgrid(columns, np.arange(materials + 1.0))
    vertices = np.stack([x.ravel(), y.ravel(), np.tile(height, materials + 1)])
    j, i = (k.ravel() for k in np.meshgrid(np.arange(materials), np.arange(angles.size), indexing="ij"))
    a = j * (angles.size + 1) + i
    b, d = a + 1, a + angles.size + 1
    triangles = np.concatenate([np.stack([a, b, d + 1]), np.stack([a, d + 1, d])], axis=1)
    return Part(vertices, triangles, np.tile(materials - 1 - j, 2))


def fan_camera(angles, materials=1) -> Camera:
    """The orthographic camera that sees each facet and material of `fan` in one pixel.

    Row 0, on top, is material 0.
    """
    plane = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    to_world = np.concatenate([np.eye(3), [[0.0], [0.0], [10.0]]], axis=1)
    return Camera("ORTHOGRAPHIC", len(angles), materials, plane, to_world, 0.0, 1e6)


def axes(forward, up=(0.0, 1.0, 0.0)) -> np.ndarray:
    """The camera's axes as columns, (3, 3), for a camera that looks along `forward`."""
    back = -np.array(forward, float)
    back /= np.linalg.norm(back)
    if np.linalg.norm(np.cross(up, back)) < 1e-6:
        up = (0.0, 0.0, 1.0) if abs(back[2]) < 0.9 else (1.0, 0.0, 0.0)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back], axis=1)


def orthographic(width, height, size, position, forward=(0.0, 0.0, -1.0), aperture: Aperture | None = None) -> Camera:
    """A camera whose raster of `width` pixels is `size` metres wide, its middle at `position`."""
    step = size / width
    plane = np.array([[step, 0.0, -0.5 * size], [0.0, step, -0.5 * step * height]])
    to_world = np.concatenate([axes(forward), np.array(position, float)[:, None]], axis=1)
    return Camera("ORTHOGRAPHIC", width, height, plane, to_world, 0.0, 1e6, aperture)


def perspective(width, height, tangent, position, forward=(0.0, 0.0, -1.0), aperture: Aperture | None = None) -> Camera:
    """A camera whose raster reaches to `tangent` right and left of its axis."""
    step = 2.0 * tangent / width
    plane = np.array([[step, 0.0, -tangent], [0.0, step, -0.5 * step * height]])
    to_world = np.concatenate([axes(forward), np.array(position, float)[:, None]], axis=1)
    return Camera("PERSPECTIVE", width, height, plane, to_world, 0.0, 1e6, aperture)


def color(*rgb: float) -> Constant:
    """A constant colour; one number is a grey."""
    return Constant(tuple(map(float, rgb * 3 if len(rgb) == 1 else rgb)))


def material(*closures, name="material") -> Material:
    """A material that adds up closures."""
    return Material(name, tuple(WeightedClosure(closure) for closure in closures))


def diffuse(*rgb: float, roughness=0.0) -> Material:
    """Lambert (or Oren-Nayar) of one colour."""
    return material(Diffuse(color(*rgb), Constant(roughness)))


def glossy(alpha, *rgb: float, distribution="GGX", anisotropy=0.0, rotation=0.0) -> Material:
    """Glossy of one colour, by alpha rather than Blender's roughness."""
    rgb = rgb or (1.0,)
    return material(
        Glossy(distribution, color(*rgb), Constant(float(np.sqrt(alpha))), Constant(anisotropy), Constant(rotation))
    )


def glass(ior, *rgb: float) -> Material:
    """Smooth glass."""
    return material(Glass(color(*(rgb or (1.0,))), Constant(ior)))


def emission(*rgb: float) -> Material:
    """An emitter of one radiance."""
    return material(Emission(color(*rgb)))


def transparent(*rgb: float) -> Material:
    """A straight-through filter."""
    return material(Transparent(color(*rgb)))


def scene(geometry, materials, camera, lights=(), world=0.0, bounces=0, transparent_max_bounces=64, images=()) -> Scene:
    """The whole: parts (or one), materials (or one), lights, a grey, RGB or World."""
    parts = (geometry,) if isinstance(geometry, Part) else geometry
    materials = (materials,) if isinstance(materials, Material) else tuple(materials)
    if not isinstance(world, World):
        world = World(color(*np.atleast_1d(world)))
    transport = Transport(bounces, transparent_max_bounces)
    return Scene("test", mesh(*parts), materials, tuple(lights), world, camera, transport, tuple(images))
