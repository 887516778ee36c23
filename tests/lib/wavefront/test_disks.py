# SPDX-License-Identifier: GPL-3.0-or-later
"""Christensen and Burley's subsurface scattering: what leaves about a point, against quadrature of the profile."""

import numpy as np
import pytest
from etalon.lib.scattering.profiles import burley_density
from etalon.lib.scattering.subsurface import BY_DISK
from etalon.lib.scene.materials import Subsurface
from etalon.lib.surfaces.surface import SurfacePoints, SurfaceTables
from etalon.lib.wavefront.casters import Casters
from etalon.lib.wavefront.disks import Disks, leave_by_disk
from etalon.lib.wavefront.probes import Probes
from etalon.tests.chi2 import sidak
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import Part, color, cube, floor, material, mesh, orthographic, scene
from scipy import integrate, stats

COLORS, RADII = (0.9, 0.5, 0.2), (0.3, 0.15, 0.06)
COUNT, LEVEL, SPREAD = 100000, 1e-4, 0.05
UP = np.array([0.0, 0.0, 1.0])


def wax(radii=RADII):
    return material(Subsurface(color(*COLORS), color(*radii), mapping=BY_DISK))


def on_sheet(spread, d):
    """The share of the profile that lies on a sheet, at distance d from its straight edge."""

    def inside(r):
        return burley_density(np.float64(spread), r) * (1.0 - np.arccos(min(d / r, 1.0)) / np.pi if r > 0.0 else 1.0)

    return integrate.quad(inside, 0.0, 16.0 * spread, points=[d] if d < 16.0 * spread else None, limit=200)[0]


def view(x):
    return orthographic(1, 1, 1e-3, (x, 0.03, 5.0))


def test_a_wide_plane_in_a_furnace_has_its_colour(seed):
    """Nothing is lost, however far the channels spread."""
    images = replicates(scene(floor(10.0), wax(), view(0.1), world=1.0), 16, 1024, seed=seed)
    assert_mean(images, COLORS, 0.02, 1e-5)


@pytest.mark.grid(3)
@pytest.mark.parametrize("d", [0.004, 0.02, 0.1])
def test_beyond_the_edge_of_a_sheet_light_is_lost(d, seed):
    images = replicates(scene(floor(1.0), wax(), view(1.0 - d), world=1.0), 16, 1024, seed=seed)
    shares = np.array([on_sheet(radius / (4.0 * np.pi), d) for radius in RADII])
    assert shares.max() - shares.min() > 0.03
    assert_mean(images, np.array(COLORS) * shares, 0.02, 1e-5)


def left(part, place, seed, wo=UP, spread=SPREAD):
    """Exits of the light of one point, of a throughput of 1, and their probes' count."""
    made = mesh(part)
    tables, casters = SurfaceTables(made), Casters(made, np.zeros(3))
    origin, down = np.tile(np.array([[*place, 9.0]]).T, COUNT), np.tile(-UP[:, None], COUNT)
    hits = casters.whole.closest(origin, down)
    position, ng, _ = casters.whole.on_plane(hits.triangle, origin + down * hits.distance)
    points = SurfacePoints(tables, hits.triangle, hits.u, hits.v, position, ng, np.tile(wo[:, None], COUNT))
    disks = Disks(np.arange(COUNT), np.full((3, COUNT), spread), np.ones((3, COUNT)))
    uniforms = np.random.default_rng(seed).random((3, COUNT))
    return leave_by_disk(Probes(made.object_index, casters, [0]), points, disks, *uniforms)


def assert_sum(exits, there, exact):
    light = np.bincount(exits.index, exits.throughput[0] * there, COUNT)
    error = light.std(ddof=1) / np.sqrt(COUNT)
    assert abs(light.mean() - exact) <= stats.norm.ppf(1.0 - 0.5 * sidak(LEVEL, 2)) * error + 1e-6
    assert error < 0.02 * exact


@pytest.mark.parametrize("d", [0.02, 0.1])
def test_at_the_edge_of_a_box_both_faces_get_what_their_probes_weigh(d, seed):
    """The side is met along (1, 1, 0) and (1, -1, 0), each by half of the weight, over the distance across the axis."""
    exits = left(cube(), (1.0 - d, 0.03), seed)
    side = exits.position[0] > 1.0 - 1e-6
    top = exits.position[2] > 1.0 - 1e-6
    assert (side | top).all()
    assert_sum(exits, top, on_sheet(SPREAD, d))

    node, weight = np.polynomial.legendre.leggauss(400)
    rho, angle = 8.0 * SPREAD * (1.0 + node)[:, None], 0.5 * np.pi * (1.0 + node)
    along, fall = np.sqrt(2.0) * rho * np.cos(angle) - d, rho * np.sin(angle)
    met = burley_density(np.float64(SPREAD), np.sqrt(d * d + along * along + fall * fall))
    total = 8.0 * SPREAD * 0.5 * np.pi * (weight[:, None] * weight * met).sum()
    assert_sum(exits, side, total / (np.sqrt(2.0) * np.pi))


@pytest.mark.parametrize("wo", [UP, -UP], ids=["from outside", "from inside"])
def test_one_of_the_sheets_that_a_probe_meets_is_chosen_without_bias(wo, seed):
    """A slab of thickness t: below, the density is that of the distance, and over the distance in the plane."""
    thick = 0.06
    box = cube()
    slab = Part(box.vertices * np.array([[4.0], [4.0], [0.5 * thick]]), box.triangles)
    exits = left(slab, (0.1, 0.03), seed, wo)
    below = exits.position[2] < 0.0
    assert_sum(exits, ~below, 1.0)
    exact = integrate.quad(lambda r: burley_density(np.float64(SPREAD), np.hypot(r, thick)), 0.0, 16.0 * SPREAD)[0]
    assert_sum(exits, below, exact)
    np.testing.assert_allclose(exits.direction[2], np.where(below, -wo[2], wo[2]), atol=1e-6)


def test_channels_without_a_radius_reflect_where_they_arrive(seed):
    images = replicates(scene(floor(1.0), wax((0.3, 0.0, 0.06)), view(0.99), world=1.0), 16, 512, seed=seed)
    assert_mean(images[..., 1], COLORS[1], 0.02, 1e-3)
    assert images[..., 0].mean() < 0.8 * COLORS[0]
