# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a comparison leaves."""

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.film.exr import read_exr
from etalon.lib.report import write_report
from etalon.lib.report.page import averaged
from etalon.tests.lib.report.comparisons import FILES, PLAN, comparison_of


def test_all_files_are_there_and_nothing_else(comparison, tmp_path):
    write_report(comparison, PLAN, tmp_path / "deep" / "out", "etalon compare scene.blend")
    assert {path.name for path in (tmp_path / "deep" / "out").iterdir()} == FILES
    assert all(path.stat().st_size for path in (tmp_path / "deep" / "out").iterdir())


def test_images_on_disk_are_the_films(tmp_path):
    found = comparison_of("non-finite")
    write_report(found, PLAN, tmp_path)
    pixels = np.stack([read_exr(tmp_path / "cycles.exr")[c] for c in "RGB"], axis=2)
    np.testing.assert_allclose(pixels, found.candidate.film.moments.mean, rtol=1e-6)
    assert np.isnan(pixels[2, 5]).all()
    difference = read_exr(tmp_path / "difference.exr")["G"]
    e, c = (side.film.moments.mean[..., 1] for side in (found.reference, found.candidate))
    np.testing.assert_allclose(difference, (c - e) / e, rtol=1e-5, atol=1e-7)


def test_a_failed_write_leaves_what_was_there(tmp_path, monkeypatch):
    write_report(comparison_of("equivalent"), PLAN, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def full(*args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("etalon.lib.report.write.write_png", full)
    with pytest.raises(EtalonError, match=r"cannot be written \(No space left on device\); make room"):
        write_report(comparison_of("different"), PLAN, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_folder_that_is_a_file_is_named(tmp_path):
    (tmp_path / "out").write_text("a file")
    with pytest.raises(EtalonError, match=r"out is a file, not a folder"):
        write_report(comparison_of("equivalent"), PLAN, tmp_path / "out")


def test_large_images_are_averaged_block_by_block(rng):
    image = rng.random((7, 5, 3))
    small = averaged(image, 3)
    assert small.shape == (3, 2, 3)
    np.testing.assert_allclose(small[2, 1], image[6:, 3:].mean(axis=(0, 1)), rtol=1e-12)
    np.testing.assert_allclose(averaged(image, 1), image, rtol=1e-12)


def test_without_exrs_older_ones_go_too(tmp_path):
    write_report(comparison_of("equivalent"), PLAN, tmp_path)
    write_report(comparison_of("equivalent"), PLAN, tmp_path, keep_exrs=False)
    assert {path.name for path in tmp_path.iterdir()} == {name for name in FILES if not name.endswith(".exr")}
