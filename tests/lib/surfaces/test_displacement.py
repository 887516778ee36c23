# SPDX-License-Identifier: GPL-3.0-or-later
"""Displaced meshes against closed forms: shifted and tilted planes, spheres, and a wave."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import Refused, SceneError
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.converters import Combine, Component
from etalon.lib.scene.materials import Displacement
from etalon.lib.scene.mesh import UNDISPLACED, UNDISPLACED_NORMAL, Object
from etalon.lib.scene.placements import LocalMesh, Placements
from etalon.lib.surfaces.displacement import Normals, depends_on_object, displace
from etalon.lib.surfaces.surface import SurfacePoints, SurfaceTables
from etalon.lib.textures.evaluate import evaluate
from etalon.lib.textures.images import ImageSet
from etalon.tests.turns import turned

PLAIN = np.eye(4)[:3]
X = Component(ex.Coordinates("OBJECT"), 0)


def times(expression, factor):
    return ex.Math("MULTIPLY", expression, ex.Constant(factor), ex.ZERO)


def local_mesh(positions, triangles, smooth=True, slot=None, attributes=None):
    triangles = np.asarray(triangles, np.int32)
    count = triangles.shape[1]
    return LocalMesh(
        positions=np.asarray(positions, np.float32),
        triangles=triangles,
        slot=np.zeros(count, np.int32) if slot is None else slot,
        smooth=np.full(count, smooth),
        corner_normals=np.zeros((3, 3, count), np.float32) if smooth else None,
        uvs={},
        generated=None,
        attributes=attributes or {},
    )


def grid(side, **options):
    """A square from -1 to 1 of so many squares a side, facing +z, and its normals."""
    x, y = (one.ravel() for one in np.meshgrid(*[np.linspace(-1.0, 1.0, side + 1)] * 2))
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    lower = [first, first + 1, first + side + 2]
    upper = [first, first + side + 2, first + side + 1]
    local = local_mesh([x, y, 0.0 * x], np.concatenate([lower, upper], axis=1), **options)
    return local, vertex_normals(local, np.tile([[0.0], [0.0], [1.0]], x.size))


def vertex_normals(local, normals):
    return Normals(np.stack([normals[:, k] for k in local.triangles]))


def displaced(local, normals, displacement, matrix=PLAIN, still=False):
    return displace(
        local, normals, Object("thing", matrix), [displacement, None] if still else [displacement], ImageSet(())
    )


@pytest.mark.parametrize("smooth", [True, False])
def test_a_constant_height_shifts_a_plane(smooth):
    local, normals = grid(3, smooth=smooth)
    found = displaced(local, normals, Displacement(ex.Constant(0.25)))
    assert np.array_equal(found.positions, local.positions + np.array([[0.0], [0.0], [0.25]], np.float32))
    assert found.displaced
    if smooth:
        assert np.array_equal(found.corner_normals, np.broadcast_to([[0.0], [0.0], [1.0]], found.corner_normals.shape))
    else:
        assert found.corner_normals is None


def test_a_constant_height_makes_a_sphere_larger():
    """The normals of an octahedron's corners are radial."""
    corners = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float).T
    triangles = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]]).T
    local = local_mesh(corners, triangles)
    found = displaced(local, vertex_normals(local, corners), Displacement(ex.Constant(0.5)))
    np.testing.assert_allclose(found.positions, 1.5 * corners, atol=1e-6)
    np.testing.assert_allclose(found.corner_normals, np.stack([corners[:, k] for k in triangles]), atol=1e-6)


def uv_sphere(rings):
    """Unit vectors, and triangles that turn outwards; the poles are left open."""
    polar, around = np.linspace(0.2, np.pi - 0.2, rings + 1), 2 * np.pi * np.arange(2 * rings) / (2 * rings)
    theta, phi = np.meshgrid(polar, around, indexing="ij")
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]).reshape(3, -1)
    row, column = (one.ravel() for one in np.meshgrid(np.arange(rings), np.arange(2 * rings), indexing="ij"))
    a, b = row * 2 * rings + column, row * 2 * rings + (column + 1) % (2 * rings)
    return points, np.concatenate([[a, a + 2 * rings, b], [b, a + 2 * rings, b + 2 * rings]], axis=1)


