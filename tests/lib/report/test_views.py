# SPDX-License-Identifier: GPL-3.0-or-later
"""The images for Blender's Image editor."""

import numpy as np
import pytest
from etalon.lib.film.exr import read_exr
from etalon.lib.film.pictures import is_whole_png
from etalon.lib.report.views import NOTHING, OUTCOME_COLOURS, View, verdict_map, write_views
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.report.comparisons import BRIGHTER, CASES, made


def test_radiance_is_written_as_three_float_channels(tmp_path):
    comparison = made(**CASES["different"])
    write_views(comparison, tmp_path / "new")
    channels = read_exr(tmp_path / "new" / View.CYCLES.value)
    assert sorted(channels) == ["B", "G", "R"]
    np.testing.assert_allclose(channels["R"], comparison.candidate.film.moments.mean[..., 0], rtol=1e-6)
    assert {path.name for path in (tmp_path / "new").iterdir()} == {view.value for view in View}


def test_the_verdict_map_shows_the_outcome_of_each_block():
    shown = verdict_map(made(other=BRIGHTER))
    # The left half is 5 % brighter, and blocks of 16 pixels end inside it; the last column lies in the right half.
    assert tuple(shown[0, 0]) == OUTCOME_COLOURS[Outcome.DIFFERENT]
    assert tuple(shown[0, -1]) != OUTCOME_COLOURS[Outcome.DIFFERENT]
    assert NOTHING not in {tuple(pixel) for pixel in shown.reshape(-1, 3).tolist()}


@pytest.mark.parametrize("case", ["nothing finite", "one replicate", "black"])
def test_images_without_numbers_are_written_too(tmp_path, case):
    write_views(made(**CASES[case]), tmp_path)
    assert is_whole_png((tmp_path / View.SIGNIFICANCE.value).read_bytes())
