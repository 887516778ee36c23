# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions and the moments of their means, against the definition written out."""

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.film.moments import Moments
from etalon.lib.film.regions import RegionMoments, image_regions
from scipy import sparse


def soft(rng, height=20, width=33):
    weights = rng.random((height, width))
    weights[:, :5] = 0.0
    return weights


def test_blocks_cover_each_pixel_once():
    regions = image_regions(24, 33, {})
    blocks = regions.weights[regions.indices("block")]
    assert blocks.shape[0] == 2 * 2
    np.testing.assert_array_equal(np.asarray(blocks.sum(axis=0)).ravel(), np.ones(24 * 33))
    assert regions.names[-1] == "x 16 to 32, y 16 to 23"
    assert regions.boxes[-1].tolist() == [16, 16, 32, 23]
    np.testing.assert_array_equal(regions.sizes, [792, 256, 272, 128, 136])


@pytest.mark.parametrize("shape", [(1, 1), (7, 40), (135, 240), (270, 480), (1080, 1921)])
def test_no_block_is_narrower_than_half_unless_the_image_is(shape):
    """Blocks fill their boxes, and lie in one cell of each coarser grid."""
    regions = image_regions(*shape, {}, (64, 32, 16))
    for level, block in enumerate((64, 32, 16), start=2):
        boxes = regions.boxes[regions.families == level]
        for edge, size in zip(((boxes[:, 3] - boxes[:, 1]), (boxes[:, 2] - boxes[:, 0])), shape, strict=True):
            assert (edge + 1 >= min(block / 2, size)).all()
            assert (edge + 1 < 1.5 * block).all()
        np.testing.assert_array_equal(regions.sizes[regions.families == level], areas(boxes))
    fine = regions.families == 4
    for level in (2, 3):
        within = regions.inside[np.flatnonzero(regions.families == level)][:, fine]
        np.testing.assert_array_equal(within.sum(axis=0), np.ones(fine.sum()))


def areas(boxes):
    return (boxes[:, 2] - boxes[:, 0] + 1) * (boxes[:, 3] - boxes[:, 1] + 1)


@pytest.mark.parametrize("form", [np.asarray, sparse.csr_array, sparse.coo_array])
def test_dense_and_sparse_coverage_are_the_same(rng, form):
    weights = soft(rng)
    regions = image_regions(20, 33, {"material": [("Gold", form(weights)), ("hidden", form(np.zeros((20, 33))))]})
    assert regions.indices("material").tolist() == [1]
    assert regions.names[1] == "Gold"
    assert regions.boxes[1].tolist() == [5, 0, 32, 19]
    np.testing.assert_allclose(regions.weights[[1]].toarray().reshape(20, 33), weights, rtol=0)
    assert regions.sizes[1] == pytest.approx(weights.sum(), rel=1e-14)
    assert regions.sizes is regions.sizes


def test_a_region_lies_in_another_if_none_of_its_pixels_is_outside(rng):
    """By the definition, pixel by pixel.

    Blocks lie in the image, those that an object covers lie in the object.
    """
    weights = np.zeros((24, 41))
    weights[:16, 4:] = rng.uniform(0.1, 1.0, (16, 37))
    regions = image_regions(24, 41, {"object": [("Sphere", weights)]})
    shown = regions.weights.toarray() > 0
    expected = [[not (inner & ~outer).any() for inner in shown] for outer in shown]
    np.testing.assert_array_equal(regions.inside.toarray(), expected)
    assert regions.inside[[1]].sum() == 3  # itself and the two blocks of 16 and 9 columns right of x = 15


@pytest.mark.parametrize("form", [np.asarray, sparse.csr_array])
@pytest.mark.parametrize(
    ("weights", "said"),
    [
        (np.ones((3, 3)), "Gold: its coverage is 3 x 3 pixels, the image 4 x 2"),
        (np.full((2, 4), -1.0), "Gold: its coverage has negative"),
        (np.full((2, 4), np.nan), "Gold: its coverage has negative or non-finite"),
    ],
)
def test_coverage_that_is_none_is_refused_by_name(form, weights, said):
    with pytest.raises(EtalonError, match=said):
        image_regions(2, 4, {"material": [("Gold", form(weights))]})


