# SPDX-License-Identifier: GPL-3.0-or-later
"""Films of replicates, and their files."""

import numpy as np
import OpenImageIO
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.film.exr import DIFFERENCE, RADIANCE, read_exr, write_exr, write_film
from etalon.lib.film.film import Film
from etalon.lib.film.pictures import hatched, middle_exposure, signed8, srgb8
from etalon.lib.film.rendering import Rendering
from etalon.lib.film.windows import Windows


def rendering(radiance, nonfinite=None, **more):
    counts = np.zeros(radiance.shape[:2], int) if nonfinite is None else nonfinite
    return Rendering(radiance, counts, 0.5, {"trace": 0.4}, 10, 20, **more)


def test_a_film_adds_up_what_its_replicates_cost(rng):
    images = rng.random((3, 4, 5, 3))
    film = Film.empty(4, 5, samples=8)
    for image in images:
        film.add(rendering(image))
    np.testing.assert_allclose(film.moments.mean, images.mean(axis=0), rtol=1e-14)
    np.testing.assert_allclose(film.moments.variance, images.var(axis=0, ddof=1), rtol=1e-12)
    assert film.seconds == 1.5
    assert film.stages == {"trace": pytest.approx(1.2)}
    assert (film.camera_samples, film.rays) == (30, 60)


def test_images_of_another_size_are_refused_with_both_sizes():
    with pytest.raises(EtalonError, match="6 x 4 pixels, the other 5 x 4; render both at the same size"):
        Film.empty(4, 5, 1).add(rendering(np.ones((4, 6, 3))))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_counted_and_never_averaged_away(bad):
    image = np.ones((2, 2, 3))
    image[0, 1, 2] = bad
    film = Film.empty(2, 2, 4)
    film.add(rendering(image))
    film.add(rendering(np.ones((2, 2, 3))))
    assert np.isnan(film.moments.mean[0, 1]).all()
    assert film.nonfinite.tolist() == [[0, 1], [0, 0]]
    assert (film.moments.mean[1] == 1).all()


def test_a_part_of_the_image_adds_to_that_part(rng):
    windows = Windows((4, 5), ((1, 0, 2, 1),))
    images = rng.random((3, 4, 5, 3))
    film = Film.empty(4, 5, 1)
    film.add(rendering(images[0]))
    for image in images[1:]:
        film.add(rendering(np.where(windows.mask[..., None], image, np.nan), windows=windows))
    assert (film.moments.n == np.where(windows.mask, 3, 1)).all()
    assert not film.nonfinite.any()
    np.testing.assert_allclose(film.moments.mean[windows.mask], images[:, windows.mask].mean(axis=0), rtol=1e-14)
    np.testing.assert_array_equal(film.moments.mean[~windows.mask], images[0, ~windows.mask])


def test_samples_that_a_renderer_discarded_count_too():
    film = Film.empty(1, 2, 4)
    film.add(rendering(np.ones((1, 2, 3)), np.array([[0, 3]])))
    assert film.nonfinite.tolist() == [[0, 3]]
    assert np.isnan(film.moments.mean[0, 1]).all()


def test_negative_radiance_is_a_number():
    film = Film.empty(1, 1, 1)
    film.add(rendering(np.full((1, 1, 3), -0.25)))
    assert (film.moments.mean == -0.25).all()


def test_an_exr_gives_back_what_was_written(tmp_path, rng):
    image = rng.standard_normal((3, 4)).astype(np.float32)
    image[0, 0], image[0, 1], image[0, 2] = np.nan, np.inf, -1.0
    write_exr(tmp_path / "a.exr", {"R": image, "error.R": 2 * image}, RADIANCE)
    channels = read_exr(tmp_path / "a.exr")
    np.testing.assert_array_equal(channels["R"], image)
    np.testing.assert_array_equal(channels["error.R"], 2 * image)
    assert [p.name for p in tmp_path.iterdir()] == ["a.exr"]


