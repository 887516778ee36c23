# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance from each light against closed forms and quadrature.

It is the mean of radiance cos / pdf. 16 replicates of 4096 random samples; each case is tested at level 1e-4.
"""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from etalon.lib.lights.build import light_sampler
from etalon.lib.scene.lights import AreaLight, Cone, Falloff, PointLight, SphereLight, SpotLight, SunLight
from scipy.integrate import dblquad, quad

RADIANCE = np.array([1.0, 2.0, 0.5])
DOWN = (0.0, 0.0, -1.0)


def unit(*v):
    return np.array(v) / np.linalg.norm(v)


@pytest.fixture
def irradiance(rng):
    """Replicates (16, 3) of the irradiance at `point` on a surface with `normal`."""

    def estimate(light, point=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0), count=4096):
        sampler = light_sampler(light, 10.0)
        points = np.ascontiguousarray(np.broadcast_to(np.reshape(point, (3, 1)), (3, count)))
        replicates = []
        for _ in range(16):
            sample = sampler.sample(points, *rng.random((2, count)))
            cosine = np.maximum(np.asarray(normal) @ sample.wi, 0.0)
            replicates.append((sample.radiance * cosine / sample.pdf).mean(axis=1))
        return replicates

    return estimate


def polygon_irradiance(corners, normal):
    """Lambert's formula for a polygon above the horizon, per unit radiance.

    It is seen from the origin; at 40 digits.
    """
    with mpmath.workdps(40):
        corners = [mpmath.matrix([mpmath.mpf(float(c)) for c in corner]) for corner in corners]
        total = mpmath.mpf(0)
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
            length = mpmath.sqrt(sum(c * c for c in cross))
            angle = mpmath.atan2(length, sum(x * y for x, y in zip(a, b, strict=True)))
            total += angle * sum(c * float(n) for c, n in zip(cross, normal, strict=True)) / length
        return abs(float(total)) / 2.0


@pytest.mark.parametrize(
    ("distance", "tilt"), [(2.0, 0.0), (1e6, 0.0), (0.500001, 0.0), (0.51, 0.0), (2.0, 0.7), (1e6, 0.7)]
)
def test_sphere(irradiance, assert_mean, distance, tilt):
    """Above the horizon a sphere of radius r gives pi L cos (r / d)^2, however near."""
    radius = 0.5
    normal = (math.sin(tilt), 0.0, math.cos(tilt))
    light = SphereLight("sphere", (0.0, 0.0, distance), radius, tuple(RADIANCE))
    exact = math.pi * RADIANCE * math.cos(tilt) * (radius / distance) ** 2
    assert_mean(irradiance(light, normal=normal), exact)


@pytest.mark.parametrize("distance", [0.0, 0.3, 0.4999999])
def test_sphere_from_inside(irradiance, assert_mean, distance):
    """All around: pi L."""
    light = SphereLight("sphere", (0.0, 0.0, distance), 0.5, tuple(RADIANCE))
    assert_mean(irradiance(light), math.pi * RADIANCE)


RECTANGLES = {
    "overhead": ((0.1, -0.2, 2.0), (1.0, 0.0, 0.0), (0.0, 1.5, 0.0)),
    "aside": ((3.0, 1.0, 0.4), (1.0, 0.0, 0.0), (0.0, 1.5, 0.0)),
    "near": ((0.1, -0.2, 0.01), (1.0, 0.0, 0.0), (0.0, 1.5, 0.0)),
    "grazing": ((1.0, 0.0, 1e-4), (0.5, 0.0, 0.0), (0.0, 0.5, 0.0)),
    "far": ((1e4, 2e4, 1e5), (1.0, 0.0, 0.0), (0.0, 1.5, 0.0)),
    "tiny": ((0.1, -0.2, 2.0), (1e-6, 0.0, 0.0), (0.0, 1e-6, 0.0)),
    "sheared": ((0.1, -0.2, 2.0), (1.0, 0.0, 0.0), (0.7, 1.5, 0.0)),
    "upright": ((0.2, 1.0, 1.5), (1.0, 0.0, 0.0), (0.0, 0.0, 2.0)),
}


@pytest.mark.parametrize("name", RECTANGLES)
def test_rectangle(irradiance, assert_mean, name):
    center, edge_u, edge_v = (np.array(v) for v in RECTANGLES[name])
    normal = np.cross(edge_u, edge_v)
    normal *= -np.sign(normal @ center) / np.linalg.norm(normal)
    light = AreaLight(
        "area", tuple(center), tuple(edge_u), tuple(edge_v), tuple(normal), "RECTANGLE", tuple(RADIANCE), math.pi
    )
    corners = [center + s * edge_u + t * edge_v for s, t in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    assert_mean(irradiance(light), RADIANCE * polygon_irradiance(corners, (0.0, 0.0, 1.0)))


def test_disk(irradiance, assert_mean):
    """Coaxial disk of radius r at height h: pi L r^2 / (r^2 + h^2)."""
    light = AreaLight(
        "disk", (0.0, 0.0, 2.0), (3.0, 0.0, 0.0), (0.0, 3.0, 0.0), DOWN, "ELLIPSE", tuple(RADIANCE), math.pi
    )
    assert_mean(irradiance(light), math.pi * RADIANCE * 2.25 / (2.25 + 4.0))


@pytest.mark.parametrize("spread", [1e-3, 0.02, 0.5, 2.5])
@pytest.mark.parametrize("shape", ["RECTANGLE", "ELLIPSE"])
def test_spread_keeps_the_flux(irradiance, assert_mean, shape, spread):
    """The rim of a wide light is out of the spread's reach.

    The irradiance is pi L, as from an infinite plane without spread.
    """
    light = AreaLight("area", (0.2, 0.1, 0.1), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), DOWN, shape, tuple(RADIANCE), spread)
    assert_mean(irradiance(light), math.pi * RADIANCE)


@pytest.mark.grid(3)
@pytest.mark.parametrize("edge_v", [(0.0, 0.8, 0.0), (0.5, 0.8, 0.0)], ids=["upright", "sheared"])
@pytest.mark.parametrize("spread", [1.2, math.pi])
@pytest.mark.parametrize("shape", ["RECTANGLE", "ELLIPSE"])
def test_area_by_quadrature(irradiance, assert_mean, shape, spread, edge_v):
    """Partly lit through its spread, tilted receiver, off axis."""
    light = AreaLight("area", (0.3, -0.2, 1.0), (1.5, 0.0, 0.0), edge_v, DOWN, shape, tuple(RADIANCE), spread)
    center, u, v = np.array(light.center), np.array(light.edge_u), np.array(light.edge_v)
    area = np.linalg.norm(np.cross(u, v))
    normal, tan_half = unit(0.2, 0.1, 1.0), math.tan(0.5 * spread)

    def integrand(s, t):
        place = center + s * u + t * v
        squared = place @ place
        tangent = math.hypot(place[0], place[1]) / place[2]
        falloff = max(tan_half - tangent, 0.0) / (tan_half - 0.5 * spread) if spread < math.pi else 1.0
        return falloff * (place @ normal) * place[2] / squared**2 * area

    def rim(t):
        return 0.5 if shape == "RECTANGLE" else math.sqrt(max(0.25 - t * t, 0.0))

    # The kink at the edge of the spread limits the quadrature; 1e-5 is far below the test's own error.
    exact = dblquad(lambda s, t: integrand(s, t), -0.5, 0.5, lambda t: -rim(t), rim, epsabs=1e-5)[0]
    assert_mean(irradiance(light, normal=normal), exact * RADIANCE)


def test_no_spread_is_a_parallel_beam(irradiance, assert_mean):
    light = AreaLight(
        "beam", (0.2, 0.1, 3.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), DOWN, "RECTANGLE", tuple(RADIANCE), 0.0
    )
    assert_mean(irradiance(light), math.pi * RADIANCE)
    assert_mean(irradiance(replace(light, center=(0.6, 0.0, 3.0))), 0.0 * RADIANCE)
    assert_mean(irradiance(replace(light, spread=1e-4)), math.pi * RADIANCE)


@pytest.mark.parametrize("half_angle", [0.0, 1e-9, 0.0046, 0.5])
def test_sun(irradiance, assert_mean, half_angle):
    """The irradiance on a facing plane, times the cosine.

    A cap above the horizon has pi sin^2 a cos.
    """
    toward = unit(0.3, 0.2, 1.0)
    light = SunLight("sun", tuple(toward), half_angle, tuple(RADIANCE))
    assert_mean(irradiance(light), RADIANCE * toward[2])


def smoothstep(x):
    x = min(max(x, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


def test_point(irradiance, assert_mean):
    place = np.array([1.0, 2.0, 3.0])
    exact = RADIANCE * 3.0 / np.linalg.norm(place) ** 3
    assert_mean(irradiance(PointLight("point", tuple(place), tuple(RADIANCE))), exact)


@pytest.mark.parametrize(("x_axis", "blend"), [((1.0, 0.0, 0.0), 0.5), ((1.0, 0.0, 0.0), 0.0), ((2.0, 0.0, 0.0), 0.9)])
def test_spot(irradiance, assert_mean, x_axis, blend):
    """Cosine of the ray, measured in the stretched frame."""
    light = SpotLight(
        "spot", (-0.5, 0.2, 2.0), 0.0, tuple(RADIANCE), Cone(DOWN, x_axis, (0.0, 1.0, 0.0), math.cos(0.7), blend)
    )
    ray = np.array([0.5 * x_axis[0], -0.2, 2.0])
    cosine = ray[2] / np.linalg.norm(ray)
    factor = (
        smoothstep((cosine - math.cos(0.7)) / ((1.0 - math.cos(0.7)) * blend))
        if blend
        else float(cosine > math.cos(0.7))
    )
    assert 0.0 < factor <= 1.0
    assert_mean(irradiance(light), factor * RADIANCE * 2.0 / (0.25 + 0.04 + 4.0) ** 1.5)


def test_spot_with_radius(irradiance, assert_mean):
    """On the axis, the integral over the cone that the sphere fills.

    Each ray is dimmed by its own angle.
    """
    half, blend, radius, distance = 0.3, 0.6, 0.5, 2.0
    cone = Cone(DOWN, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), math.cos(half), blend)
    light = SpotLight("spot", (0.0, 0.0, distance), radius, tuple(RADIANCE), cone)
    width = (1.0 - math.cos(half)) * blend

    def integrand(angle):
        return smoothstep((math.cos(angle) - math.cos(half)) / width) * math.cos(angle) * math.sin(angle)

    exact = 2.0 * math.pi * quad(integrand, 0.0, math.asin(radius / distance))[0]
    assert_mean(irradiance(light), exact * RADIANCE)


@pytest.mark.parametrize("power", [0, 1, 2])
@pytest.mark.parametrize("smooth", [0.0, 3.0])
def test_lights_that_fall_off_otherwise(irradiance, assert_mean, power, smooth):
    """A point 2 m above in closed form, and a rectangle there by quadrature."""
    falloff = Falloff(power, smooth)

    def factor(square):
        return square ** (power / 2) * square / (smooth + square)

    point = PointLight("p", (0.0, 0.0, 2.0), tuple(RADIANCE), falloff=falloff)
    np.testing.assert_allclose(irradiance(point)[0], RADIANCE / 4.0 * factor(4.0), rtol=1e-12)
    edges = (3.0, 0.0, 0.0), (0.0, -1.0, 0.0)
    area = AreaLight("a", (0.5, 0.0, 2.0), *edges, DOWN, "RECTANGLE", tuple(RADIANCE), math.pi, falloff=falloff)

    def arriving(y, x):
        square = x * x + y * y + 4.0
        return factor(square) * 4.0 / square**2

    assert_mean(irradiance(area), RADIANCE * dblquad(arriving, -1.0, 2.0, -0.5, 0.5)[0])


def test_a_light_that_falls_off_otherwise_looks_as_bright_as_its_samples():
    light = AreaLight("a", (0, 0, 2), (3, 0, 0), (0, -1, 0), DOWN, "RECTANGLE", (1, 2, 3), math.pi, falloff=Falloff(1))
    origin, direction = np.array([[0.0, 5.0]] * 1 + [[0.0, 0.0]] * 2), np.array([[0.6] * 2, [0.0] * 2, [0.8] * 2])
    distance, radiance = light_sampler(light, 1.0).intersect(origin, direction)
    assert distance.tolist() == [2.5, np.inf]
    np.testing.assert_allclose(radiance[:, 0], [2.5, 5.0, 7.5])
    assert not radiance[:, 1].any()