def test_normals_of_a_larger_sphere_become_radial_as_its_faces_shrink():
    worst = []
    for rings in (16, 32, 64):
        points, triangles = uv_sphere(rings)
        local = local_mesh(points, triangles)
        found = displaced(local, vertex_normals(local, points), Displacement(ex.Constant(1.0)))
        np.testing.assert_allclose(found.positions, 2.0 * points, atol=1e-6)
        inner = (np.abs(points[2][triangles]) < 0.9).all(axis=0)
        radial = np.stack([points[:, k] for k in triangles])[..., inner]
        worst.append(np.abs(found.corner_normals[..., inner] - radial).max())
    assert worst[2] < 0.03
    assert worst[1] / worst[2] > 1.8


def test_a_gradient_tilts_a_plane():
    local, normals = grid(4)
    found = displaced(local, normals, Displacement(times(X, 0.75)))
    np.testing.assert_allclose(found.positions[2], 0.75 * local.positions[0], atol=1e-6)
    tilted = np.array([[-0.6], [0.0], [0.8]])
    np.testing.assert_allclose(found.corner_normals, np.broadcast_to(tilted, found.corner_normals.shape), atol=1e-6)


def test_normals_of_a_wave_tend_to_those_of_its_closed_form():
    """z = 0.2 sin 3x has the normals (-0.6 cos 3x, 0, 1), not yet of unit length."""
    wave = times(ex.Math("SINE", times(X, 3.0), ex.ZERO, ex.ZERO), 0.2)
    worst = []
    for side in (32, 64, 128):
        local, normals = grid(side)
        found = displaced(local, normals, Displacement(wave))
        x = local.positions[0].astype(float)
        np.testing.assert_allclose(found.positions[2], 0.2 * np.sin(3.0 * x), atol=1e-6)
        truth = np.stack([-0.6 * np.cos(3.0 * x), 0.0 * x, 1.0 + 0.0 * x])
        truth /= np.linalg.norm(truth, axis=0)
        inner = (np.abs(local.positions[:2]) < 0.95).all(axis=0)[local.triangles].all(axis=0)
        wanted = np.stack([truth[:, k] for k in local.triangles])[..., inner]
        worst.append(np.abs(found.corner_normals[..., inner] - wanted).max())
    assert worst[2] < 1e-3
    assert worst[1] / worst[2] > 3.5  # it falls with the square of the faces' size


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(("space", "distance"), [("OBJECT", 0.3 * 3.0), ("WORLD", 0.3)])
def test_a_height_is_a_length_of_its_space(space, distance, mirrored):
    """A plane that is scaled by 3 along its normal, among others, and then turned."""
    matrix = turned(0.7, (-2.0 if mirrored else 2.0, 0.5, 3.0), (0.4, -0.1, 2.0), (1.0, -2.0, 0.5))
    local, normals = grid(2)
    found = displaced(local, normals, Displacement(ex.Constant(0.3), space), matrix)
    placed = matrix[:, :3] @ found.positions + matrix[:, 3:]
    was = matrix[:, :3] @ local.positions + matrix[:, 3:]
    np.testing.assert_allclose(placed - was, distance * np.broadcast_to(matrix[:, 2:3] / 3.0, was.shape), atol=1e-6)


@pytest.mark.parametrize("space", ["OBJECT", "WORLD"])
def test_a_vector_moves_along_the_axes_of_its_space(space):
    matrix = turned(1.1, (2.0, 0.5, 3.0), (0.0, 1.0, 0.0), (0.3, 1.0, -0.5))
    vector = Combine(times(X, 0.2), ex.Constant(0.3), ex.Constant(-0.1))
    local, normals = grid(2)
    found = displaced(local, normals, Displacement(vector, space, is_vector=True), matrix)
    moved = found.positions.astype(float) - local.positions
    wanted = np.stack([0.2 * local.positions[0], np.full(9, 0.3), np.full(9, -0.1)])
    np.testing.assert_allclose(moved if space == "OBJECT" else matrix[:, :3] @ moved, wanted, atol=1e-6)


def test_a_tangent_vector_has_components_along_tangent_normal_and_bitangent():
    """The plane's map is (u, v) = (y, -x): the tangent is +y, the bitangent -x."""
    local, normals = grid(2)
    x, y = (np.stack([local.positions[axis, k] for k in local.triangles]) for axis in (0, 1))
    local.uvs[""] = np.stack([y, -x], axis=1).astype(np.float32)
    vector = ex.Constant((0.1, 0.2, 0.4))
    found = displaced(local, normals, Displacement(vector, "TANGENT", is_vector=True))
    wanted = np.broadcast_to([[-0.4], [0.1], [0.2]], local.positions.shape)
    np.testing.assert_allclose(found.positions - local.positions, wanted, atol=1e-6)


