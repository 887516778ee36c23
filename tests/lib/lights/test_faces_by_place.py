# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive faces that are chosen by place.

Chances are those with which they choose, and the light of panels above a floor is Lambert's formula for polygons.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.plan import make_plan
from etalon.lib.lights.by_place import PartChances
from etalon.lib.lights.cells import Cells
from etalon.lib.lights.face_groups import cut_faces, divide_faces, group_pieces, make_pieces
from etalon.lib.lights.triangles import EmissiveTriangles, _ByPlace
from etalon.lib.scene.materials import Diffuse
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.emissive import EmissiveMesh, places_on
from etalon.lib.wavefront.kernel import Kernel
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.replicates import assert_mean, assert_same, blocks, replicates
from etalon.tests.scenes import color, cube, emission, floor, material, mesh, perspective, quad, scene
from scipy.stats import chi2

ALBEDO = (0.8, 0.5, 0.3)
CORNERS = [
    np.array([[3.0 * k, 0.0, 1.5], [3.0 * k, 0.9, 1.5], [3.0 * k + 0.7, 0.9, 1.5], [3.0 * k + 0.7, 0.0, 1.5]])
    for k in range(12)
]
RADIANCE = [(4.0 + k, 5.0, 9.0 - 0.5 * k) for k in range(12)]


def irradiance(corners, point, normal):
    """Irradiance at a point that sees the whole polygon (k, 3) of radiance 1 (Lambert 1760)."""
    to = corners - point
    to = to / np.linalg.norm(to, axis=1)[:, None]
    after = np.roll(to, -1, axis=0)
    across = np.cross(to, after)
    angle = np.arctan2(np.linalg.norm(across, axis=1), (to * after).sum(axis=1))
    across /= np.linalg.norm(across, axis=1)[:, None]
    return abs(0.5 * (angle[:, None] * across).sum(axis=0) @ normal)


def corners_of(quads):
    """Corners (3, 3, t) of two triangles for each of the quads."""
    return np.array([[one[0], one[k], one[k + 1]] for one in quads for k in (1, 2)]).transpose(1, 2, 0)


class Placed:
    """Quads as one light, chosen by place; `areas` (p,) and barycentric `weights` of a place on each of its pieces."""

    def __init__(self, quads, radiance, most=12):
        corners = corners_of(quads)
        power = np.repeat([sum(one) for one in radiance], 2)
        divided = divide_faces(corners, power * _areas(corners), most)
        self.cells = Cells(divided.groups.parts.center, np.array([[-50.0, -50.0, 0.0], [50.0, 50.0, 3.0]]), 1)
        chances = PartChances(divided.groups.parts.power, self.cells.expect(divided.groups.parts))
        turned = divided.strips.turned(corners)
        edges = turned[1] - turned[0], turned[2] - turned[0]
        self.light = EmissiveTriangles(turned[0], *edges, np.arange(power.size), divided.power, divided.strips)
        self.light.choose_by_place(divided.pieces, divided.groups, chances)
        self.pieces, self.strips = divided.pieces, divided.strips
        self.areas = _areas(corners)[self.pieces.face] * self.pieces.share
        far = (1 + self.strips.turn[self.pieces.face]) % 3
        root = np.sqrt(self.pieces.before + 0.5 * self.pieces.share)
        self.weights = tuple(np.where(far == k, 1.0 - root, 0.5 * root) for k in (1, 2))

    def densities(self, cell):
        """Densities per square metre on the pieces, in a cell."""
        one = np.ones(self.pieces.face.size)
        return self.light.pdf_of_hit(self.pieces.face, one, one, np.full(one.size, cell), self.weights)

    def piece(self, which, b1, b2):
        """The pieces that have places on triangles."""
        far = np.choose((1 + self.strips.turn[which]) % 3, [1.0 - b1 - b2, b1, b2])
        count = self.strips.count
        return (np.cumsum(count) - count)[which] + np.minimum((1.0 - far) * count[which], count[which] - 1).astype(int)


def _areas(corners):
    return 0.5 * np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0], axis=0), axis=0)


