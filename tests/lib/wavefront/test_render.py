# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles, threads, replicates, cancel and progress: nothing of them shows in the image."""

from itertools import pairwise

import numpy as np
import pytest
from etalon.lib.errors import Cancelled
from etalon.lib.film.windows import Windows
from etalon.lib.progress import Progress
from etalon.lib.scene.lights import AreaLight, PointLight
from etalon.lib.scene.materials import Diffuse, Glossy
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer, interleave, tiles
from etalon.tests.chi2 import sidak
from etalon.tests.replicates import assert_same, blocks, replicates
from etalon.tests.scenes import Constant, color, diffuse, floor, icosphere, material, perspective, scene, transparent
from scipy import stats

LIGHTS = [
    AreaLight(
        "area",
        (1.0, 0.0, 3.0),
        (1.0, 0.0, 0.0),
        (0.0, -1.0, 0.0),
        (0.0, 0.0, -1.0),
        "RECTANGLE",
        (9.0, 8.0, 7.0),
        np.pi,
    ),
    PointLight("point", (-2.0, -1.0, 2.0), (3.0, 3.0, 4.0)),
]
CAMERA = perspective(13, 9, 0.6, (0.01, -3.0, 2.5), (0.0, 3.0, -2.2))


def stage(veil=False):
    """A mixed ball on a floor under two lights.

    A transparent sheet over half of it, if wanted.
    """
    mixed = material(Diffuse(color(0.3)), Glossy("GGX", color(0.5), Constant(0.5)))
    parts = [icosphere(1.0, 2), floor(4.0, -1.0, 1)]
    materials = [mixed, diffuse(0.6, 0.5, 0.4)]
    if veil:
        parts.append(floor(0.5, 1.5, 2))
        materials.append(transparent(0.9, 0.8, 0.7))
    return scene(parts, materials, CAMERA, LIGHTS, 0.2, bounces=3)


@pytest.mark.grid(3)
@pytest.mark.parametrize("veil", [False, True])
@pytest.mark.parametrize(
    "options", [{"tile_paths": 64}, {"tile_paths": 1000}, {"threads": 2, "tile_paths": 300}, {"threads": 5}]
)
def test_tiles_and_threads_do_not_show(veil, options, seed):
    """The same samples in another order: equal to rounding."""
    whole = ReferenceRenderer(stage(veil), Options(seed=seed, threads=1)).render(3, 16)
    parted = ReferenceRenderer(stage(veil), Options(seed=seed, **{"threads": 1, **options})).render(3, 16)
    np.testing.assert_allclose(parted.radiance, whole.radiance, rtol=1e-12)
    assert parted.rays == whole.rays
    assert parted.camera_samples == whole.camera_samples == 13 * 9 * 16


@pytest.mark.slow
def test_more_samples_than_a_tile_holds(seed):
    """The samples of one pixel are parted over tiles and added up."""
    whole = ReferenceRenderer(stage(), Options(seed=seed, threads=1)).render(0, 20)
    parted = ReferenceRenderer(stage(), Options(seed=seed, threads=2, tile_paths=12)).render(0, 20)
    np.testing.assert_allclose(parted.radiance, whole.radiance, rtol=1e-12)


@pytest.mark.parametrize("tile_paths", [50, 200, 4096])
def test_a_part_is_the_image_in_that_part(tile_paths, seed):
    renderer = ReferenceRenderer(stage(), Options(seed=seed, threads=2, tile_paths=tile_paths))
    windows = Windows((9, 13), ((2, 1, 6, 2), (6, 2, 12, 8)))
    whole, part = renderer.render(3, 16), renderer.render(3, 16, windows=windows)
    np.testing.assert_allclose(part.radiance, np.where(windows.mask[..., None], whole.radiance, 0.0), rtol=1e-12)
    assert part.camera_samples == 16 * windows.pixels


@pytest.mark.parametrize(
    ("pixels", "samples", "paths"), [(7, 3, 100), (100, 64, 16), (100, 1, 7), (1, 1000, 300), (5, 5, 1)]
)
def test_tiles_cover_every_sample_once(pixels, samples, paths):
    seen = np.zeros((pixels, samples), int)
    for tile in tiles(pixels, samples, paths):
        seen[tile.first : tile.last, tile.start : tile.stop] += 1
        assert (tile.last - tile.first) * (tile.stop - tile.start) <= paths
    assert np.all(seen == 1)


