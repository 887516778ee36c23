# SPDX-License-Identifier: GPL-3.0-or-later
"""Coverage: which part of a pixel shows which material and object."""

import numpy as np
import pytest
from etalon.lib.effects.plan import make_plan
from etalon.lib.scene.lights import SphereLight
from etalon.lib.scene.rays import CAMERA, SCATTERED
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.coverage import bare_pixels, coverage, join_bands
from etalon.lib.wavefront.kernel import Kernel
from etalon.tests.scenes import cube, diffuse, icosphere, material, orthographic, perspective, quad, scene


def found(the_scene, seed, samples=16):
    shares = coverage(Kernel(the_scene, make_plan(the_scene), Options(seed=seed)), samples, least=0.0)
    return {kind: {name: share.toarray() for name, share in entries} for kind, entries in shares.items()}


def test_shares_are_areas(seed):
    """Two quads of different materials over half of the image's height.

    They meet a third of the way through a pixel.
    """
    parts = [
        quad((-2.0, 0.0, 0.0), (2.0 + 1.0 / 3.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0),
        quad((1.0 / 3.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1),
    ]
    materials = [material(name="left"), material(name="right"), material(name="nowhere")]
    shares = found(scene(parts, materials, orthographic(4, 2, 4.0, (0.0, 0.0, 1.0))), seed, 1024)["material"]
    assert set(shares) == {"left", "right"}
    np.testing.assert_allclose(shares["left"][0], [1.0, 1.0, 1.0 / 3.0, 0.0], atol=2.0 / 1024)
    np.testing.assert_allclose(shares["right"][0], [0.0, 0.0, 2.0 / 3.0, 1.0], atol=2.0 / 1024)
    assert not shares["left"][1].any()


def test_objects_and_materials_fill_what_is_covered(seed):
    """Shares of all objects, and of all materials, sum to the same, at most 1.

    The nearer hides the farther.
    """
    parts = [cube(0.5), icosphere(0.4, 2, 1), quad((-5.0, -5.0, -3.0), (10.0, 0.0, 0.0), (0.0, 10.0, 0.0), 0)]
    parts[1].vertices[0] += 0.7
    the_scene = scene(parts, [material(name="one"), material(name="two")], perspective(12, 9, 0.6, (0.0, 0.1, 3.0)))
    shares = found(the_scene, seed)
    total = [sum(images.values()) for images in (shares["object"], shares["material"])]
    np.testing.assert_allclose(total[0], total[1], rtol=1e-15)
    np.testing.assert_allclose(total[0], 1.0)
    assert shares["object"]["object 0"][4, 5] == 1.0
    assert shares["object"]["object 2"][0, 0] == 1.0


def test_bands_split_a_material_by_angle(seed):
    """The part of a distant sphere with angles below t covers sin^2 t of its disk.

    Bands sum to the material.
    """
    parts = icosphere(1.0, 5, 0)
    shares = found(scene(parts, [material(name="ball")], orthographic(32, 32, 2.2, (0.0, 0.0, 3.0))), seed, 64)
    whole = shares["material"]["ball"]
    ends = np.sin(np.radians([0.0, 30.0, 60.0, 80.0, 90.0])) ** 2
    bands = [shares["facing"][f"ball, {a} to {b} degrees"] for a, b in ((0, 30), (30, 60), (60, 80), (80, 90))]
    np.testing.assert_allclose(sum(bands), whole, rtol=1e-12)
    np.testing.assert_allclose([band.sum() / whole.sum() for band in bands], np.diff(ends), atol=0.01)


@pytest.mark.parametrize(
    ("sizes", "bands"),
    [
        ([300, 300, 300, 128], [(3, 3), (2, 2), (1, 1), (0, 0)]),
        ([300, 300, 300, 77], [(2, 3), (1, 1), (0, 0)]),
        ([300, 300, 60, 60], [(1, 3), (0, 0)]),
        ([90, 215, 77, 0], []),
        ([127, 300, 0, 200], [(3, 3), (0, 1)]),
        ([0, 0, 500, 0], [(2, 2)]),
        ([100, 0, 0, 0], []),
        ([20, 20, 20, 20], []),
        ([90, 0, 0, 128], []),
    ],
)
def test_narrow_bands_are_joined_from_grazing_angles_on(sizes, bands):
    assert join_bands(np.array(sizes), 128) == bands


def test_joined_bands_sum_to_the_material_and_none_is_small(seed):
    """A sphere whose outermost degrees, 3 % of its disk, cover fewer than 128 pixels."""
    parts = icosphere(1.0, 5, 0)
    the_scene = scene(parts, [material(name="ball")], orthographic(64, 64, 2.2, (0.0, 0.0, 3.0)))
    shares = coverage(Kernel(the_scene, make_plan(the_scene), Options(seed=seed)))
    bands = dict(shares["facing"])
    assert set(bands) == {"ball, 60 to 90 degrees", "ball, 30 to 60 degrees", "ball, 0 to 30 degrees"}
    np.testing.assert_allclose(sum(band.toarray() for band in bands.values()), shares["material"][0][1].toarray())
    assert min(band.sum() for band in bands.values()) >= 128


def test_what_hardly_shows_makes_no_region(seed):
    the_scene = scene(cube(0.5), [material(name="m")], orthographic(8, 8, 8.0, (0.0, 0.0, 3.0)))
    assert coverage(Kernel(the_scene, make_plan(the_scene), Options(seed=seed)), 4)["object"] == []


def test_an_empty_view_shows_nothing(seed):
    away = scene(cube(0.5), diffuse(0.5), orthographic(2, 2, 1.0, (0.0, 0.0, 3.0), (0.0, 0.0, 1.0)))
    assert found(away, seed) == {"material": {}, "facing": {}, "object": {}}


def test_bare_pixels_show_no_face(seed):
    """A quad covers the left three pixels of six, and a sliver of the fourth."""
    part = quad((-3.0, -1.0, 0.0), (3.5, 0.0, 0.0), (0.0, 2.0, 0.0), 0)
    the_scene = scene([part], [material(name="one")], orthographic(6, 2, 6.0, (0.0, 0.0, 1.0)))
    bare = bare_pixels(Kernel(the_scene, make_plan(the_scene), Options(seed=seed)))
    assert bare.tolist() == [[False] * 4 + [True] * 2] * 2


@pytest.mark.parametrize(("rays", "bare"), [(SCATTERED, True), (SCATTERED | CAMERA, False)])
def test_where_the_camera_can_meet_a_lamp_no_pixel_is_bare(seed, rays, bare):
    """Next to no ray meets a lamp of a millimetre."""
    lamp = SphereLight("lamp", (2.5, 0.5, -1.0), 1e-3, (1e6,) * 3, rays=rays)
    part = quad((-3.0, -1.0, 0.0), (3.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    the_scene = scene(part, diffuse(0.5), orthographic(6, 2, 6.0, (0.0, 0.0, 1.0)), lights=(lamp,))
    assert bare_pixels(Kernel(the_scene, make_plan(the_scene), Options(seed=seed))).any() == bare
