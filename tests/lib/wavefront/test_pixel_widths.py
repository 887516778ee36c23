# SPDX-License-Identifier: GPL-3.0-or-later
"""Wireframes in pixels: how far from an edge they reach, by closed forms of the pixel's cone along a path."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.scene.expressions import (
    ONE,
    ZERO,
    Bump,
    ColorToValue,
    Constant,
    Math,
    PixelWidth,
    ValueToColor,
    Wireframe,
)
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.materials import Diffuse, Emission, Glossy, Subsurface, Transparent
from etalon.lib.settings.reference import Options
from etalon.tests.replicates import replicates
from etalon.tests.scenes import material, orthographic, perspective, quad, scene

PIXEL = 1e-3
"""The side of the one pixel, as a tangent or in metres."""
EDGE = 0.3
"""The distance in metres of the point that the camera sees from the nearest edge of its triangle."""
OBLONG = replace(orthographic(1, 1, 1.0, (0.0, 0.0, 3.0)), plane_from_raster=np.diag([1.0, 2.0, 1.0])[:2])
SUN = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (np.pi,) * 3)


def wires(size):
    return Wireframe(Math("MULTIPLY", Constant(size), PixelWidth(), ZERO))


def plate(tilt=0.0, z=0.0):
    """A square of 2 metres whose nearest edge to the middle of its half y < x is EDGE away from (0, 0, z)."""
    c, s = np.cos(tilt), np.sin(tilt)
    corner = np.array([-1.7, 0.0, z]) - EDGE * np.array([0.0, c, s])
    return quad(tuple(corner), (2.0, 0.0, 0.0), (0.0, 2.0 * c, 2.0 * s), 0)


def brightness(parts, size, camera, others=(), closure=Diffuse):
    made = scene(parts, [material(closure(ValueToColor(wires(size)))), *others], camera, [SUN], bounces=1)
    return replicates(made, 2, 16, seed=0).mean()


def assert_reaches(width, parts, camera, *others):
    """Wires of a pixel's `width` reach the point at the size at which half of them is EDGE, and not before."""
    size = 2.0 * EDGE / width
    assert brightness(parts, 0.99 * size, camera, others) == 0.0
    assert brightness(parts, 1.01 * size, camera, others) > 0.1


@pytest.mark.parametrize("height", [0.5, 3.0])
def test_on_the_axis_of_a_perspective_camera(height):
    assert_reaches(PIXEL * height, [plate()], perspective(1, 1, 0.5 * PIXEL, (0.0, 0.0, height)))


@pytest.mark.parametrize("height", [0.5, 3.0])
def test_an_orthographic_pixel_is_as_wide_everywhere(height):
    assert_reaches(PIXEL, [plate()], orthographic(1, 1, PIXEL, (0.0, 0.0, height)))


@pytest.mark.parametrize("tilt", [0.7, -1.1])
def test_on_a_slope_two_steps_in_the_face_are_seen_aslant(tilt):
    """The steps have the directions of (1, 1, 1) x n and across it."""
    n = np.array([0.0, -np.sin(tilt), np.cos(tilt)])
    first = np.cross((1.0, 1.0, 1.0), n)
    first /= np.linalg.norm(first)
    slants = [np.sqrt(1.0 - axis[2] ** 2) for axis in (first, np.cross(n, first))]
    assert_reaches(PIXEL * np.mean(slants), [plate(tilt)], orthographic(1, 1, PIXEL, (0.0, 0.0, 3.0)))


def test_in_a_mirror_the_whole_path_counts():
    """The camera looks up to a small mirror, and in it down to the plate: 1 m, and 2 m more."""
    mirror = material(Glossy("GGX", roughness=ZERO))
    above = quad((-0.1, -0.1, 2.0), (0.0, 0.2, 0.0), (0.2, 0.0, 0.0), 1)
    camera = perspective(1, 1, 0.5 * PIXEL, (0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    assert_reaches(3.0 * PIXEL, [plate(), above], camera, mirror)


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"closure": Emission}, "its emission"),
        ({"closure": Transparent}, "what lets light straight through"),
        ({"closure": lambda value: Diffuse(normal=Bump(ColorToValue(value), ONE, ONE))}, "the height of a bump"),
        ({"camera": replace(perspective(1, 1, 1.0, (0.0, 0.0, 3.0)), kind="EQUIRECTANGULAR")}, "a panoramic view"),
        ({"camera": OBLONG}, "an orthographic view of oblong pixels"),
        ({"others": [material(Subsurface())]}, "a scene with subsurface scattering"),
    ],
)
def test_what_is_not_followed_is_refused(change, where):
    camera = change.get("camera", orthographic(1, 1, PIXEL, (0.0, 0.0, 3.0)))
    parts = [plate(), quad((-0.1, -0.1, 2.0), (0.0, 0.2, 0.0), (0.2, 0.0, 0.0), len(change.get("others", ())))]
    with pytest.raises(Refused, match=f"Pixel Size of a Wireframe node in {where} is not simulated"):
        brightness(parts, 5.0, camera, change.get("others", ()), change.get("closure", Diffuse))


def test_light_tracing_refuses_it():
    made = scene([plate()], [material(Diffuse(ValueToColor(wires(5.0))))], orthographic(1, 1, 1.0, (0, 0, 3)), [SUN])
    with pytest.raises(EtalonError, match="wireframes in pixels by light tracing"):
        LightTracingRenderer(made, Options(threads=1))