@pytest.mark.parametrize(("width", "height", "parts"), [(13, 9, 3), (480, 270, 2), (7, 31, 5), (4, 3, 7)])
def test_parts_of_interleaved_pixels_share_the_rows_among_them(width, height, parts):
    index = interleave(np.arange(width * height, dtype=np.int32), width, parts)
    assert np.array_equal(np.sort(index), np.arange(width * height))
    if height % parts == 0:
        for part in np.split(index, parts):
            assert np.array_equal(np.diff(np.unique(part // width)), np.full(height // parts - 1, parts))


def test_a_renderer_repeats_itself_and_nobody_else(seed):
    """One seed and replicate, one image; another of either, another image."""
    renderer = ReferenceRenderer(stage(), Options(seed=seed, threads=2))
    first, again, other = (renderer.render(k, 16).radiance for k in (4, 4, 5))
    np.testing.assert_allclose(again, first, rtol=1e-12)
    reseeded = ReferenceRenderer(stage(), Options(seed=seed + 1, threads=2)).render(4, 16).radiance
    lit = np.abs(first - 0.2) > 1e-9  # where more than the bare sky is seen
    assert lit.mean() > 0.5
    for image in (other, reseeded):
        assert np.mean(np.isclose(image, first, rtol=1e-6)[lit]) < 0.01


@pytest.mark.parametrize("sampler", ["sobol", "random"])
def test_replicates_and_pixels_are_uncorrelated(sampler, seed):
    """The verdict's statistics assume this.

    Residuals of one pixel in two replicates, and of two pixels in one, share nothing.
    """
    images = replicates(stage(), 40, 4, sampler=sampler, seed=seed)[..., 1]
    scatter = images.std(axis=0, ddof=1)
    lit = scatter > 1e-6
    residual = np.where(lit, (images - images.mean(axis=0)) / np.where(lit, scatter, 1.0), 0.0)
    # Neighbours: over replicates, each pair of pixels has a mean product of 0.
    for a, b in (
        (residual[:, :, :-1], residual[:, :, 1:]),
        (residual[:, :-1], residual[:, 1:]),
        (residual[:, :, :-4], residual[:, :, 4:]),
    ):
        products = (a * b).mean(axis=0)
        assert stats.ttest_1samp(products[products != 0.0], 0.0).pvalue > sidak(1e-4, 3)
    # Replicates, in pairs of a first and a second half: their images of residuals are orthogonal but for -1 / (n - 1).
    first, second = residual[::2].reshape(20, -1)[:, lit.ravel()], residual[1::2].reshape(20, -1)[:, lit.ravel()]
    assert stats.ttest_1samp((first * second).mean(axis=1), -1.0 / 39.0).pvalue > 1e-4


@pytest.mark.slow
def test_standard_errors_are_honest(seed):
    """The scatter of means of replicates is what the replicates' own variance says.

    Replicates are independent.
    """
    images = blocks(replicates(stage(), 48, 4, seed=seed)[:, :8, :12], 4)
    groups = images.reshape(8, 6, -1).mean(axis=1)
    ratio = (groups.var(axis=0, ddof=1) * 6.0 / images.reshape(48, -1).var(axis=0, ddof=1)).mean()
    assert 0.5 < ratio < 1.6


@pytest.mark.parametrize("veil", [False, True])
def test_replicates_of_any_size_have_one_mean(veil, seed):
    few = blocks(replicates(stage(veil), 16, 8, seed=seed)[:, :8, :12], 4)
    many = blocks(replicates(stage(veil), 8, 32, seed=seed + 1)[:, :8, :12], 4)
    assert_same(few, many, 0.04)


@pytest.mark.parametrize("threads", [1, 3])
def test_progress_grows_to_one(threads, seed):
    told = []
    ReferenceRenderer(stage(), Options(seed=seed, threads=threads, tile_paths=50)).render(0, 16, Progress(told.append))
    assert len(told) > 3
    assert all(0.0 < a <= b for a, b in pairwise(told))
    assert told[-1] == 1.0


@pytest.mark.parametrize("threads", [1, 2])
def test_cancel(threads, seed):
    """Raised soon after it is asked for; the renderer can be used again."""
    renderer = ReferenceRenderer(stage(), Options(seed=seed, threads=threads, tile_paths=50))
    told = []
    with pytest.raises(Cancelled):
        renderer.render(0, 64, Progress(told.append, lambda: len(told) >= 3))
    assert len(told) <= 4
    assert told[-1] < 0.5
    assert np.isfinite(renderer.render(0, 1).radiance).all()


def test_a_rendering_says_what_it_cost(seed):
    rendering = ReferenceRenderer(stage(), Options(seed=seed, threads=1)).render(0, 4)
    assert rendering.seconds > 0.0
    assert rendering.rays > rendering.camera_samples
    assert all(seconds >= 0.0 for seconds in rendering.stages.values())
    assert 0.3 * rendering.seconds < sum(rendering.stages.values()) <= rendering.seconds


def test_the_scene_is_left_alone(seed):
    """A render writes into no array of the scene."""
    the_scene = stage(True)
    arrays = [a for a in vars(the_scene.mesh).values() if isinstance(a, np.ndarray)]
    arrays += [CAMERA.plane_from_raster, CAMERA.world_from_camera]
    flags = [a.flags.writeable for a in arrays]
    for a in arrays:
        a.flags.writeable = False
    try:
        replicates(the_scene, 1, 4, seed=seed)
    finally:
        for a, flag in zip(arrays, flags, strict=True):
            a.flags.writeable = flag
