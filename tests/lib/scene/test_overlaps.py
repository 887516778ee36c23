# SPDX-License-Identifier: GPL-3.0-or-later
"""Overlapping faces are found with their area, for any triangles in one plane.

Nothing else is found.
"""

import numpy as np
import pytest
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