def test_a_vertex_moves_as_the_first_triangle_says():
    """Two triangles share an edge, at which an attribute of the corners differs."""
    values = np.zeros((3, 6, 2), np.float32)
    values[:, 4] = [[0.1, 0.4], [0.2, 0.5], [0.3, 0.6]]
    local = local_mesh([[0, 1, 1, 0], [0, 0, 1, 1], [0, 0, 0, 0]], [[0, 0], [1, 2], [2, 3]], attributes={"h": values})
    normals = vertex_normals(local, np.tile([[0.0], [0.0], [1.0]], 4))
    found = displaced(local, normals, Displacement(ex.Attribute("h", "FACTOR")))
    np.testing.assert_allclose(found.positions[2], [0.1, 0.2, 0.3, 0.6], atol=1e-6)


def test_faces_of_other_materials_stay_and_take_the_normals_of_those_that_move():
    """The left half of a plane is raised by 1 + x, and with it the edge of the other half."""
    local, normals = grid(2, slot=np.array([0, 1, 0, 1, 0, 1, 0, 1], np.int32))
    found = displaced(local, normals, Displacement(ex.Math("ADD", X, ex.ONE, ex.ZERO)), still=True)
    x = local.positions[0]
    np.testing.assert_allclose(found.positions[2], np.where(x <= 0.0, 1.0 + x, 0.0), atol=1e-6)
    tilted = np.array([-1.0, 0.0, 1.0]) / np.sqrt(2.0)
    for k, corner in zip(local.triangles, found.corner_normals, strict=True):
        wanted = np.where(x[k] <= 0.0, tilted[:, None], np.array([[0.0], [0.0], [1.0]]))
        np.testing.assert_allclose(corner, wanted, atol=1e-6)


def test_a_sharp_face_keeps_the_face_s_normal_and_others_turn_with_their_vertex():
    """A tilt turns all mixed normals alike; to each corner's the difference is added."""
    local, _ = grid(2)
    sharp = np.arange(8) % 3 == 0
    bent = np.array([0.6, 0.0, 0.8])
    before = np.where(sharp, np.array([[0.0], [0.0], [1.0]]), bent[:, None])
    normals = Normals(np.stack([before] * 3), sharp)
    found = displaced(local, normals, Displacement(Combine(ex.ZERO, ex.ZERO, times(X, 0.75)), is_vector=True))
    tilted = np.array([-0.6, 0.0, 0.8])
    added = bent + tilted - np.array([0.0, 0.0, 1.0])
    wanted = np.where(sharp, tilted[:, None], (added / np.linalg.norm(added))[:, None])
    np.testing.assert_allclose(found.corner_normals, np.stack([wanted] * 3), atol=1e-6)


def test_normals_of_a_displaced_mesh_are_mixed_in_object_space():
    """In a scaled object, the mix is turned into the world, not the corners."""
    matrix = turned(0.0, (1.0, 1.0, 4.0))
    local, normals = grid(2)
    found = displaced(local, normals, Displacement(ex.Math("MULTIPLY", X, X, ex.ZERO)), matrix)
    placements = Placements()
    placements.add(Object("thing", matrix), found, np.zeros(1, np.int32))
    mesh = placements.join(frozenset(), False)
    third = np.full(8, 1 / 3)
    ng = np.tile([[0.0], [0.0], [1.0]], 8)
    shown = SurfacePoints(SurfaceTables(mesh), np.arange(8), third, third, np.zeros((3, 8)), ng, ng).n
    mixed = found.corner_normals.astype(float).mean(axis=0)
    wanted = mixed / np.array([[1.0], [1.0], [4.0]])
    np.testing.assert_allclose(shown, wanted / np.linalg.norm(wanted, axis=0), atol=1e-6)


def bumped_mesh(offset, matrix, side=2, smooth=True):
    """A plane that is displaced and bumped, as the scene has it."""
    local, normals = grid(side, smooth=smooth)
    height = np.zeros((3, 6, local.slot.size), np.float32)
    height[:, 4] = np.stack([local.positions[0, k] for k in local.triangles])
    local = replace(local, attributes={"x": height, UNDISPLACED: 0.0 * height, UNDISPLACED_NORMAL: 0.0 * height})
    found = displaced(local, normals, Displacement(offset, bumps=True), matrix)
    placements = Placements()
    placements.add(Object("thing", matrix), found, np.zeros(1, np.int32))
    return placements.join(frozenset(), False, frozenset(local.attributes))