TUBE = [np.array([[-1.0, 0.1, 2.0], [36.0, 0.1, 2.0], [36.0, 0.2, 2.0], [-1.0, 0.2, 2.0]])]
LIGHTS = {
    "panels": (CORNERS, RADIANCE),
    "tube": (TUBE, [(5.0, 4.0, 3.0)]),
    "turned": ([TUBE[0][[1, 2, 3, 0]]], [(5.0, 4.0, 3.0)]),
}


@pytest.fixture(params=LIGHTS)
def placed(request):
    return Placed(*LIGHTS[request.param])


def panels(camera):
    """The panels above a floor."""
    quads = [quad(one[0], one[1] - one[0], one[3] - one[0], k + 1) for k, one in enumerate(CORNERS)]
    materials = [material(Diffuse(color(*ALBEDO))), *(emission(*one) for one in RADIANCE)]
    return scene([floor(60.0), *quads], materials, camera, bounces=1)


def above(x):
    """A camera of one pixel that sees a spot of some millimetres at (x, -1, 0), past the panels."""
    return perspective(1, 1, 0.0005, (x, -1.0, 5.0), (0.0, 0.0, -1.0))


def reflected(x):
    """The light that the floor at (x, -1, 0) reflects."""
    point, up = np.array([x, -1.0, 0.0]), np.array([0.0, 0.0, 1.0])
    total = sum(np.array(light) * irradiance(one, point, up) for one, light in zip(CORNERS, RADIANCE, strict=True))
    return np.array(ALBEDO) / np.pi * total


def test_groups_hold_each_piece_once_and_their_balls_hold_the_pieces(rng):
    corners = rng.normal(size=(1, 3, 500)) + 0.1 * rng.normal(size=(3, 3, 500))
    power = np.where(rng.random(500) < 0.2, 0.0, rng.random(500))
    pieces = make_pieces(corners, cut_faces(corners))
    power = power[pieces.face] * pieces.share
    groups = group_pieces(pieces, power, 40)
    np.testing.assert_array_equal(np.sort(groups.order), np.flatnonzero(power))
    assert groups.first.size == 41
    for k in range(40):
        inside = groups.order[groups.first[k] : groups.first[k + 1]]
        for end in (pieces.low, pieces.high):
            away = np.linalg.norm(end[:, inside] - groups.parts.center[:, k, None], axis=0)
            assert away.max() <= groups.parts.radius[k] * (1.0 + 1e-12)
        np.testing.assert_allclose(groups.parts.power[k], power[inside].sum(), rtol=1e-12)


def test_faces_in_one_place_are_divided_too():
    groups = divide_faces(1e-9 * np.eye(3)[:, :, None] + np.zeros(9), np.ones(9), 4).groups
    assert groups.first.size == 5


def test_faces_without_power_have_no_groups():
    assert divide_faces(corners_of(CORNERS), np.zeros(24), 4).groups.parts.power.size == 0


def test_long_faces_are_cut_across_their_length():
    corners = corners_of(TUBE)
    divided = divide_faces(corners, np.ones(2), 64)
    assert divided.strips.count.min() >= 48
    assert (divided.pieces.high - divided.pieces.low)[0].max() < 0.8
    np.testing.assert_allclose(np.bincount(divided.pieces.face, divided.pieces.share), 1.0, rtol=1e-12)


def test_density_of_each_cell_integrates_to_one(placed):
    for cell in range(0, placed.cells.everywhere + 1, 97):
        np.testing.assert_allclose(placed.densities(cell) @ placed.areas, 1.0, rtol=1e-12)
    np.testing.assert_allclose(placed.densities(placed.cells.everywhere) @ placed.areas, 1.0, rtol=1e-12)


