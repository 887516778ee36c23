# SPDX-License-Identifier: GPL-3.0-or-later
"""The images for Blender's Image editor."""

import numpy as np
import pytest
from etalon.lib.film.exr import read_exr
from etalon.lib.film.light_passes import LightPass
from etalon.lib.report.views import (
    MOST,
    NOTHING,
    OUTCOME_COLOURS,
    View,
    signed_colours,
    verdict_map,
    write_interim,
    write_views,
)
from etalon.lib.srgb import srgb_encode
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.report.comparisons import BRIGHTER, comparison_of, made


def test_radiance_is_written_as_three_float_channels(tmp_path):
    comparison = comparison_of("different")
    write_views(comparison, tmp_path / "new")
    channels = read_exr(tmp_path / "new" / View.CYCLES.value)
    assert sorted(channels) == ["B", "G", "R"]
    np.testing.assert_allclose(channels["R"], comparison.candidate.film.moments.mean[..., 0], rtol=1e-6)
    assert {path.name for path in (tmp_path / "new").iterdir()} == {view.value for view in View}


def test_difference_is_written_without_a_limit_above(tmp_path):
    write_views(made(other=10.0 * BRIGHTER, sigma=0.0), tmp_path)
    channels = read_exr(tmp_path / View.DIFFERENCE.value)
    # 950 % and 900 % brighter, in units of five times the tolerance of 1 %.
    np.testing.assert_allclose(channels["R"][0, [0, -1]], [9.5 / 0.05, 9.0 / 0.05], rtol=1e-6)
    assert not channels["G"].any()
    assert not channels["B"].any()


def test_what_is_darker_is_blue_and_what_has_no_number_is_magenta():
    values = np.array([[[-0.02] * 3, [np.nan, 0.0, 0.0], [np.inf] * 3]])
    expected = [[(0.0, 0.0, 2.0), (1.0, 0.0, 1.0), (MOST, 0.0, 0.0)]]
    np.testing.assert_allclose(signed_colours(values, 0.01), expected)


def test_the_verdict_map_shows_the_outcome_of_each_block(tmp_path):
    comparison = made(other=BRIGHTER)
    shown = verdict_map(comparison.regions, comparison.verdict.outcomes)
    # The left half is 5 % brighter, and blocks of 16 pixels end inside it; the last column lies in the right half.
    assert tuple(shown[0, 0]) == OUTCOME_COLOURS[Outcome.DIFFERENT]
    assert tuple(shown[0, -1]) != OUTCOME_COLOURS[Outcome.DIFFERENT]
    assert NOTHING not in {tuple(pixel) for pixel in shown.reshape(-1, 3).tolist()}
    write_views(comparison, tmp_path)
    written = read_exr(tmp_path / View.VERDICT.value)
    decoded = np.stack([written[name] for name in "RGB"], axis=2)
    np.testing.assert_allclose(255.0 * srgb_encode(decoded), shown, atol=1e-3)


def test_all_images_are_written_at_each_look(tmp_path):
    states = []

    def show(interim):
        write_interim(interim, tmp_path)
        states.append(read_exr(tmp_path / View.DIFFERENCE.value)["R"][:, :8].mean())

    comparison = made(other=BRIGHTER, sigma=0.4, show=show)
    assert len(states) > 1
    assert {path.name for path in tmp_path.iterdir()} == {view.value for view in View}
    views = View.REFERENCE, View.DIFFERENCE, View.SIGNIFICANCE
    last = [read_exr(tmp_path / view.value) for view in views]
    write_views(comparison, tmp_path)
    np.testing.assert_equal([read_exr(tmp_path / view.value) for view in views], last)


@pytest.mark.parametrize("case", ["nothing finite", "one replicate", "black", "light on black"])
def test_images_without_numbers_are_written_too(tmp_path, case):
    write_views(comparison_of(case), tmp_path)
    assert np.isfinite(read_exr(tmp_path / View.SIGNIFICANCE.value)["R"]).all()


def test_the_images_of_a_part_of_the_light_show_it_alone(tmp_path):
    """Radiance, difference and significance are the pass's; the verdict stays the image's."""
    comparison = comparison_of("passes")
    write_views(comparison, tmp_path / "all")
    write_views(comparison, tmp_path / "pass", LightPass.GLOSSY_INDIRECT)
    shown, whole = ({view: read_exr(tmp_path / name / view.value) for view in View} for name in ("pass", "all"))
    mean = comparison.candidate.pass_films[LightPass.GLOSSY_INDIRECT].mean[..., 0]
    np.testing.assert_allclose(shown[View.CYCLES]["R"], mean, rtol=1e-6)
    # 5 % darker: blue, and full colour at 5 %; the floor of the image is below the pass.
    assert shown[View.DIFFERENCE]["B"].mean() == pytest.approx(1.0, abs=0.1)
    assert shown[View.SIGNIFICANCE]["B"].mean() > 3.0 * whole[View.SIGNIFICANCE]["B"].mean()
    np.testing.assert_equal(shown[View.VERDICT], whole[View.VERDICT])
