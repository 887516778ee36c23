# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies whose faces light cannot leave for another.

It is proved where it holds, and never claimed where a ray does.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.geometry import meets_again
from etalon.lib.scene.camera import Aperture
from etalon.lib.wavefront.raycaster import Raycaster
from etalon.tests.scenes import Part, cube, fan, floor, icosphere, mesh, orthographic, perspective, quad
from scipy.spatial import ConvexHull

ABOVE = orthographic(4, 4, 3.0, (0.1, 0.1, 5.0))
BESIDE = perspective(4, 4, 0.5, (0.0, 0.0, 9.0))


def rounded(part):
    """Vertices as float32 has them, as modelling programs do."""
    return replace(part, vertices=part.vertices.astype(np.float32).astype(float))


def turned(part):
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.array(
        [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
    )
    return replace(part, vertices=turn @ part.vertices)


def moved(part, *offset):
    return replace(part, vertices=part.vertices + np.array(offset)[:, None])


def split(part):
    """Every triangle with corners of its own, as files for games have them."""
    corners = part.triangles.T.ravel()
    return replace(part, vertices=part.vertices[:, corners], triangles=np.arange(corners.size).reshape(-1, 3).T)


def lathe(segments, rings):
    """A sphere of quadrilaterals and caps of triangles, as Blender's UV sphere."""
    polar = np.linspace(0.0, np.pi, rings + 1)[1:-1, None]
    around = 2.0 * np.pi * np.arange(segments) / segments
    ring = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar) + 0.0 * around])
    vertices = np.concatenate([ring.reshape(3, -1), [[0.0, 0.0], [0.0, 0.0], [1.0, -1.0]]], axis=1)
    k = np.arange((rings - 2) * segments)
    here, beside = k, k - k % segments + (k + 1) % segments
    below, across = here + segments, beside + segments
    i, last = np.arange(segments), (rings - 2) * segments
    top, bottom = np.full(segments, vertices.shape[1] - 2), np.full(segments, vertices.shape[1] - 1)
    faces = [[here, below, across], [here, across, beside], [top, i, (i + 1) % segments]]
    faces += [[bottom, last + (i + 1) % segments, last + i]]
    return Part(vertices, np.concatenate([np.stack(f) for f in faces], axis=1))


def hull(points):
    """The convex hull of points (n, 3), faces outwards."""
    found = ConvexHull(points)
    faces = found.simplices.copy()
    corner, edges = points[faces[:, 0]], points[faces[:, 1:]] - points[faces[:, :1]]
    inwards = (np.cross(edges[:, 0], edges[:, 1]) * (corner - points.mean(axis=0))).sum(axis=1) < 0.0
    faces[inwards] = faces[inwards][:, ::-1]
    return Part(points.T, faces.T)


@pytest.mark.parametrize(
    "part",
    [
        cube(),
        turned(cube()),
        rounded(turned(cube())),
        split(cube()),
        icosphere(),
        rounded(turned(icosphere(subdivisions=4))),
        rounded(lathe(32, 16)),
        moved(rounded(lathe(96, 48)), 100.0, -30.0, 0.0),
    ],
)
def test_closed_convex_bodies(part):
    to_world = BESIDE.world_from_camera.copy()
    to_world[:, 3] += part.vertices.mean(axis=1)
    camera = replace(BESIDE, world_from_camera=to_world)
    assert meets_again(mesh(part), camera, []) == (False, "the faces are one closed convex body, seen from outside")
    assert meets_again(mesh(part), camera, ["glass"]) == (True, "light gets behind the faces of material 'glass'")


@pytest.mark.parametrize(
    "parts",
    [
        [floor()],
        [floor(), quad((2.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))],
        [turned(floor())],
        [rounded(turned(floor()))],
    ],
)
def test_planes_have_no_other_side_either(parts):
    assert meets_again(mesh(*parts), ABOVE, ["glass"]) == (False, "all faces lie in one plane")


@pytest.mark.parametrize(
    ("parts", "camera", "fact"),
    [
        ([cube(), floor(3.0, -1.0)], ABOVE, "in front"),
        ([cube(), cube(1.0, (3.0, 0.0, 0.0))], ABOVE, "in front"),
        ([cube(), cube(0.5)], ABOVE, "in front"),
        ([floor(), floor(1.0, 1e-4)], ABOVE, "in front"),
        ([replace(cube(), triangles=cube().triangles[::-1])], ABOVE, "in front"),
        ([fan([0.1, 0.5, 1.0])], ABOVE, "an opening"),
        ([replace(icosphere(), triangles=icosphere().triangles[:, 1:])], ABOVE, "an opening"),
        ([cube(9.0)], ABOVE, "clear of"),
        ([cube()], replace(ABOVE, clip_start=4.5), "clear of"),
        ([cube()], replace(ABOVE, aperture=Aperture(4.5, 0, 0.0, 1.0, 5.0)), "clear of"),
        ([cube()], replace(BESIDE, kind="EQUIRECTANGULAR", clip_start=8.5), "clear of"),
        ([lathe(320, 128)], ABOVE, "too many"),
    ],
)
def test_all_else_is_traced(parts, camera, fact):
    answer, why = meets_again(mesh(*parts), camera, [])
    assert answer
    assert fact in why


def test_a_panorama_outside():
    assert not meets_again(mesh(cube()), replace(BESIDE, kind="EQUIRECTANGULAR", clip_start=0.1), [])[0]


def _rays_that_hit(geometry, rng):
    """How many rays hit a face.

    Some thousand rays leave faces on the side of their normals.
    """
    caster = Raycaster(geometry)
    count = 4096
    triangle = rng.integers(0, geometry.triangle_count, count)
    a, b, c = (geometry.vertices[:, k] for k in geometry.triangles[:, triangle])
    u, v = rng.random((2, count))
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    placed, normal, offset = caster.on_plane(triangle, a + u * (b - a) + v * (c - a))
    direction = rng.normal(size=(3, count))
    direction *= np.sign((direction * normal).sum(axis=0)) / np.linalg.norm(direction, axis=0)
    return int((caster.closest(placed + normal * offset, direction).triangle >= 0).sum())


def test_convex_hulls_are_found_and_no_ray_contradicts(rng):
    """Hulls of random points, rounded to float32.

    With one vertex pushed in half its way they are none any more.
    """
    for points in (40, 60, 400):
        places = rng.normal(size=(points, 3)) * [1.0, 2.0, 0.3]
        part = rounded(hull(places / np.linalg.norm(places / [1.0, 2.0, 0.3], axis=1, keepdims=True)))
        geometry = mesh(part)
        assert not meets_again(geometry, BESIDE, [])[0]
        assert _rays_that_hit(geometry, rng) == 0
        vertices = part.vertices.copy()
        vertices[:, geometry.triangles[0, 0]] *= 0.5
        dented = mesh(replace(part, vertices=vertices))
        assert meets_again(dented, BESIDE, [])[0]
        assert points == 400 or _rays_that_hit(dented, rng) > 0
