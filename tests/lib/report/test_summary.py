# SPDX-License-Identifier: GPL-3.0-or-later
"""The three sentences for an artist."""

from dataclasses import replace

import pytest
from etalon.lib.report.document import document
from etalon.lib.report.headline import headline
from etalon.lib.report.ranking import rank_regions
from etalon.lib.report.summary import describe_box, next_step, summarize
from etalon.lib.report.words import sentences
from etalon.lib.scene.findings import OVERLAPPING_FACES, OVERLAPPING_LIGHTS, Finding
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.report.comparisons import BRIGHTER, CASES, PLAN, comparison_of, made


def summary(case):
    return summarize(replace(comparison_of(case), scene="kitchen.blend"))


def test_a_picture_that_agrees_asks_for_nothing():
    first, second, third = summary("equivalent")
    assert first.startswith("kitchen.blend: EQUIVALENT. Cycles agrees with the reference to within 0.")
    assert second.startswith("No part of the picture is off by more than 1 %: ")
    assert third == "Next: nothing is left to do."


def test_a_difference_is_placed_and_signed():
    # The left half is 5 % brighter in Cycles, hence the whole 2.5 %; the material covers that half.
    first, second, third = summary("different")
    assert first.startswith("kitchen.blend: DIFFERENT. The whole picture is 2.")
    assert "brighter in Cycles than in the reference" in first
    assert "most of all material Test (+5" in second
    assert "of the picture (+" in second
    assert third.startswith("Next: look at these places in the report.")


def test_another_model_of_glossy_nodes_is_named_beside_the_difference_that_it_makes():
    comparison = comparison_of("different")
    settings = {**comparison.reference.settings, "model": "ward", "fresnel": "schlick"}
    _, second, third = summarize(replace(comparison, reference=replace(comparison.reference, settings=settings)))
    assert second.endswith("Glossy nodes have another model in the reference, by choice: ward, Fresnel schlick.")
    assert third.endswith("compare without the other model of Glossy nodes, too.")


def test_an_explained_difference_names_its_cause():
    *_, third = summary("explained")
    assert third.startswith("Next: nothing is wrong in your scene.")
    assert "(known)" in third


def test_what_is_explained_while_other_regions_are_open_is_no_agreement():
    """No text speaks of agreement up to a bound where regions are shown to differ."""
    found = comparison_of("explained")
    outcomes = found.verdict.outcomes.copy()
    outcomes[-1] = Outcome.UNDECIDED
    found = replace(found, verdict=replace(found.verdict, outcome=Outcome.UNDECIDED, outcomes=outcomes))
    first, second, _ = summarize(found)
    assert first.startswith("Test: UNDECIDED. The whole picture is 2.")
    assert " differ by more than 1 %, most of all material Test (+5" in second
    said = sentences(found)
    assert said[0].startswith("Cycles differs from the reference by more than 1 % in ")
    assert any(one.startswith("Furthest off: material Test +5") for one in said)
    assert str(headline(found, rank_regions(found))).startswith("Differs by +5")


def test_noise_is_placed_and_its_remedy_is_a_time():
    first, second, third = summary("undecided")
    assert first.startswith("kitchen.blend: UNDECIDED. Cycles agrees with the reference to within ")
    assert first.endswith(" everywhere, with 99 % confidence; whether to within 1 % is not known yet.")
    assert "too noisy to judge, most of all " in second
    assert third.startswith("Next: allow about ")


def test_a_bound_that_excludes_nothing_is_no_agreement():
    """Of 320 times the reference nobody says that it agrees."""
    found = comparison_of("undecided")
    bounds = found.verdict.bounds.copy()
    bounds[-1] = 320.0
    found = replace(found, verdict=replace(found.verdict, bound=float(bounds.max()), bounds=bounds))
    first, second, _ = summarize(found)
    assert first.startswith("Test: UNDECIDED. As a whole, the picture agrees to within ")
    assert "too noisy to judge" in second
    assert sentences(found)[0] == (
        "Whether Cycles agrees with the reference is not known yet: somewhere the bound on the difference is 32000 %."
    )
    bounds[0] = 1.5
    first, *_ = summarize(replace(found, verdict=replace(found.verdict, bound=float(bounds.max()), bounds=bounds)))
    assert first == "Test: UNDECIDED. There are too few samples to say anything about the whole picture."


def test_what_was_cancelled_is_to_be_run_again():
    assert summary("cancelled")[2] == "Next: run it again and let it finish; it was cancelled."


@pytest.mark.parametrize("case", CASES)
def test_a_summary_has_three_short_sentences_without_options_of_the_command_line(case):
    said = summary(case)
    assert len(said) == 3
    for sentence in said:
        assert "--" not in sentence
        assert "1 regions" not in sentence
        assert len(sentence) < 260


@pytest.mark.parametrize("case", CASES)
def test_the_file_of_figures_has_the_same_summary(case):
    found = comparison_of(case)
    assert tuple(document(found, PLAN, "")["summary"]) == summarize(found)


def test_a_place_in_the_picture_is_named_as_a_person_points():
    boxes = {
        (0, 0, 9, 9): "top left",
        (14, 14, 15, 15): "centre",
        (28, 14, 29, 15): "right",
        (14, 28, 15, 29): "bottom",
    }
    assert {box: describe_box(box, (30, 30)) for box in boxes} == boxes


def test_a_fault_of_the_scene_is_named_with_its_remedy():
    """Not that nothing is wrong in the scene, where overlapping faces are the cause."""
    finding = Finding(
        OVERLAPPING_FACES, "Faces share a plane: 'Rug' and 'Floor' (4 m²).", "They hide light.", "Move one."
    )
    found = made(other=BRIGHTER, effects={"known": 0.05}, finding=OVERLAPPING_FACES)
    assert "nothing is wrong in your scene" in next_step(found)
    told = next_step(replace(found, findings=(finding,)))
    assert (
        told == "Next: repair the scene, then compare again. Faces share a plane: 'Rug' and 'Floor' (4 m²). Move one."
    )
    other = made(other=BRIGHTER, effects={"known": 0.05})
    assert "nothing is wrong in your scene" in next_step(replace(other, findings=(finding,)))


def test_another_fault_of_the_scene_is_named_by_its_check():
    faces = Finding(OVERLAPPING_FACES, "Faces share a plane.", "They hide light.", "Move one.")
    lights = Finding(OVERLAPPING_LIGHTS, "Area lights share a plane.", "Light is lost.", "Move one.")
    found = made(other=BRIGHTER, effects={"known": 0.05}, finding=OVERLAPPING_FACES)
    why = found.explanation
    other = replace(why.departures[0], name="other", finding=OVERLAPPING_LIGHTS)
    why = replace(why, departures=(*why.departures, other), chosen=(*why.chosen, "other"))
    said = next_step(replace(found, findings=(faces, lights), explanation=why))
    assert said == (
        "Next: repair the scene, then compare again. Faces share a plane. Move one. "
        "The scene check names overlapping lights, too."
    )
