# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of light passes."""

from dataclasses import replace

import pytest
from etalon.lib.comparison.parts import PassChoice, WhyNot
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.parts import WORLD, BounceLimit, EmitterLight
from etalon.lib.report.document import document
from etalon.lib.report.headline import details
from etalon.lib.report.passes import pass_figures, pass_sentences
from etalon.lib.report.words import sentences
from etalon.tests.lib.report.comparisons import CASES, PLAN, comparison_of, made
from etalon.tests.lib.report.test_document import SCHEMA
from jsonschema import Draft202012Validator

OFF = {LightPass.GLOSSY_INDIRECT: (0.1, 0.095), LightPass.DIFFUSE_DIRECT: (0.9, 0.9)}


def test_the_pass_that_differs_is_named_and_the_others_are_bounded():
    comparison = comparison_of("passes")
    first, second = pass_sentences(comparison)
    assert first.startswith("The glossy indirect pass differs by -")
    assert "All other passes agree to within" in second
    assert first in sentences(comparison)


def test_all_that_agree_are_bounded_together():
    (only,) = pass_sentences(made(passes={light: (a, a) for light, (a, _) in OFF.items()}))
    assert only.startswith("All light passes agree to within")


def test_too_few_samples_are_said_to_be_too_few():
    (only,) = pass_sentences(comparison_of("noisy passes"))
    assert only == "Too few samples to judge: emission."


def test_nothing_is_said_where_no_pass_was_compared():
    comparison = comparison_of("equivalent")
    assert pass_sentences(comparison) == []
    assert pass_figures(comparison) is None


@pytest.mark.parametrize("why", WhyNot)
def test_passes_that_the_default_leaves_out_are_told_with_the_reason(why):
    """In words, in the panel's lines and in the figures, which follow their schema."""
    comparison = replace(
        comparison_of("equivalent"),
        pass_choice=PassChoice("auto", cost=0.139627 if why is WhyNot.COST else None, why_not=why),
    )
    (said,) = pass_sentences(comparison)
    assert said in sentences(comparison)
    assert said.startswith("Light passes were not compared: ")
    assert ("they would take about 14 % of Cycles' time. `--passes=all` compares them." in said) == (why is WhyNot.COST)
    assert str(details(comparison)[-1]).startswith("Light passes were not compared: ")
    figures = document(comparison, PLAN, "")
    assert figures["pass_choice"]["why_not"] == why.value
    Draft202012Validator(SCHEMA).validate(figures)


def test_an_image_without_a_finite_pixel_has_no_bound():
    (only,) = pass_sentences(made(change=CASES["nothing finite"]["change"], passes=OFF))
    assert only == "Too few samples to judge: glossy indirect and diffuse direct."


def limits(*factors):
    """Parts for images with up to 0, 1, 2, ... bounces.

    Cycles has `factors` times their light.
    """
    return {BounceLimit(k): (0.4 + 0.3 * k, (0.4 + 0.3 * k) * factor) for k, factor in enumerate(factors)}


def test_the_bounce_at_which_they_part_is_named():
    (only,) = pass_sentences(made(passes=limits(1.0, 1.05, 1.04)))
    assert only.startswith("The renderers part at bounce 1: with fewer the images agree to within 0.")
    assert ", with up to 1 bounce they differ by +" in only


def test_a_difference_without_any_bounce_is_said_to_be_one():
    (only,) = pass_sentences(made(passes=limits(1.05, 1.0)))
    assert only.startswith("The images differ with up to 0 bounces, the fewest that were compared, by +")


def test_limits_that_agree_are_bounded():
    (only,) = pass_sentences(made(passes=limits(1.0, 1.0)))
    assert only.startswith("With up to 1 bounce and with fewer the images agree to within 0.")
    (few,) = pass_sentences(made(passes=limits(1.0), replicates=1))
    assert few == "Too few samples to judge images with fewer bounces."


def test_the_light_that_differs_is_named_beside_the_passes():
    parts = {EmitterLight("Key"): (0.3, 0.285), WORLD: (0.7, 0.7)} | {light: (a, a) for light, (a, _) in OFF.items()}
    comparison = made(passes=parts)
    passes, key, others = pass_sentences(comparison)
    assert passes.startswith("All light passes agree to within")
    assert key.startswith("The light of 'Key' differs by -")
    assert others.startswith("All other lights agree to within")
    kinds = [(part["kind"], part["name"]) for part in pass_figures(comparison)]
    assert kinds[:2] == [("light", "light of 'Key'"), ("light", "light of the world")]
