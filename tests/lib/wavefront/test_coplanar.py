# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that overlap in one plane: one surface to the reference.

With its departures they hide light from each other, or change places.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.scene.lights import SunLight
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests import scenes
from scipy.spatial.transform import Rotation

SUN = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (np.pi, np.pi, np.pi))
LIT = 0.8 * 0.8  # albedo times cosine
HIDING, SWAPPING, ROUNDING = "faces in one plane", "other of two faces", "rounding in one plane"


def shown(parts, materials, departures=(), bounces=0, world=0.0, samples=64):
    """The red of two pixels, left and right."""
    camera = scenes.orthographic(2, 1, 2.0, (0.0, 0.0, 5.0))
    scene = scenes.scene(parts, materials, camera, (SUN,), world, bounces)
    options = Options(threads=1, departures=frozenset(departures))
    return ReferenceRenderer(scene, options).render(0, samples).radiance[0, :, 0]


def half(side, material=0):
    """The floor's left (-1) or right (0) half."""
    return scenes.quad((side, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), material)


@pytest.mark.parametrize("copies", [2, 3])
def test_copies_in_one_place_are_one_surface_to_the_reference(copies):
    """Lambert under a sun: albedo times cosine, however often the floor is there."""
    assert shown([scenes.floor()] * copies, scenes.diffuse(0.8)) == pytest.approx([LIT, LIT], rel=1e-12)


@pytest.mark.parametrize("name", [HIDING, ROUNDING])
@pytest.mark.parametrize("copies", [2, 3])
def test_with_the_departures_copies_in_a_plane_along_two_axes_hide_all_light(copies, name):
    """There, single precision puts all points in the plane of the other face exactly."""
    assert shown([scenes.floor()] * copies, scenes.diffuse(0.8), [name], 4, 1.0) == pytest.approx([0.0, 0.0])


def test_light_is_hidden_only_where_faces_overlap():
    assert shown([scenes.floor(), half(0.0)], scenes.diffuse(0.8), [HIDING]) == pytest.approx([LIT, 0.0])


def test_a_face_that_overlaps_nothing_is_as_without_the_departure():
    parts = [scenes.floor(), scenes.cube(0.3, (0.0, 0.0, 0.5))]
    plain, departed = (shown(parts, scenes.diffuse(0.8), names, 3, 1.0) for names in ((), [HIDING]))
    assert (plain == departed).all()


def test_a_transparent_copy_lets_through_what_its_colour_does():
    """The floor is seen through its copy or beside it.

    Either way shadow rays pass the copy once more.
    """
    found = shown([scenes.floor(), half(-1.0, 1), half(0.0)], [scenes.diffuse(0.8), scenes.transparent(0.5)], [HIDING])
    plain = shown([scenes.floor(), half(-1.0, 1)], [scenes.diffuse(0.8), scenes.transparent(0.5)])
    assert plain[0] == pytest.approx(LIT, rel=1e-12) or plain[0] == pytest.approx(0.0)
    assert found[0] == pytest.approx(0.5 * LIT, rel=1e-12)
    assert found[1] == pytest.approx(0.0)


def test_emission_is_not_hidden():
    """A face that shines is met at distance 0, too.

    A white one of two adds what the other sends out, again and again.
    """
    found = shown([scenes.floor(), scenes.floor()], scenes.emission(0.3), [HIDING], 4)
    assert found == pytest.approx([0.3, 0.3], rel=1e-12)


def test_of_two_materials_the_departure_shows_the_other():
    parts = [scenes.floor(), half(-1.0, 1), half(0.0)]
    materials = [scenes.emission(0.25), scenes.emission(0.75)]
    plain, other = shown(parts, materials), shown(parts, materials, [SWAPPING])
    assert plain[0] + other[0] == pytest.approx(1.0, rel=1e-12)
    assert plain[1] == other[1] == pytest.approx(0.25, rel=1e-12)


def turned(part):
    """The part turned about no axis of the scene."""
    return replace(part, vertices=Rotation.from_rotvec((0.5, 0.2, 0.1)).apply(part.vertices.T).T)


def test_in_a_tilted_plane_rounding_hides_a_part_of_the_light():
    parts = [turned(scenes.floor(2.0))] * 2
    plain, part = (shown(parts, scenes.diffuse(0.8), names, samples=4096) for names in ((), [ROUNDING]))
    assert (0.1 * plain < part).all()
    assert (part < 0.9 * plain).all()


@pytest.mark.parametrize(("name", "exact"), [(ROUNDING, 1.0), (HIDING, 0.0)])
def test_no_light_is_lost_in_a_white_body_that_is_there_twice(name, exact):
    """A furnace: whatever rays meet, all that is white shows the world's radiance, if paths leave it in the end.

    They enter the closed body between its faces, and leave it so. Where all points meet the other face, none comes out.
    """
    camera = scenes.orthographic(2, 1, 2.0, (0.0, 0.0, 5.0))
    scene = scenes.scene([turned(scenes.cube(2.0))] * 2, scenes.diffuse(1.0), camera, (), 1.0, 1000)
    options = Options(threads=1, departures=frozenset([name]))
    assert ReferenceRenderer(scene, options).render(0, 256).radiance == pytest.approx(
        np.full((1, 2, 3), exact), rel=1e-9
    )


def test_light_comes_out_of_a_body_where_no_lamp_shines():
    """The sun shines from above on a closed body that is there twice, and the camera sees its dark side from below."""
    camera = scenes.orthographic(1, 1, 0.5, (0.0, 0.0, -5.0), (0.0, 0.0, 1.0))
    scene = scenes.scene([turned(scenes.cube())] * 2, scenes.diffuse(0.9), camera, (SUN,), 0.0, 12)
    plain, hiding, rounding = (
        ReferenceRenderer(scene, Options(threads=1, departures=frozenset(names))).render(0, 1024).radiance[0, 0, 0]
        for names in ((), [HIDING], [ROUNDING])
    )
    assert plain == hiding == 0.0
    assert rounding > 0.01