def test_pieces_are_chosen_with_the_density_of_the_cell(placed, rng):
    count = 100_000
    for x in (0.0, 17.0, 80.0):
        cell = placed.cells.number(np.array([[x], [0.3], [0.0]]))
        which, b1, b2, _ = placed.light.place(*rng.random((2, count)), np.repeat(cell, count))
        expected = count * placed.densities(cell[0]) * placed.areas
        found = np.bincount(placed.piece(which, b1, b2), minlength=expected.size)
        few = expected < 8.0
        pairs = [(found[~few], expected[~few]), (found[few].sum()[None], expected[few].sum()[None])]
        found, expected = (np.concatenate(one) for one in zip(*pairs, strict=True))
        known = expected > 0.0
        assert not found[~known].any()
        statistic = (np.square(found - expected)[known] / expected[known]).sum()
        assert chi2.sf(statistic, known.sum() - 1) > 1e-4


def test_samples_lie_where_their_weights_say(placed, rng, request):
    corners = corners_of(LIGHTS[request.node.callspec.params["placed"]][0])
    points = np.tile([[9.0], [0.3], [0.0]], 1000)
    cell = placed.cells.number(points)
    sample = placed.light.sample(points, *rng.random((2, 1000)), cell)
    weights = np.stack([1.0 - sample.b1 - sample.b2, sample.b1, sample.b2])
    place = (corners[:, :, sample.triangle] * weights[:, None]).sum(axis=0)
    np.testing.assert_allclose(points + sample.distance * sample.wi, place, atol=1e-12)
    again = placed.light.pdf_of_hit(sample.triangle, sample.distance, sample.facing, cell, (sample.b1, sample.b2))
    np.testing.assert_array_equal(sample.pdf, again)


@pytest.mark.parametrize("x", [0.0, 16.0, 40.0])
def test_samples_bring_lamberts_irradiance(placed, x, rng, assert_mean, request):
    quads = LIGHTS[request.node.callspec.params["placed"]][0]
    points = np.ascontiguousarray(np.broadcast_to([[x], [-1.0], [0.0]], (3, 4096)))
    values = []
    for _ in range(16):
        sample = placed.light.sample(points, *rng.random((2, 4096)), placed.cells.number(points))
        values.append((sample.wi[2] / sample.pdf).mean())
    assert_mean(values, sum(irradiance(one, points[:, 0], np.array([0.0, 0.0, 1.0])) for one in quads))


@pytest.mark.grid(2)
@pytest.mark.parametrize("direct", ["mis", "lights"])
@pytest.mark.parametrize("x", [0.0, 10.4, 33.0])
def test_floor_under_panels_is_lamberts_formula(x, direct):
    images = replicates(panels(above(x)), 16, 1024, direct=direct)
    assert_mean(images, reflected(x), precision=0.01, rounding=1e-3)


