# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies: the table's places, its horizon, and the disc of the sun in closed form."""

import numpy as np
import pytest
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.images import Image
from etalon.lib.scene.sky import Sky, SunDisc
from etalon.lib.textures.evaluate import evaluate
from etalon.lib.textures.images import ImageSet
from etalon.lib.textures.sky import place_in_table, table_directions, toward
from etalon.lib.wavefront.direction import Directions

AZIMUTH = 0.7
SUN = SunDisc(elevation=0.4, diameter=0.02, image=1)
DIRECTION = ex.Coordinates("GENERATED")


def image(rows):
    """An image from rows of texels, the lowest first."""
    texels = np.array(rows, np.float32)
    return Image("", np.dstack((texels, texels, texels, np.ones(texels.shape))), "LINEAR")


def shown(sky, images, *directions):
    return evaluate(sky, Directions(np.array(directions).T), ImageSet(images))[0]


def test_texels_lie_where_they_are_looked_up():
    u, v = place_in_table(table_directions(10, 6, AZIMUTH).reshape(-1, 3).T, AZIMUTH)
    np.testing.assert_allclose(u.reshape(6, 10), np.broadcast_to((np.arange(10) + 0.5) / 10, (6, 10)), atol=1e-12)
    np.testing.assert_allclose(v.reshape(6, 10), np.repeat((np.arange(6) + 0.5) / 6, 10).reshape(6, 10), atol=1e-12)


def test_the_horizon_is_narrow_and_azimuth_falls_to_the_right():
    table = image([[1, 2, 3]] * 8 + [[11, 12, 13]] * 8)
    # The middle of the first row above: (1/16)^2 of 90 degrees, and as much below.
    rise = 0.5 * np.pi / 16**2
    places = [toward(side * rise, AZIMUTH + turn) for side in (1, -1) for turn in (0.0, -2.0 * np.pi / 3)]
    assert shown(Sky(DIRECTION, 0, AZIMUTH), [table], *places) == pytest.approx([12, 13, 2, 3])


@pytest.mark.parametrize("covers", [False, True])
def test_a_sun_is_linear_from_edge_to_edge_and_dark_at_its_limb(covers):
    sky = Sky(DIRECTION, 0, AZIMUTH, SunDisc(SUN.elevation, SUN.diameter, 1, covers))
    share = np.array([-1.001, -0.999, -0.6, 0.0, 0.6, 0.999, 1.001])
    radius = 0.5 * SUN.diameter
    got = shown(sky, [image([[3.0]]), image([[100.0], [300.0]])], *(toward(0.4 + s * radius, AZIMUTH) for s in share))
    inside = np.abs(share) < 1
    limb = 1.0 - 0.6 * (1.0 - np.sqrt(1.0 - np.where(inside, share, 0.0) ** 2))
    disc = np.where(inside, (200.0 + 100.0 * share) * limb, 0.0)
    np.testing.assert_allclose(got, disc + np.where(inside & covers, 0.0, 3.0), rtol=1e-9)


def test_a_sun_is_round():
    up, right = np.array(toward(0.4 + 0.5 * np.pi, AZIMUTH)), np.cross(toward(0.4, AZIMUTH), toward(0.4 + 1.0, AZIMUTH))
    right /= np.linalg.norm(right)
    sky = Sky(DIRECTION, 0, AZIMUTH, SUN)
    for share, seen in ((0.999, True), (1.001, False)):
        angle = 0.5 * SUN.diameter * share
        ring = (
            np.cos(angle) * np.array(toward(0.4, AZIMUTH)) + np.sin(angle) * (np.cos(t) * up + np.sin(t) * right)
            for t in np.linspace(0, 6, 13)
        )
        assert np.all((shown(sky, [image([[0.0]]), image([[1.0], [1.0]])], *ring) > 0) == seen)
