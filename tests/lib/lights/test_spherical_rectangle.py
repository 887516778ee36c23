# SPDX-License-Identifier: GPL-3.0-or-later
"""Solid angles of rectangles to the last bits (hard case 15), against mpmath at 60 digits."""

import mpmath
import numpy as np
import pytest
from etalon.lib.lights.spherical_rectangle import SphericalRectangle

SIGN = np.array([-1.0, 1.0])


def corner(x, y, height):
    """Signed solid angle of the rectangle between the foot and (x, y)."""
    return mpmath.atan2(x * y, height * mpmath.sqrt(x * x + y * y + height * height))


def exact(x0, x1, y0, y1, height):
    x0, x1, y0, y1, height = (mpmath.mpf(float(value)) for value in (x0, x1, y0, y1, height))
    return corner(x1, y1, height) - corner(x0, y1, height) - corner(x1, y0, height) + corner(x0, y0, height)


def anywhere(rng, count):
    """Rectangles of 1e-6 to 100 m, half of them over the foot.

    They are up to 10 km aside and from 1e-8 to 1e6 m away.
    """
    size = 10.0 ** rng.uniform(-6.0, 2.0, (2, count))
    aside = rng.choice(SIGN, (2, count)) * 10.0 ** rng.uniform(-6.0, 4.0, (2, count))
    start = np.where(rng.random((2, count)) < 0.5, aside, -size * rng.random((2, count)))
    height = 10.0 ** rng.uniform(-8.0, 6.0, count)
    return start[0], start[0] + size[0], start[1], start[1] + size[1], height


@pytest.fixture(autouse=True)
def many_digits():
    with mpmath.workdps(60):
        yield


def test_solid_angle_has_all_its_digits(rng):
    bounds = anywhere(rng, 600)
    solid = SphericalRectangle(*bounds).solid_angle
    error = [abs(float(got / exact(*one) - 1)) for got, *one in zip(solid, *bounds, strict=True)]
    assert max(error) < 16 * np.finfo(float).eps


def test_textbook_sum_of_angles_would_not_do():
    """What the rewriting is for: Urena's sum of angles minus 2 pi, on a 1 m square 10 km away."""
    x0, x1, y0, y1, height = -0.5, 0.5, -0.5, 0.5, 1e4
    normals = np.array([-y0, x1, y1, -x0])
    normals /= np.sqrt(normals**2 + height**2)
    textbook = np.arccos(-normals * np.roll(normals, -1)).sum() - 2.0 * np.pi
    truth = float(exact(x0, x1, y0, y1, height))
    ours = SphericalRectangle(*(np.array([value]) for value in (x0, x1, y0, y1, height))).solid_angle[0]
    assert abs(textbook / truth - 1.0) > 1e-9
    assert ours == pytest.approx(truth, rel=1e-14)


def test_places_divide_the_solid_angle(rng):
    bounds = anywhere(rng, 600)
    rectangle = SphericalRectangle(*bounds)
    u1, u2 = rng.random((2, 600))
    x, y = rectangle.place(u1, u2)
    x0, x1, y0, y1, _ = bounds
    assert np.all((x0 <= x) & (x <= x1) & (y0 <= y) & (y <= y1))
    kept = np.flatnonzero(rectangle.solid_angle > 1e-7)
    assert kept.size > 100
    for i in kept:
        x0, x1, y0, y1, height = (mpmath.mpf(float(bound[i])) for bound in bounds)
        at_x, at_y = mpmath.mpf(float(x[i])), mpmath.mpf(float(y[i]))
        below = exact(x0, at_x, y0, y1, height) / exact(x0, x1, y0, y1, height)
        assert float(below) == pytest.approx(u1[i] if x0 + x1 >= 0 else 1.0 - u1[i], abs=1e-8)
        low, here, high = (v / mpmath.sqrt(at_x**2 + height**2 + v**2) for v in (y0, at_y, y1))
        assert float((here - low) / (high - low)) == pytest.approx(u2[i] if y0 + y1 >= 0 else 1.0 - u2[i], abs=1e-8)


def test_ends_of_the_unit_square(rng):
    bounds = anywhere(rng, 2000)
    rectangle = SphericalRectangle(*bounds)
    x0, x1, y0, y1, _ = bounds
    for u1 in (0.0, 2.0**-33, 1.0 - 2.0**-33, np.nextafter(1.0, 0.0)):
        for u2 in (0.0, np.nextafter(1.0, 0.0)):
            x, y = rectangle.place(np.full(2000, u1), np.full(2000, u2))
            assert np.all((x0 <= x) & (x <= x1) & (y0 <= y) & (y <= y1))
