# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of the lecture's page against closed forms, and its texts in both languages."""

import json
import re

import numpy as np
import pytest
from etalon.addon.command import cli
from etalon.lib.lecture import captions, facets, inversions, page, slips, uniform
from etalon.lib.lecture.densities import illustrate_densities
from etalon.lib.lecture.figure import Words
from etalon.lib.lecture.quadrature import integrate_normals
from etalon.lib.sampling.sobol import RandomSampler
from etalon.lib.settings.commands import FIGURES


def test_quadrature_has_the_closed_form():
    """The integral of cos^k over the hemisphere is 2 pi / (k + 1)."""
    for k in (1, 3, 6):
        found = integrate_normals(lambda m, k=k: m[2] ** k, 1.0)
        assert found == pytest.approx(2.0 * np.pi / (k + 1), rel=1e-12)


def test_each_density_integrates_to_one():
    curves = illustrate_densities(0).numbers["curves"]
    assert len(curves) == 8
    assert [one["integral"] for one in curves] == pytest.approx([1.0] * 8, abs=1e-10)


def test_visible_normals_all_face_the_observer(seed):
    by_d_cos, visible = facets.illustrate_facets(seed).numbers["drawn"]
    assert visible["facing"] == 1.0
    assert by_d_cos["facing"] < 0.9
    assert by_d_cos["useful"] < visible["useful"]


def test_every_strategy_estimates_the_integral_with_slope_one_half(seed):
    """Every size has the error of one sample over sqrt(N).

    It is so within the spread that 64 replicates leave; a mean is off by < 5 errors.
    """
    truth = uniform.integrate_reflected()
    assert uniform.integrate_reflected(160) == pytest.approx(truth, rel=1e-8)
    u1, u2 = np.random.default_rng(seed).random((2, 1 << 17))
    for strategy in uniform.STRATEGIES:
        values = uniform.estimate(strategy, u1, u2)
        assert abs(values.mean() - truth) < 5.0 * values.std() / np.sqrt(values.size), strategy
        errors = uniform.measure_errors(strategy, RandomSampler, seed, truth)
        expected = values.std() / truth / np.sqrt(uniform.SIZES)
        np.testing.assert_allclose(errors, expected, rtol=0.6, err_msg=strategy)


def test_reflection_widens_a_cell_by_four_cosines():
    """Without the Jacobian of the third slip it would be 1."""
    for cell in ((0, 0), (4, 7), (6, 2)):
        widened, four_cosines = inversions.stretch(*cell)
        assert widened == pytest.approx(four_cosines, rel=1e-3)
        assert widened > 2.0


def test_each_slip_is_decided_by_its_number():
    found = slips.decide()
    assert [one["printed"] for one in found] == pytest.approx([2.0, 0.96 / np.pi, 3.69, np.pi, 4.0], abs=0.01)
    assert [one["right"] for one in found] == pytest.approx([1.0, 1.0, 1.0, 1.0, 0.0], abs=1e-3)
    np.testing.assert_array_equal(slips.reference_at_ends(), [0.0, 0.0, 1.0, 0.0])


def words_of_page():
    """Every text that the page says in words."""
    yield from (value for value in vars(captions).values() if isinstance(value, Words))
    for caption in captions.CAPTIONS.values():
        yield from (caption.title, caption.text)


def test_every_text_is_there_in_both_languages():
    assert tuple(captions.CAPTIONS) == tuple(page.FIGURES) == FIGURES
    for words in words_of_page():
        assert words.english.strip()
        assert words.french.strip()


def test_each_test_that_a_caption_names_exists(request):
    for caption in captions.CAPTIONS.values():
        for place in caption.test.split(", "):
            path, _, name = place.partition("::")
            source = (request.config.rootpath / path).read_text(encoding="utf-8")
            assert f"def {name}(" in source if name else "def test_" in source, place


def test_page_has_numbers_command_and_both_languages_and_loads_nothing(tmp_path, capsys):
    path = tmp_path / "page.html"
    assert cli.main(["illustrate", "--only=inversions", "--seed=3", "--out", str(path), "--json", "--quiet"]) == 0
    text = path.read_text(encoding="utf-8")
    (numbers,) = re.findall(r'<script type="application/json" id="numbers-inversions">(.*?)</script>', text)
    assert json.loads(numbers) == json.loads(capsys.readouterr().out)["inversions"]
    assert "etalon illustrate --only inversions --seed 3" in text
    caption = captions.CAPTIONS["inversions"]
    assert f'<p lang="en">{caption.text.english}' in text
    assert f'<p lang="fr">{caption.text.french}'.replace("'", "&#39;") in text
    assert not re.search(r'(?:src|href)="(?!data:)', text)


def test_unknown_figure_and_a_folder_as_the_page_are_one_line(tmp_path, capsys):
    assert cli.main(["illustrate", "--only=density"]) == 2
    assert "did you mean 'densities'?" in capsys.readouterr().err
    assert cli.main(["illustrate", "--only=slips", "--out", str(tmp_path)]) == 2
    assert "is a folder; name a file" in capsys.readouterr().err
