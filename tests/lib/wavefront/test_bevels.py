# SPDX-License-Identifier: GPL-3.0-or-later
"""Bevel nodes near the edge of a box, against quadrature of what their probes meet."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.sampling.cycles_pattern import cycles_pairs
from etalon.lib.scene.expressions import ONE, ZERO, Bevel, Bump, ColorToValue, Constant
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.materials import Diffuse, Emission, Glossy, Subsurface, Transparent
from etalon.lib.settings.reference import Options
from etalon.lib.surfaces.surface import SurfacePoints, SurfaceTables
from etalon.lib.wavefront.bevels import LEAST_PDF, Bevels
from etalon.lib.wavefront.casters import Casters
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.chi2 import sidak
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import cube, diffuse, floor, icosphere, material, orthographic, quad, scene
from scipy import integrate, stats

RADIUS, COUNT, LEVEL = 0.4, 40000, 1e-4
UP = np.array([0.0, 0.0, 1.0])
BOX = (cube(),)


def beveled(*parts):
    made = scene(parts, [material(Diffuse(normal=Bevel(ONE))), diffuse(0.5)], orthographic(1, 1, 1e-3, (0, 0, 9.0)))
    tables, casters = SurfaceTables(made.mesh), Casters(made.mesh, np.zeros(3))
    return Bevels(made, tables, casters), tables, casters


def points_at(tables, casters, place, count=COUNT, wo=UP):
    """So many points at one place, found by rays from above."""
    origin, down = np.tile(np.array([[*place[:2], 9.0]]).T, count), np.tile(-UP[:, None], count)
    hits = casters.whole.closest(origin, down)
    position, ng, _ = casters.whole.on_plane(hits.triangle, origin + down * hits.distance)
    return SurfacePoints(tables, hits.triangle, hits.u, hits.v, position, ng, np.tile(wo[:, None], count))


def places(seed):
    """Places in Cycles' sequence."""
    return np.random.default_rng(seed).random(COUNT)


def means(place, seed, samples=None, wo=UP, parts=BOX):
    """Means of summed (no `samples` given: of 4 probes, by one) or of averaged normals, and their standard errors."""
    bevels, tables, casters = beveled(*parts)
    points = points_at(tables, casters, place, wo=wo)
    radius = np.full(COUNT, RADIUS)
    if samples is None:
        normals = bevels.summed_normal(points, places(seed), radius, 4) / 4.0
    else:
        chance = np.stack([places(seed), np.full(COUNT, 9.0)])
        normals = bevels.averaged_normal(points, chance, radius, samples)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=0), 1.0)
    return normals.mean(axis=1), normals.std(axis=1, ddof=1) / np.sqrt(COUNT)


def assert_near(found, exact):
    mean, error = found
    allowed = stats.norm.ppf(1.0 - 0.5 * sidak(LEVEL, 3)) * error + 1e-6
    assert np.all(np.abs(mean - exact) <= allowed), (mean, exact, error)
    assert error.max() < 0.01


def density(x):
    """Of distances in a disk, by the radius."""
    return 20.0 * x * (1.0 - x) ** 3


def integrated(d):
    """The integral of the normals by the profile at distance d from an edge along y, beyond which z falls: x and z."""
    d = d / RADIUS
    top = integrate.quad(lambda x: density(x) * (1.0 - np.arccos(min(d / x, 1.0)) / np.pi), 0.0, 1.0, points=[d])[0]
    side = integrate.quad(lambda rho: 10.0 * rho * (1.0 - np.hypot(d, rho)) ** 3, 0.0, np.sqrt(1.0 - d * d))[0]
    return np.array([side, 0.0, top])


@pytest.mark.grid(3)
@pytest.mark.parametrize("d", [0.02, 0.1, 0.3])
def test_the_sum_has_the_mean_of_the_integral(d, seed):
    assert_near(means((1.0 - d, 0.05), seed), integrated(d))


