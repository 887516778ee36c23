# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of light passes."""

from etalon.lib.film.light_passes import LightPass
from etalon.lib.report.passes import pass_figures, pass_sentences
from etalon.lib.report.words import sentences
from etalon.tests.lib.report.comparisons import CASES, made

OFF = {LightPass.GLOSSY_INDIRECT: (0.1, 0.095), LightPass.DIFFUSE_DIRECT: (0.9, 0.9)}


def test_the_pass_that_differs_is_named_and_the_others_are_bounded():
    comparison = made(**CASES["passes"])
    first, second = pass_sentences(comparison)
    assert first.startswith("The glossy indirect pass differs by -")
    assert "All other passes agree to within" in second
    assert first in sentences(comparison)


def test_all_that_agree_are_bounded_together():
    (only,) = pass_sentences(made(passes={light: (a, a) for light, (a, _) in OFF.items()}))
    assert only.startswith("All light passes agree to within")


def test_too_few_samples_are_said_to_be_too_few():
    (only,) = pass_sentences(made(**CASES["noisy passes"]))
    assert only == "Too few samples to judge: emission."


def test_nothing_is_said_where_no_pass_was_compared():
    comparison = made()
    assert pass_sentences(comparison) == []
    assert pass_figures(comparison) is None


def test_an_image_without_a_finite_pixel_has_no_bound():
    (only,) = pass_sentences(made(change=CASES["nothing finite"]["change"], passes=OFF))
    assert only == "Too few samples to judge: glossy indirect and diffuse direct."
