# SPDX-License-Identifier: GPL-3.0-or-later
"""Overlapping faces are found with their area, for any triangles in one plane.

Nothing else is found.
"""

from fractions import Fraction

import numpy as np
import pytest
from etalon.lib.scene.overlap_pairs import overlap_area, overlap_in_plane
from etalon.lib.scene.overlap_planes import find_planes, share_a_plane
from etalon.lib.scene.overlaps import find_overlaps


def shared_by_sections(first, second, sections=5_000):
    """The area that two triangles (2, 3) share.

    It is the integral of the lengths that sections across both have in common.
    """
    x = np.linspace(max(first[0].min(), second[0].min()), min(first[0].max(), second[0].max()), sections + 1)
    if x[-1] <= x[0]:
        return 0.0
    x = 0.5 * (x[1:] + x[:-1])
    ends = []
    for triangle in (first, second):
        low, high = np.full(x.size, np.inf), np.full(x.size, -np.inf)
        for k in range(3):
            (x0, y0), (x1, y1) = triangle[:, k], triangle[:, (k + 1) % 3]
            there = (x - x0) * (x - x1) <= 0.0
            y = y0 + (y1 - y0) * (x - x0) / (x1 - x0)
            low, high = np.where(there, np.minimum(low, y), low), np.where(there, np.maximum(high, y), high)
        ends.append((low, high))
    (a, b), (c, d) = ends
    return float(np.maximum(np.minimum(b, d) - np.maximum(a, c), 0.0).sum() * (x[1] - x[0]))


def plane_frame(rng):
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return axes[:, :2], axes[:, 2] * rng.uniform(-3.0, 3.0)


def as_mesh(flat, frame, origin):
    """Triangles (n, 2, 3) of a plane in space, as float32 keeps them."""
    points = np.einsum("ck,nkj->ncj", frame, flat) + origin[None, :, None]
    vertices = points.transpose(1, 0, 2).reshape(3, -1).astype(np.float32).astype(np.float64)
    return vertices, np.arange(vertices.shape[1]).reshape(-1, 3).T


def height_of(flat):
    edges = np.roll(flat, -1, axis=2) - flat
    doubled = np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 1, 0] * edges[:, 0, 1])
    return doubled / np.hypot(edges[:, 0], edges[:, 1]).max(axis=1)


def grid(count, height=lambda x, y: 0.0 * x):
    x, y = (values.ravel() for values in np.meshgrid(*[np.linspace(-1.0, 1.0, count + 1)] * 2))
    i = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b, c, d = i[:-1, :-1].ravel(), i[:-1, 1:].ravel(), i[1:, 1:].ravel(), i[1:, :-1].ravel()
    return np.stack([x, y, height(x, y)]), np.hstack([np.stack([a, b, c]), np.stack([a, c, d])])


def joined(*meshes):
    vertices = np.hstack([vertices for vertices, _ in meshes])
    starts = np.cumsum([0, *(vertices.shape[1] for vertices, _ in meshes)])
    return vertices, np.hstack([triangles + start for (_, triangles), start in zip(meshes, starts, strict=False)])


@pytest.mark.grid(3)
@pytest.mark.parametrize("size", [0.05, 0.5, 3.0])
def test_pairs_and_areas_equal_those_of_sections_across_all_pairs(rng, size):
    """Triangles of every shape and size in a tilted plane, and as many in another one."""
    count = 40
    flat = rng.uniform(-1.0, 1.0, (8 * count, 2, 1)) + size * rng.uniform(-1.0, 1.0, (8 * count, 2, 3)) ** 3
    flat = flat[height_of(flat) > 0.02 * size][:count]  # not those whose plane single precision does not tell
    meshes = [as_mesh(flat, *plane_frame(rng)) for _ in range(2)]
    found = find_overlaps(*joined(*meshes))
    area = {tuple(pair): value for pair, value in zip(found.pairs.T.tolist(), found.area, strict=True)}
    for k in range(2):
        for i in range(count):
            for j in range(i + 1, count):
                exact = shared_by_sections(flat[i], flat[j])
                here = area.pop((i + k * count, j + k * count), 0.0)
                assert here == pytest.approx(exact, rel=2e-3, abs=2e-5 * size)
    assert not area


@pytest.mark.parametrize("height", [lambda x, y: 0.0 * x, lambda x, y: 0.3 * x, lambda x, y: 0.1 * np.sin(5.0 * x) * y])
def test_a_mesh_that_covers_its_surface_once_overlaps_nowhere(height):
    assert find_overlaps(*grid(60, height)).count == 0