def averaged(d, samples, count=200000):
    """The mean unit vector at distance d from the edge, of probes through the edge of two half planes.

    The axes are z, (1, -1, 0) and (1, 1, 0). The first meets the top with a weight of 2, the others the side with 2 sqrt(2)
    times the profile's ratio. Uniforms are those of Cycles' sequence; the geometry has no triangles.
    """
    begin = np.arange(count, dtype=np.uint32) * np.uint32(samples * (2**32 // samples // count))
    u, v = cycles_pairs(begin + np.arange(samples, dtype=np.uint32)[:, None], 21)
    x = np.linspace(0.0, 1.0, 200001)
    off = np.interp(v, 10.0 * x**2 - 20.0 * x**3 + 15.0 * x**4 - 4.0 * x**5, x) * RADIUS
    up, along = u < 0.5, u < 0.75
    angle = 2.0 * np.pi * np.where(up, 2.0 * u, np.where(along, 4.0 * u - 2.0, 4.0 * u - 3.0))
    cos, sin = off * np.cos(angle), off * np.sin(angle)
    top = 2.0 * (up & ((cos + sin) / np.sqrt(2.0) < d))
    # The line of a level probe is at the height z and at w across its axis; it meets x = d at s along the axis.
    z, w = np.where(along, cos, sin), np.where(along, sin, cos)
    s = np.sqrt(2.0) * d - w
    distance = np.sqrt(d * d + z * z + (s - w) ** 2 / 2.0)
    meets = ~up & (z < 0.0) & (s * s <= RADIUS**2 - off * off)
    ratio = np.where(meets, np.maximum(RADIUS - distance, 0.0) ** 3 / (RADIUS - off) ** 3, 0.0)
    total = np.stack([2.0 * np.sqrt(2.0) * ratio.sum(axis=0), np.zeros(count), top.sum(axis=0)])
    total[2] += ~total.any(axis=0)
    return (total / np.linalg.norm(total, axis=0)).mean(axis=1)


@pytest.mark.grid(3)
@pytest.mark.parametrize("d", [0.02, 0.1, 0.3])
def test_one_probe_meets_the_side_as_often_as_quadrature_says(d, seed):
    """Half of the probes are level; those that start below the top meet the side where their line crosses it in the ball."""
    x, angle = (np.arange(4000) + 0.5) / 4000, 2.0 * np.pi * (np.arange(4000) + 0.5)[:, None] / 4000
    z, w = RADIUS * x * np.sin(angle), RADIUS * x * np.cos(angle)
    meets = (z < 0.0) & ((np.sqrt(2.0) * d - w) ** 2 <= RADIUS**2 * (1.0 - x * x))
    chance = 0.5 * (meets * density(x)).mean()
    assert_near(means((1.0 - d, 0.05), seed, samples=1), np.array([chance, 0.0, 1.0 - chance]))


@pytest.mark.grid(3)
@pytest.mark.parametrize("samples", [2, 3, 4])
@pytest.mark.parametrize("d", [0.02, 0.1, 0.3])
def test_a_few_probes_have_the_mean_of_the_same_probes_without_triangles(d, samples, seed):
    assert_near(means((1.0 - d, 0.05), seed, samples), averaged(d, samples))


def test_from_inside_the_normal_points_inwards(seed):
    """The first of two probes goes along z, and finds the edge as often as from outside."""
    mean, error = means((0.9, 0.05), seed, None, -UP)
    assert_near((mean, error), integrated(0.1))
    assert means((0.9, 0.05), seed, 4, -UP)[0][2] < -0.8


@pytest.mark.slow
def test_the_mean_of_unit_vectors_depends_on_the_number_of_probes(seed):
    """It is no more than the mean of a few, so that the number must be Cycles'."""
    two, many = (means((0.9, 0.05), seed, samples)[0] for samples in (2, 32))
    assert np.abs(two - many).max() > 0.03
    exact = integrated(0.1)
    np.testing.assert_allclose(many, exact / np.linalg.norm(exact), atol=0.02)


def test_edges_that_a_quarter_turn_maps_to_each_other_have_turned_means(seed):
    """By one probe: what several have in common is not the same for all axes."""
    mean, error = means((0.85, 0.0), seed, 1)
    for k, place in enumerate([(0.0, 0.85), (-0.85, 0.0), (0.0, -0.85)]):
        turned, other = means(place, seed + k + 1, 1)
        for _ in range(k + 1):
            turned, other = np.array([turned[1], -turned[0], turned[2]]), other[[1, 0, 2]]
        assert_near((turned, np.hypot(error, other)), mean)


@pytest.mark.parametrize("samples", [1, 2, 5])
def test_far_from_an_edge_it_is_the_shading_normal(samples):
    for part in (cube(), floor(1.0, 1.0)):
        bevels, tables, casters = beveled(part)
        points = points_at(tables, casters, (0.3, 0.2), 500)
        chance = np.stack([places(1)[:500], np.full(500, np.inf)])
        found = bevels.averaged_normal(points, chance, np.full(500, 0.5), samples)
        np.testing.assert_allclose(found, np.tile(UP[:, None], 500), atol=1e-12)


def test_no_radius_and_wide_reflections_leave_the_shading_normal():
    bevels, tables, casters = beveled(icosphere(smooth=True))
    points = points_at(tables, casters, (0.3, 0.2), 100)
    for radius, least in ((0.0, np.inf), (-0.1, np.inf), (0.5, 0.999 * LEAST_PDF)):
        chance = np.stack([places(1)[:100], np.full(100, least)])
        np.testing.assert_array_equal(bevels.averaged_normal(points, chance, np.full(100, radius), 4), points.n)


def test_only_the_objects_own_faces_count(seed):
    """A wall near the point belongs to another object."""
    alone = means((0.2, 0.0), seed, 2)
    wall = quad((0.25, -1.0, 1.0), (0.0, 2.0, 0.0), (0.0, 0.0, 1.0), 1)
    np.testing.assert_array_equal(means((0.2, 0.0), seed, 2, parts=(cube(), wall))[0], alone[0])


def shown(d, seed, bevel, samples=2):
    """A box from above at distance d from an edge, below a sun that both faces see."""
    sun = SunLight("sun", (0.6, 0.0, 0.8), 0.0, (np.pi,) * 3)
    camera = orthographic(1, 1, 1e-3, (1.0 - d, 0.05, 9.0))
    normal = Bevel(Constant(RADIUS), samples) if bevel else None
    made = scene(cube(), material(Diffuse(normal=normal)), camera, [sun])
    return replicates(made, 16, 1024, seed=seed)


@pytest.mark.grid(2)
@pytest.mark.parametrize("d", [0.05, 0.2])
def test_a_matt_box_is_as_bright_as_the_mean_normal_says(d, seed):
    exact = averaged(d, 2) @ [0.6, 0.0, 0.8]
    assert abs(exact - 0.8) > 0.015
    assert_mean(shown(d, seed, True), exact, 0.01, 1e-5)
    assert_mean(shown(d, seed, False), 0.8, 0.01, 1e-5)


BEVEL = Bevel(ONE)


@pytest.mark.parametrize(
    ("closure", "where"),
    [
        (Emission(BEVEL), "its emission"),
        (Transparent(BEVEL), "what lets light straight through"),
        (Subsurface(normal=BEVEL), "its subsurface scattering"),
        (Diffuse(normal=Bump(ColorToValue(BEVEL), ONE, ONE)), "the height of a bump"),
        (Diffuse(BEVEL), None),
        (Glossy("GGX", normal=Bump(ZERO, ONE, ONE, BEVEL)), None),
    ],
)
def test_what_cycles_evaluates_without_probes_is_refused(closure, where):
    made = scene(cube(), material(closure), orthographic(1, 1, 1.0, (0.0, 0.0, 9.0)))
    if where is None:
        ReferenceRenderer(made, Options(threads=1)).render(0, 2)
    else:
        with pytest.raises(Refused, match=f"a Bevel node in {where} is not simulated"):
            ReferenceRenderer(made, Options(threads=1))


def test_other_strategies_and_light_tracing_refuse_it():
    made = scene(cube(), material(Diffuse(normal=BEVEL)), orthographic(1, 1, 1.0, (0.0, 0.0, 9.0)))
    with pytest.raises(Refused, match="a Bevel node with the strategy d_cos is not simulated"):
        ReferenceRenderer(made, Options(threads=1, strategy="d_cos"))
    lit = replace(made, lights=(SunLight("sun", (0.0, 0.0, 1.0), 0.0, (1.0,) * 3),))
    with pytest.raises(EtalonError, match="bevels by light tracing"):
        LightTracingRenderer(lit, Options(threads=1))