def points_on(mesh, rng, count=50):
    """Points on triangles, seen from their front."""
    triangle = rng.integers(0, mesh.triangle_count, count)
    u, v = np.sort(rng.random((2, count)), axis=0)
    v -= u
    a, b, c = (mesh.vertices[:, k[triangle]] for k in mesh.triangles)
    ng = np.cross(b - a, c - a, axis=0)
    ng /= np.linalg.norm(ng, axis=0)
    return SurfacePoints(SurfaceTables(mesh), triangle, u, v, a + u * (b - a) + v * (c - a), ng, ng)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("smooth", [False, True])
def test_a_bump_has_the_normal_of_the_wave_that_the_mesh_is_too_coarse_for(smooth, mirrored, rng):
    """z = 0.2 sin 3x on a plane of two squares a side, which was turned and moved."""
    matrix = turned(0.7, (-1.0 if mirrored else 1.0, 1.0, 1.0), (0.4, -0.1, 2.0), (1.0, -2.0, 0.5))
    height = times(ex.Math("SINE", times(ex.Attribute("x", "FACTOR"), 3.0), ex.ZERO, ex.ZERO), 0.2)
    mesh = bumped_mesh(height, matrix, smooth=smooth)
    assert not mesh.smooth.any()
    points = points_on(mesh, rng)
    x = points.attribute("x")[4]
    truth = matrix[:, :3] @ np.stack([-0.6 * np.cos(3.0 * x), 0.0 * x, 1.0 + 0.0 * x])
    raised = ex.Math("MULTIPLY", height, ex.NormalScale(), ex.ZERO)
    got = evaluate(ex.Undisplaced(ex.Bump(raised, ex.ONE, ex.ONE)), points, ImageSet(()))
    np.testing.assert_allclose(got, truth / np.linalg.norm(truth, axis=0), atol=2e-5)


def test_a_point_knows_where_it_was_before_its_vertices_moved(rng):
    matrix = turned(0.7, (1.0, 1.0, 1.0), (0.4, -0.1, 2.0), (1.0, -2.0, 0.5))
    mesh = bumped_mesh(times(ex.Attribute("x", "FACTOR"), 0.7), matrix)
    points = points_on(mesh, rng)
    now, before = (
        np.linalg.inv(matrix[:, :3]) @ (evaluate(one, points, ImageSet(())) - matrix[:, 3:])
        for one in (ex.Coordinates("POSITION"), ex.Undisplaced(ex.Coordinates("POSITION")))
    )
    np.testing.assert_allclose(before[:2], now[:2], atol=1e-6)
    np.testing.assert_allclose(before[2], 0.0, atol=1e-6)
    np.testing.assert_allclose(now[2], 0.7 * now[0], atol=1e-6)


@pytest.mark.parametrize(
    ("offset", "space", "depends"),
    [
        (X, "OBJECT", False),
        (ex.Coordinates("GENERATED"), "TANGENT", False),
        (ex.Coordinates("NORMAL"), "OBJECT", False),
        (ex.ONE, "WORLD", True),
        (times(ex.Coordinates("POSITION"), 2.0), "OBJECT", True),
        (ex.Coordinates("SHADING_NORMAL"), "OBJECT", True),
        (ex.ObjectInfo("RANDOM"), "OBJECT", True),
    ],
)
def test_what_the_world_or_the_object_decides_is_found(offset, space, depends):
    assert depends_on_object(Displacement(offset, space)) is depends


def test_a_vertex_without_a_place_is_an_error():
    local, normals = grid(2)
    with pytest.raises(SceneError, match="thing: 27 coordinates of displaced vertices not finite or beyond 1e"):
        displaced(local, normals, Displacement(ex.Constant(np.inf)))


@pytest.mark.parametrize("smooth", [True, False])
def test_smooth_faces_without_area_are_refused(smooth):
    local, normals = grid(2, smooth=smooth)
    flattened = Displacement(Combine(times(X, -1.0), ex.ZERO, ex.ZERO), is_vector=True)
    if smooth:
        with pytest.raises(Refused, match="object 'thing': displacement of smooth faces without area"):
            displaced(local, normals, flattened)
    else:
        assert not displaced(local, normals, flattened).positions[0].any()