def test_a_table_top_in_a_floor_is_found_with_its_area():
    """One of 2 x 2 m in another of 7 x 7 m, however each is divided."""
    floor, rug = grid(1), grid(23)
    floor[0][:2] *= 3.5
    found = find_overlaps(*joined(floor, rug))
    assert found.area.sum() == pytest.approx(4.0, rel=1e-6)
    assert set(found.pairs[0].tolist()) <= {0, 1}
    assert (found.pairs[1] >= 2).all()


def test_a_copy_overlaps_its_original_in_every_triangle():
    """Also one that is turned over, and one whose quads are divided along the other diagonal."""
    vertices, triangles = grid(9, lambda x, y: 0.4 * x - 0.2 * y)
    for other in (triangles, triangles[::-1]):
        found = find_overlaps(*joined((vertices, triangles), (vertices, other)))
        assert found.count == triangles.shape[1]
        assert found.area.sum() == pytest.approx(4.0 * np.sqrt(1.0 + 0.4**2 + 0.2**2), rel=1e-6)
    turned = vertices[:, ::-1] * np.array([[-1.0], [1.0], [1.0]])
    turned[2] = 0.4 * turned[0] - 0.2 * turned[1]
    found = find_overlaps(*joined((vertices, triangles), (turned, triangles)))
    assert found.area.sum() == pytest.approx(4.0 * np.sqrt(1.2), rel=1e-6)


@pytest.mark.parametrize("gap", [1e-5, 1e-3])
def test_faces_a_gap_apart_that_single_precision_resolves_do_not_overlap(gap):
    upper = grid(3)
    upper[0][2] += gap
    assert find_overlaps(*joined(grid(3), upper)).count == 0


@pytest.mark.parametrize("gap", [0.0, 1e-8])
def test_faces_a_gap_apart_that_single_precision_does_not_resolve_overlap(gap):
    upper = grid(3)
    upper[0][2] += gap
    assert find_overlaps(*joined(grid(3), upper)).area.sum() == pytest.approx(4.0, rel=1e-6)


def test_neighbours_that_share_an_edge_or_cross_at_an_angle_do_not_overlap():
    a, b = grid(2), grid(2)
    b[0][0] += 2.0
    upright = grid(2)
    upright[0][[1, 2]] = upright[0][[2, 1]]
    assert find_overlaps(*joined(a, b, upright)).count == 0


def test_what_was_found_for_one_mesh_is_not_said_of_another():
    """What was found last is kept, but a vertex or a face that is another makes another mesh."""
    flat = joined(grid(2), grid(2))
    first = find_overlaps(*flat)
    assert first.count > 0
    assert find_overlaps(flat[0].copy(), flat[1].copy()) is first
    apart = flat[0].copy()
    apart[2, 9:] = 1.0
    assert find_overlaps(apart, flat[1]).count == 0
    assert find_overlaps(flat[0], flat[1][:, :8]).count == 0
    again = find_overlaps(*flat)
    assert again is not first
    assert np.array_equal(again.pairs, first.pairs)


def all_pairs(vertices, triangles):
    """The plain definition: of each two triangles, whether they overlap as seen along an axis and share a plane."""
    corners = vertices[:, triangles].transpose(1, 0, 2)
    planes = find_planes(corners, vertices.mean(axis=1))
    first, second = np.triu_indices(triangles.shape[1], 1)
    kept = planes.resolved[first] & planes.resolved[second]
    first, second = first[kept], second[kept]
    axis = np.argmax(np.abs(planes.normal), axis=0)[first]
    sides = []
    for triangle in (first, second):
        seen = corners[:, np.array([(axis + 1) % 3, (axis + 2) % 3]), triangle]
        along, across = seen[1] - seen[0], seen[2] - seen[0]
        sides.append(np.where(along[0] * across[1] < along[1] * across[0], seen[[0, 2, 1]], seen))
    kept = overlap_in_plane(*sides, np.maximum(planes.tolerance[first], planes.tolerance[second]))
    first, second = first[kept], second[kept]
    kept = share_a_plane(corners.reshape(9, -1).T, planes, first, second)
    return np.array([first[kept], second[kept]])


def lattice_triangles(rng, count):
    """Triangles (count, 2, 3) with corners on lattices of three sizes.

    Many share edges, end in the middle of another one's edge, are copies, or have no area.
    """
    return rng.integers(0, 5, (count, 2, 3)) * rng.choice([0.25, 1.0, 4.0], (count, 1, 1))