def means(regions, images, excluded):
    weights = regions.weights.toarray() * ~excluded.ravel()
    with np.errstate(invalid="ignore"):
        return np.stack([weights @ im.reshape(-1, 3) / weights.sum(axis=1, keepdims=True) for im in images])


def test_region_means_are_weighted_means(rng):
    regions = image_regions(20, 33, {"object": [("Ball", soft(rng))]})
    images = rng.random((6, 20, 33, 3))
    moments = RegionMoments(regions)
    for image in images:
        moments.add(image)
    direct = means(regions, images, np.zeros((20, 33), bool))
    np.testing.assert_allclose(moments.moments.mean, direct.mean(axis=0), rtol=1e-12)
    np.testing.assert_allclose(moments.moments.variance, direct.var(axis=0, ddof=1), rtol=1e-9)


def test_pixels_excluded_later_leave_the_exact_mean_and_no_less_variance(rng):
    regions = image_regions(24, 41, {"object": [("Ball", soft(rng, 24, 41))]})
    images = rng.random((6, 24, 41, 3))
    moments, film = RegionMoments(regions), Moments.empty((24, 41, 3))
    for image in images[:4]:
        moments.add(image)
        film.add(image)
    excluded = np.zeros((24, 41), bool)
    excluded[3, 7:20] = excluded[16:, 32:] = True  # the last block loses all it has
    moments.exclude(excluded, film)
    holed = images.copy()
    holed[4:, excluded] = np.nan
    for image in holed[4:]:
        moments.add(image)
    direct = means(regions, images, excluded)
    np.testing.assert_allclose(moments.moments.mean[:-1], direct.mean(axis=0)[:-1], rtol=1e-12)
    assert np.isnan(moments.moments.mean[-1]).all()
    assert moments.sizes[-1] == 0
    assert (moments.moments.variance[:-1] >= direct.var(axis=0, ddof=1)[:-1] * (1 - 1e-12)).all()
    before = moments.moments.m2.copy()
    moments.exclude(excluded, film)  # a second time is nothing new
    np.testing.assert_array_equal(moments.moments.m2, before)


def test_regions_that_are_not_rendered_keep_what_they_had(rng):
    """Of a part of the image only the regions in it are added to.

    Only they lose a pixel that turns out bad there.
    """
    regions = image_regions(16, 32, {})
    right = np.array([False, False, True])
    images = rng.random((5, 16, 32, 3))
    moments, film = RegionMoments(regions), Moments.empty((16, 32, 3))
    mask = np.zeros((16, 32), bool)
    mask[:, 16:] = True
    for image in images[:2]:
        moments.add(image)
        film.add(image)
    before = moments.moments.mean.copy()
    for image in images[2:4]:
        part = np.where(mask[..., None], image, np.nan)
        moments.add(part, right)
        film.add(part, mask)
    bad = np.zeros((16, 32), bool)
    bad[3, 20] = True
    moments.exclude(bad, film, right)
    moments.add(np.where((mask & ~bad)[..., None], images[4], np.nan), right)
    assert moments.moments.n.tolist() == [2, 2, 5]
    np.testing.assert_array_equal(moments.moments.mean[:2], before[:2])
    np.testing.assert_allclose(moments.moments.mean[2], images[:, mask & ~bad].mean(axis=(0, 1)), rtol=1e-12)
    assert moments.sizes.tolist() == [512, 256, 255]


def test_an_image_of_one_pixel_is_one_region_twice():
    regions = image_regions(1, 1, {})
    assert regions.kinds == ("image", "block")
    moments = RegionMoments(regions)
    moments.add(np.array([[[1.0, 2.0, 3.0]]]))
    assert moments.moments.mean.tolist() == [[1.0, 2.0, 3.0]] * 2
