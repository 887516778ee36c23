# SPDX-License-Identifier: GPL-3.0-or-later
"""Which side is right about textures, ramps and curves: proofs of departures."""

import numpy as np
import pytest
from etalon.lib.departures.scene import tabulated_curves, tabulated_ramp
from etalon.lib.scene.converters import Curve, Curves
from etalon.lib.scene.expressions import ONE, ZERO, ColorRamp, Constant
from etalon.lib.scene.images import Image
from etalon.lib.srgb import srgb_decode
from etalon.lib.textures.curves import curve, curve_of_channel
from etalon.lib.textures.images import ImageSet
from etalon.lib.textures.ramp import color_ramp
from scipy.special import roots_legendre


def test_interpolation_keeps_the_light_of_a_texture():
    """The mean over a repeated image is the mean of its texels' light.

    It is so whatever lies between them; of code values it is not.
    """
    codes = np.ones((2, 2, 4), np.float32)
    codes[..., :3] = np.array([[0.1, 1.0], [0.6, 0.3]])[..., None]
    image = Image("texels", codes, "SRGB")
    x, weight = roots_legendre(32)  # each quarter of the image is bilinear
    u = np.concatenate([0.125 + 0.125 * x + 0.25 * k for k in range(4)])
    u, v = (grid.ravel() for grid in np.meshgrid(u, u))
    weight = np.tile(weight / 8.0, 4)
    weight = np.outer(weight, weight).ravel()
    light = srgb_decode(codes[..., 0]).mean()
    assert (ImageSet([image]).sample(0, u, v)[0] * weight).sum() == pytest.approx(light, rel=1e-6)
    assert (ImageSet([image], decode_first=False).sample(0, u, v)[0] * weight).sum() < 0.9 * light


@pytest.mark.parametrize("interpolates_codes", [True, False])
def test_half_covered_texels_reflect_half_the_light(interpolates_codes):
    """Alpha is a share of an area.

    Texels of alpha 1/2 give half of the decoded light, as every other texel would. That is so wherever colours are
    interpolated; of code values halved before they are decoded it is not.
    """
    solid = np.array([0.6, 0.6, 0.6, 1.0], np.float32)
    half = np.tile(np.array([0.6, 0.6, 0.6, 0.5], np.float32), (2, 2, 1))
    dithered = np.zeros((2, 2, 4), np.float32)
    dithered[[0, 1], [0, 1]] = solid
    light = 0.5 * srgb_decode(np.array([0.6]))[0]
    u, v = (grid.ravel() for grid in np.meshgrid([0.25, 0.75], [0.25, 0.75]))

    def mean(pixels, in_codes):
        images = ImageSet([Image("texels", pixels, "SRGB")], not interpolates_codes, in_codes)
        return images.sample(0, u, v, association="MULTIPLIED")[0].mean()

    assert mean(half, False) == pytest.approx(light, rel=1e-6)
    assert mean(dithered, False) == mean(dithered, True) == pytest.approx(light, rel=1e-6)
    assert mean(half, True) == pytest.approx(srgb_decode(np.array([0.3]))[0], rel=1e-6)
    assert mean(half, True) < 0.5 * light


def test_bytes_are_cut_off_after_alpha_is_multiplied_in():
    """150 at alpha 3/255 is 1.76 codes.

    A byte keeps 1, so that 85 comes back where alpha is divided out. The model keeps 150.
    """
    texel = np.array([150, 150, 150, 3], np.float32).reshape(1, 1, 4) / 255.0
    there = np.zeros(1), np.zeros(1)
    for in_codes, code in ((False, 150), (True, 85)):
        images = ImageSet([Image("texel", texel, "SRGB")], alpha_in_codes=in_codes)
        exact = srgb_decode(np.array([code / 255.0]))[0]
        assert images.sample(0, *there, association="WEIGHTED")[0] == pytest.approx(exact, rel=1e-5)


def test_floats_are_not_cut_off(rng):
    """Where alpha is divided out again, the departure leaves a float texture as it is."""
    pixels = rng.uniform(0.1, 1.0, (3, 4, 4)).astype(np.float32)
    u, v = (grid.ravel() for grid in np.meshgrid(np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 7)))
    model, departed = (
        ImageSet([Image("texels", pixels, "SRGB")], alpha_in_codes=in_codes).sample(0, u, v, association="WEIGHTED")
        for in_codes in (False, True)
    )
    assert departed == pytest.approx(model, rel=1e-5)


def test_a_ramp_is_linear_between_its_stops():
    ramp = ColorRamp(Constant(0.0), (0.3005, 0.3015), ((0.2,) * 3 + (1.0,), (0.9,) * 3 + (1.0,)))
    factor = np.linspace(0.29, 0.31, 2001)
    assert color_ramp(ramp, factor)[0] == pytest.approx(np.interp(factor, (0.3005, 0.3015), (0.2, 0.9)), abs=1e-12)
    node = np.linspace(0.0, 1.0, 257)
    table = np.interp(factor, node, np.interp(node, (0.3005, 0.3015), (0.2, 0.9)))
    assert color_ramp(tabulated_ramp(ramp), factor)[0] == pytest.approx(table, abs=1e-12)
    assert np.abs(table - color_ramp(ramp, factor)[0]).max() > 0.1


def test_a_curve_goes_on_along_its_handle_and_not_along_its_last_two_entries():
    """x^2 from 0 to 1, whose tangents at the ends have the slopes 0 and 2."""
    node = np.linspace(0.0, 1.0, 257)
    square = Curve(0.0, 1.0, tuple((node**2).tolist()), (0.0, 0.0), (1.0, 2.0))
    x = np.array([-2.0, 0.25, 0.5, 3.0])
    assert curve(square, x) == pytest.approx([0.0, 0.0625, 0.25, 5.0], abs=1e-12)
    (table,) = tabulated_curves(Curves(ONE, ZERO, (square,))).channels
    assert curve(table, x) == pytest.approx([-2.0 / 256, 0.0625, 0.25, 1.0 + 2.0 * (2.0 - 1.0 / 256)], abs=1e-12)
    (table,) = tabulated_curves(Curves(ONE, ZERO, (square,), extends=False)).channels
    assert curve(table, x) == pytest.approx([0.0, 0.0625, 0.25, 1.0], abs=1e-12)


def test_a_combined_curve_comes_before_those_of_the_channels():
    """2x and then x - 1, in one table; x is 0.25."""
    doubled = Curve(0.0, 1.0, (0.0, 2.0), (0.0, 2.0), (2.0, 2.0))
    lowered = Curve(0.0, 1.0, (-1.0, 0.0), (-1.0, 1.0), (0.0, 1.0))
    both = Curves(ONE, ZERO, (lowered,), doubled)
    for node in (both, tabulated_curves(both)):
        assert curve_of_channel(node, 0, np.array([0.25, 2.0])) == pytest.approx([-0.5, 3.0])


def test_a_step_moves_to_the_next_node():
    stops = ((0.0,) * 3 + (1.0,), (1.0,) * 4)
    ramp = ColorRamp(Constant(0.0), (0.0, 0.5 + 0.3 / 256.0), stops, "CONSTANT")
    assert color_ramp(ramp, np.array([0.5 + 0.4 / 256.0]))[0, 0] == 1.0
    assert color_ramp(tabulated_ramp(ramp), np.array([0.5 + 0.4 / 256.0, 0.5 + 1.1 / 256.0]))[0] == pytest.approx(
        [0.0, 1.0]
    )
