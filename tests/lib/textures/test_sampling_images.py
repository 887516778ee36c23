# SPDX-License-Identifier: GPL-3.0-or-later
"""Image sampling against SciPy's resampling and closed forms."""

import numpy as np
import pytest
from etalon.lib.scene.images import Image
from etalon.lib.srgb import srgb_decode
from etalon.lib.textures.images import ImageSet, equirectangular
from scipy.ndimage import map_coordinates

MODES = {"REPEAT": "grid-wrap", "EXTEND": "nearest", "MIRROR": "reflect", "CLIP": "grid-constant"}


def texels(rng, height=5, width=7):
    return rng.random((height, width, 4)).astype(np.float32)


@pytest.mark.parametrize("extension", MODES)
@pytest.mark.parametrize(("interpolation", "order"), [("LINEAR", 1), ("CLOSEST", 0), ("CUBIC", 3)])
def test_resampling_is_scipys(extension, interpolation, order, rng):
    pixels = texels(rng)
    u, v = rng.uniform(-2, 3, (2, 2000))
    got = ImageSet([Image("", pixels, "DATA")]).sample(0, u, v, interpolation, extension)
    place = [v * 5 - 0.5, u * 7 - 0.5]
    expected = [
        map_coordinates(pixels[..., c].astype(float), place, order=order, mode=MODES[extension], prefilter=False)
        for c in range(4)
    ]
    np.testing.assert_allclose(got, expected, atol=1e-12)


def test_texel_centres_give_texels_and_the_bottom_row_comes_first(rng):
    pixels = texels(rng)
    got = ImageSet([Image("", pixels, "LINEAR")]).sample(0, np.array([0.5 / 7, 6.5 / 7]), np.array([0.1, 0.9]))
    np.testing.assert_allclose(got.T, pixels[[0, 4], [0, 6]], rtol=1e-6)


def test_all_texels_of_a_large_image_are_decoded(rng):
    """More of them than are decoded at once."""
    pixels = texels(rng, 100, 120)
    row, column = np.indices(pixels.shape[:2]).reshape(2, -1)
    got = ImageSet([Image("", pixels, "SRGB")]).sample(0, (column + 0.5) / 120, (row + 0.5) / 100, "CLOSEST")
    np.testing.assert_allclose(got[:3].T, srgb_decode(pixels[row, column, :3].astype(float)), rtol=1e-5)


def test_decoding_before_or_after_interpolation():
    """Half way between black and white the reference has 0.5.

    Cycles has the decoded middle code, 0.214.
    """
    pixels = np.ones((1, 2, 4), np.float32)
    pixels[0, 0, :3] = 0.0
    for first, expected in ((True, 0.5), (False, srgb_decode(np.array(0.5)))):
        got = ImageSet([Image("", pixels, "SRGB")], decode_first=first).sample(0, np.array([0.5]), np.array([0.5]))
        np.testing.assert_allclose(got[:3, 0], expected, rtol=1e-6)


@pytest.mark.parametrize(("association", "expected"), [("SEPARATE", 0.5), ("MULTIPLIED", 0.1), ("WEIGHTED", 0.2)])
def test_what_alpha_does_to_colour(association, expected):
    """Half way between white of alpha 0.2 and black of alpha 0.8."""
    pixels = np.array([[[1, 1, 1, 0.2], [0, 0, 0, 0.8]]], np.float32)
    got = ImageSet([Image("", pixels, "LINEAR")]).sample(0, np.array([0.5]), np.array([0.5]), association=association)
    np.testing.assert_allclose(got[:, 0], [expected, expected, expected, 0.5], rtol=1e-6)


def test_clear_texels_have_no_colour_and_no_nan():
    pixels = np.zeros((2, 2, 4), np.float32)
    got = ImageSet([Image("", pixels, "SRGB")]).sample(0, np.zeros(3), np.zeros(3), association="WEIGHTED")
    np.testing.assert_array_equal(got, 0.0)


@pytest.mark.parametrize("size", [(1, 1), (1, 3), (3, 1)])
@pytest.mark.parametrize("extension", MODES)
def test_tiny_images(size, extension, rng):
    pixels = np.full((*size, 4), 0.25, np.float32)
    u, v = rng.uniform(0.5, 0.5, (2, 50))
    np.testing.assert_allclose(ImageSet([Image("", pixels, "DATA")]).sample(0, u, v, extension=extension), 0.25)


def test_equirectangular_directions():
    axes = np.array([[1, 0, 0, -1, 0, 0], [0, 1, -1, -1e-9, 0, 0], [0, 0, 0, 0, 1, -1]], float) * 7.0
    u, v = equirectangular(axes)
    np.testing.assert_allclose(u[:4], [0.5, 0.25, 0.75, 1.0], atol=1e-9)
    np.testing.assert_allclose(v, [0.5, 0.5, 0.5, 0.5, 1.0, 0.0], atol=1e-12)


def test_stored_texels_are_not_written_to(rng):
    pixels = texels(rng)
    before = pixels.copy()
    images = ImageSet([Image("", pixels, "SRGB")])
    for association in ("SEPARATE", "MULTIPLIED", "WEIGHTED"):
        images.sample(0, rng.random(9), rng.random(9), association=association)
    np.testing.assert_array_equal(pixels, before)


@pytest.mark.parametrize("encoding", ["SRGB", "LINEAR"])
@pytest.mark.parametrize("association", ["MULTIPLIED", "WEIGHTED"])
@pytest.mark.parametrize("decode_first", [False, True])
@pytest.mark.parametrize("alpha_in_codes", [False, True])
def test_colours_stored_times_alpha_are_those_of_straight_ones(
    encoding, association, decode_first, alpha_in_codes, rng
):
    straight = texels(rng)
    multiplied = straight.copy()
    multiplied[..., :3] *= straight[..., 3:]
    images = ImageSet(
        [Image("", straight, encoding), Image("", multiplied, encoding, multiplied=True)], decode_first, alpha_in_codes
    )
    u, v = rng.uniform(-1, 2, (2, 200))
    expected, got = (images.sample(k, u, v, association=association) for k in (0, 1))
    np.testing.assert_allclose(got, expected, rtol=2e-5, atol=1e-6)


@pytest.mark.parametrize("association", ["MULTIPLIED", "WEIGHTED"])
def test_a_colour_stored_times_alpha_stays_where_alpha_is_zero(association):
    """An image that only adds light, as of a flame, has colours and no alpha."""
    image = Image("", np.array([[[0.5, 0.25, 0.75, 0.0]]], np.float32), "SRGB", multiplied=True)
    for decode_first in (False, True):
        got = ImageSet([image], decode_first).sample(0, np.zeros(1), np.zeros(1), association=association)
        np.testing.assert_allclose(got[:, 0], [*srgb_decode(np.array([0.5, 0.25, 0.75])), 0.0], rtol=1e-6)