@pytest.mark.grid(2)
@pytest.mark.parametrize("direct", ["mis", "lights"])
def test_floor_under_a_tube_of_two_faces_is_lamberts_formula(direct):
    one = TUBE[0]
    built = panels(above(10.4))
    built = scene(
        [floor(60.0), quad(one[0], one[1] - one[0], one[3] - one[0], 1)], built.materials, above(10.4), bounces=1
    )
    exact = (
        np.array(ALBEDO) / np.pi * RADIANCE[0] * irradiance(one, np.array([10.4, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    )
    assert_mean(replicates(built, 16, 1024, direct=direct), exact, precision=0.01, rounding=1e-3)


def test_near_panels_are_chosen_more_often():
    built = panels(above(0.0))
    kernel = Kernel(built, make_plan(built), Options())
    cell = kernel.selection.cells(np.array([[0.0], [-1.0], [0.0]]))
    assert not kernel.selects
    middle = np.full(24, 1.0 / 3.0), np.full(24, 1.0 / 3.0)
    density = kernel.emissive[0].pdf_of_hit(np.arange(2, 26), np.ones(24), np.ones(24), np.repeat(cell, 24), middle)
    by_power = kernel.emissive[0].pdf_of_hit(np.arange(2, 26), np.ones(24), np.ones(24))
    assert (density / by_power)[:2].min() > 5.0
    assert (density / by_power)[8:].max() < 0.5


@pytest.mark.slow
def test_strategies_agree_where_faces_are_chosen_by_place():
    quads = [quad(one[0], one[1] - one[0], one[3] - one[0], 1) for one in CORNERS]
    wall = quad((13.0, -2.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 3.0), 0)
    camera = perspective(8, 8, 1.2, (13.5, -6.0, 4.0), (0.4, 1.0, -0.6))
    materials = [material(Diffuse(color(*ALBEDO))), emission(9.0, 6.0, 4.0)]
    built = scene([floor(30.0), wall, *quads], materials, camera, bounces=3)
    images = [blocks(replicates(built, 16, 512, direct=direct), 4) for direct in ("mis", "lights", "bsdf")]
    assert_same(images[0], images[1], precision=0.05)
    assert_same(images[0], images[2], precision=0.15)


SHEET = quad((-0.1, -0.1, 2.0), (0.2, 0.0, 0.0), (0.0, 0.2, 0.0), 1)


@pytest.mark.parametrize(("lamp", "by_place"), [(SHEET, False), (cube(0.1, (0.0, 0.0, 2.0), 1), True)])
def test_faces_of_a_small_lamp_are_chosen_by_place_where_they_hide_each_other(lamp, by_place):
    camera = perspective(1, 1, 0.1, (0.0, -3.0, 1.0), (0.0, 1.0, -0.3))
    built = scene([floor(5.0), lamp], [material(Diffuse(color(*ALBEDO))), emission(9.0)], camera)
    assert (Kernel(built, make_plan(built), Options()).selection.grid is not None) is by_place


def test_places_are_spread_over_the_area():
    """Three quarters of the area are in one of two floors; its middle is that of its places."""
    floors = mesh(floor(3.0), quad((10.0, 0.0, 1.0), (4.0, 0.0, 0.0), (0.0, 3.0, 0.0)), floor(90.0))
    found, normal = places_on(floors, np.arange(4))
    np.testing.assert_allclose(normal[2], 1.0, rtol=1e-12)
    on_floor = found[:, found[2] == 0.0]
    assert on_floor.shape[1] == 768
    np.testing.assert_allclose(on_floor.mean(axis=1), 0.0, atol=0.1)
    np.testing.assert_allclose(on_floor.std(axis=1)[:2], 6.0 / np.sqrt(12.0), rtol=0.05)


def test_a_density_that_forgets_the_place_is_caught(monkeypatch):
    """The planted error."""
    monkeypatch.setattr(_ByPlace, "over_power", lambda self, triangle, cell, b1, b2: np.ones(cell.shape))
    with pytest.raises(AssertionError, match="difference"):
        test_floor_under_panels_is_lamberts_formula(10.4, "mis")


def test_a_ray_that_meets_a_face_by_another_density_is_caught(monkeypatch):
    """The planted error: rays that lobes choose are weighed as if faces were chosen by power."""
    by_power = EmissiveMesh.pdf_of_hit
    monkeypatch.setattr(EmissiveMesh, "pdf_of_hit", lambda self, *hit: by_power(self, *hit[:3]))
    with pytest.raises(AssertionError, match="difference"):
        test_floor_under_panels_is_lamberts_formula(10.4, "mis")


def test_kernels_of_the_same_lights_share_one_grid():
    built = panels(perspective(4, 4, 0.3, (10.0, -2.0, 5.0), (0.0, 0.0, -1.0)))
    whole = ReferenceRenderer(built, Options(threads=1))
    for other in (whole.at_size(2, 2), whole.under(Options(threads=1, direct="lights"))):
        assert other.kernel is not whole.kernel
        assert other.kernel.selection.grid is whole.kernel.selection.grid
    anew = ReferenceRenderer(whole.at_size(2, 2).scene, Options(threads=1)).render(0, 4).radiance
    np.testing.assert_array_equal(whole.at_size(2, 2).render(0, 4).radiance, anew)


def test_another_light_has_a_grid_of_its_own():
    first = panels(above(0.0))
    materials = (*first.materials[:-1], emission(99.0))
    whole = ReferenceRenderer(first, Options(threads=1))
    other = ReferenceRenderer(replace(first, materials=materials), Options(threads=1), like=whole.kernel)
    assert other.kernel.selection.grid is not whole.kernel.selection.grid