@pytest.mark.parametrize("distance", [0.0, 30.0, 1000.0])
@pytest.mark.parametrize("planes", [2, 30])
def test_search_finds_the_pairs_of_all_pairs_of_lattice_triangles(rng, planes, distance):
    """In planes of any tilt, far from the origin, where single precision moves corners off their lattice."""
    count = 480 // planes
    origin = distance * rng.normal(size=3)
    frames = [plane_frame(rng) for _ in range(planes)]
    mesh = joined(*(as_mesh(lattice_triangles(rng, count), axes, origin + base) for axes, base in frames))
    expected = all_pairs(*mesh)
    assert expected.shape[1] > 100
    assert np.array_equal(find_overlaps(*mesh).pairs, expected)


@pytest.mark.parametrize("distance", [0.0, 30.0])
@pytest.mark.parametrize("tilt", [0.0, 2.0**-12, 2.0**-8])
def test_search_finds_the_pairs_of_all_pairs_in_stacks_of_sheets(rng, tilt, distance):
    """Sheets above each other that are nearly parallel, each of them twice."""
    frame, base = plane_frame(rng)
    normal = np.cross(*frame.T)
    meshes = []
    for k in range(15):
        slope = frame + tilt * rng.normal(size=2) * normal[:, None]
        sheet = lattice_triangles(rng, 16), slope, distance * normal + base + 0.01 * k * normal
        meshes += [as_mesh(*sheet), as_mesh(*sheet)]
    mesh = joined(*meshes)
    expected = all_pairs(*mesh)
    assert expected.shape[1] > 100
    assert np.array_equal(find_overlaps(*mesh).pairs, expected)


def test_search_finds_the_pairs_of_all_pairs_of_slivers_whose_planes_are_hardly_resolved(rng):
    """Far from a corner, such a plane may lie a thousand times farther off than the corner itself may."""
    frame, base = plane_frame(rng)
    normal = np.cross(*frame.T)
    meshes = []
    for height in rng.uniform(0.0, 1e-3, 150):
        length, width = rng.uniform(0.2, 1.0), rng.uniform(1e-3, 3e-3)
        sliver = np.array([[[0.0, length, 0.5 * length], [0.0, 0.0, width]]]) + rng.uniform(0.0, [[[0.8], [1e-3]]])
        meshes.append(as_mesh(sliver, frame, base + height * normal))
    mesh = joined(*meshes)
    expected = all_pairs(*mesh)
    assert expected.shape[1] > 100
    assert np.array_equal(find_overlaps(*mesh).pairs, expected)


def test_search_finds_the_pairs_of_all_pairs_in_a_plane_along_the_axes(rng):
    """Edges along the axes, where boxes of neighbours touch exactly."""
    flat = lattice_triangles(rng, 400)
    mesh = as_mesh(flat, np.eye(3)[:, :2], np.zeros(3))
    assert np.array_equal(find_overlaps(*mesh).pairs, all_pairs(*mesh))


def clipped_area(first, second):
    """The exact area that two triangles (2, 3) of whole numbers share, by Sutherland and Hodgman's clipping."""
    polygon, clip = ([tuple(map(Fraction, corner)) for corner in one.T.tolist()] for one in (first, second))

    def side(a, b, p):
        return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])

    if side(*clip) == 0:
        return 0.0
    if side(*clip) < 0:
        clip.reverse()
    for k in range(3):
        a, b, kept = clip[k], clip[(k + 1) % 3], []
        for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            here, there = side(a, b, p), side(a, b, q)
            if here >= 0:
                kept.append(p)
            if here * there < 0:
                kept.append(tuple(s + here / (here - there) * (t - s) for s, t in zip(p, q, strict=True)))
        polygon = kept
    turns = zip(polygon, polygon[1:] + polygon[:1], strict=True)
    return float(abs(sum(p[0] * q[1] - p[1] * q[0] for p, q in turns)) / 2)


@pytest.mark.parametrize("largest", [3, 40, 1000])
def test_area_of_two_triangles_is_that_of_their_clipped_polygon(rng, largest):
    """Also where they share edges and corners, are turned over, or have no area."""
    first, second = rng.integers(0, largest + 1, (2, 600, 2, 3))
    second[:50], second[50:100, :, :2] = first[:50, :, ::-1], first[50:100, :, 1:]
    expected = [clipped_area(*pair) for pair in zip(first, second, strict=True)]
    area = overlap_area(*(one.transpose(2, 1, 0).astype(float) for one in (first, second)))
    assert np.count_nonzero(expected) > 100
    assert area == pytest.approx(np.array(expected), rel=1e-9, abs=1e-12 * largest**2)