def test_a_film_on_disk_has_its_errors_and_samples(tmp_path):
    film = Film.empty(1, 2, 4)
    for value in (1.0, 3.0):
        film.add(rendering(np.full((1, 2, 3), value), np.array([[0, 1]])))
    write_film(tmp_path / "film.exr", film)
    channels = read_exr(tmp_path / "film.exr")
    assert channels["G"][0, 0] == 2.0
    assert channels["error.G"][0, 0] == pytest.approx(np.sqrt(2.0 / 2))
    assert channels["samples"].tolist() == [[8.0, 6.0]]
    assert np.isnan(channels["R"][0, 1])


def read_attributes(path):
    file = OpenImageIO.ImageInput.open(str(path))
    found = {attribute.name: attribute.value for attribute in file.spec().extra_attribs}
    file.close()
    return found


def test_an_image_of_radiance_says_its_unit_and_its_colour_space(tmp_path):
    film = Film.empty(1, 2, 4)
    film.add(rendering(np.ones((1, 2, 3))))
    write_film(tmp_path / "film.exr", film)
    found = read_attributes(tmp_path / "film.exr")
    # ITU-R BT.709-6, item 1.3: red, green, blue, and D65.
    assert found["chromaticities"] == pytest.approx([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329])
    assert (found["unit"], found["colorInteropID"]) == ("W m^-2 sr^-1", "lin_rec709_scene")
    assert "scene-linear Rec. 709" in found["ImageDescription"]


def test_an_image_of_differences_says_that_it_holds_no_colours(tmp_path):
    write_exr(tmp_path / "difference.exr", {"R": np.zeros((2, 2))}, DIFFERENCE)
    found = read_attributes(tmp_path / "difference.exr")
    assert (found["unit"], found["colorInteropID"]) == ("1", "data")
    assert "chromaticities" not in found


def test_files_that_cannot_be_written_or_read_say_so(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(EtalonError, match=r"cannot be written|not a folder"):
        write_exr(tmp_path / "file" / "a.exr", {"R": np.zeros((2, 2))}, RADIANCE)
    with pytest.raises(EtalonError, match="cannot be read"):
        read_exr(tmp_path / "none.exr")
    (tmp_path / "text.exr").write_text("no image")
    with pytest.raises(EtalonError, match="cannot be read"):
        read_exr(tmp_path / "text.exr")


def test_views_for_the_eye():
    image = np.array([[[0.0] * 3, [1.0] * 3, [0.5] * 3, [-1.0] * 3, [np.nan] * 3]])
    # IEC 61966-2-1: 0.5 is code value 187.5 of 255.
    assert srgb8(image)[0, :, 0].tolist() == [0, 255, 188, 0, 255]
    assert srgb8(image)[0, 4].tolist() == [255, 0, 255]
    colours = signed8(np.array([[-9.0, 0.0, 9.0, np.nan]]), 1.0)[0]
    assert colours[0][2] > colours[0][0]
    assert colours[2][0] > colours[2][2]
    assert colours[1].tolist() == [247] * 3
    assert colours[3].tolist() == [255, 0, 255]
    assert middle_exposure(np.full((4, 4, 3), 0.25)) == 2.0
    assert middle_exposure(np.zeros((4, 4, 3))) == 0.0
    assert middle_exposure(np.full((4, 4, 3), np.nan)) == 0.0


def test_what_is_left_out_is_hatched_and_nothing_else():
    view, where = np.full((8, 9, 3), 7, np.uint8), np.zeros((8, 9), bool)
    where[2:6, 1:] = True
    shown = hatched(view, where)
    assert (shown[~where] == 7).all()
    assert {tuple(color) for color in shown[where].tolist()} == {(255, 0, 255), (128, 0, 128)}
    assert (shown[2:6, 8] != shown[2:6, 4]).any()
    assert (view == 7).all()
