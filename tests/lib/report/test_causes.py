# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of causes, in sentences and figures."""

import re
from dataclasses import replace

import pytest
from etalon.lib.report.document import document
from etalon.lib.report.scene_check import scene_check_lines
from etalon.lib.report.words import sentences
from etalon.lib.scene.findings import Finding
from etalon.lib.verdict.causes import State
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.renderers import grey
from etalon.tests.lib.report.comparisons import BRIGHTER, HOSTILE, PLAN, Page, comparison_of, made, written_page

SAID = {
    "explained": (
        State.CAUSE,
        r"Cause: known. It is sufficient to explain every region that differs: with it, the reference agrees with Cycles to within 1 %, "
        r"and accounts for [\d.]+ % of the difference in material Test \([\d.]+ % to [\d.]+ %\).",
    ),
    "likely": (
        State.LIKELY,
        r"Likely cause, not proved yet: known. It accounts for [\d.]+ % of the difference in material Test \([\d.]+ % to [\d.]+ %, "
        r"99 % confidence for this share alone\). A proof should take about .* in all, [\d.]+ times the replicates.",
    ),
    "partial": (
        State.PARTIAL,
        r"Partial cause: known. It accounts for [\d.]+ % of the difference in material Test \([\d.]+ % to [\d.]+ %\); "
        r"\+[\d.]+ % is left over there, in [RGB].",
    ),
    "no reason": (
        State.NO_REASON,
        r"Unexplained: \d regions differ for no known reason. Tried: known and other; each is shown to account for less than 20 % of the "
        r"difference.",
    ),
    "none applies": (
        State.NO_DEPARTURE,
        r"Unexplained: \d regions differ, and no known departure of Cycles applies to this scene.",
    ),
    "cancelled": (
        State.NO_TIME,
        r"Unexplained: \d regions differ. The departures that apply \(known\) were not measured: the comparison was cancelled.",
    ),
}


@pytest.mark.parametrize("case", SAID)
def test_what_is_known_of_causes_is_said_in_words_and_figures(case, tmp_path):
    state, words = SAID[case]
    found = comparison_of(case)
    assert found.explanation.state is state
    said = [sentence for sentence in sentences(found) if re.fullmatch(words, sentence)]
    assert len(said) == 1, sentences(found)
    figures = document(found, PLAN, "")
    assert figures["attribution"]["state"] == state.value
    assert said[0] in figures["attribution"]["sentences"]
    assert figures["unexplained"] == (0 if state is State.CAUSE else found.verdict.count(Outcome.DIFFERENT))
    assert said[0] in Page(written_page(found, tmp_path, "")).shown


def test_a_difference_whose_causes_were_not_sought_is_said_to_be_unexplained():
    found = comparison_of("different")
    count = found.verdict.count(Outcome.DIFFERENT)
    assert f"Unexplained: {count} regions differ. Departures were not searched." in sentences(found)
    assert document(found, PLAN, "")["attribution"]["state"] == "not searched"


def test_where_nothing_differs_no_cause_is_spoken_of():
    found = comparison_of("equivalent")
    figures = document(found, PLAN, "")
    assert (figures["attribution"], figures["unexplained"]) == (None, 0)


def test_one_region_differs_in_the_singular():
    other = grey()
    other[16:, 16:] *= 1.1
    found = made(other=other, coverage={}, effects={})
    assert found.verdict.count(Outcome.DIFFERENT) == 1
    assert "Unexplained: 1 region differs, and no known departure of Cycles applies to this scene." in sentences(found)


def test_departures_that_do_the_same_are_rivals():
    found = made(other=BRIGHTER, effects={"known": 0.05, "twin": 0.05})
    assert found.verdict.outcome is Outcome.EXPLAINED
    assert any(
        re.fullmatch(r"(known or twin|twin or known): the data do not tell them apart.", sentence)
        for sentence in sentences(found)
    )
    assert len(document(found, PLAN, "")["attribution"]["rivals"]) == 1


def test_what_explains_some_regions_is_named_beside_those_that_differ_for_no_known_reason():
    """The left half has the departure.

    A corner of the right one is brighter for a reason of its own.
    """
    other = BRIGHTER.copy()
    other[16:, 16:] *= 1.1
    found = made(other=other, coverage={}, effects={"known": 0.05}, sigma=0.01)
    said = sentences(found)
    assert any(
        re.search(r"^Partial cause: known\..* It explains \d of the \d regions that differ\.", s) for s in said
    ), said
    assert any(re.search(r"^Unexplained: \d regions? differs? ", s) for s in said), said


@pytest.mark.parametrize(
    ("upper", "lower", "known", "state"), [(1.1, 1.04, 0.065, State.PARTIAL), (1.12, 0.97, 0.05, State.RULED_OUT)]
)
def test_a_departure_that_fits_the_whole_but_not_its_parts_is_said_not_to_be_the_whole_cause(
    upper, lower, known, state
):
    """The left differs by one part above and another below.

    The departure adds a part to all of it, about as much as both together.
    """
    truth, other = grey(height=24), grey(height=24)
    other[:10, :12] *= upper
    other[10:, :12] *= lower
    found = made(truth=truth, other=other, effects={"known": known}, sigma=0.01)
    assert found.explanation.state is state
    said = " ".join(sentences(found))
    pattern = (
        r"known is not the whole cause: it fits .*, but accounts for -?[\d.]+ % of the difference in block x 0 to 15"
    )
    assert re.search(pattern, said), said


@pytest.mark.parametrize(
    ("case", "reasons"),
    [
        ("equivalent", {None}),
        ("explained", {"departures", None}),
        ("no reason", {"unexplained", None}),
        ("likely", {"likely departures", None}),
    ],
)
def test_every_difference_has_a_reason_in_the_figures(case, reasons):
    figures = document(comparison_of(case), PLAN, "")
    assert {region["reason"] for region in figures["regions"]} == reasons
    for region in figures["regions"]:
        assert (region["reason"] is None) == (region["outcome"] in ("EQUIVALENT", "UNDECIDED"))


def test_what_rounding_decides_is_put_down_to_the_scene():
    """A difference of 5 % where rounding decides how much of a departure acts.

    The whole departure would make 12 %.
    """
    found = made(other=BRIGHTER, effects={"known": 0.12}, sigma=0.01, by_rounding=True)
    assert found.verdict.outcome is Outcome.EXPLAINED
    figures = document(found, PLAN, "")
    assert figures["attribution"]["state"] == "explained by rounding"
    assert {region["reason"] for region in figures["regions"]} == {"scene", None}
    assert figures["unexplained"] == 0
    assert any(s.startswith("Explained by the scene: known. Rounding") for s in sentences(found))
    without = made(other=BRIGHTER, effects={"known": 0.12}, sigma=0.01)
    assert without.verdict.outcome is Outcome.DIFFERENT


def test_findings_of_the_scene_check_stand_in_the_figures_and_on_the_page(tmp_path):
    finding = Finding("overlapping faces", f"'{HOSTILE}' and 'Floor' (4 m²).", "They hide light.", "Move one.")
    found = replace(comparison_of("equivalent"), findings=(finding,))
    assert document(found, PLAN, "")["scene_check"] == [vars(finding)]
    shown = Page(written_page(found, tmp_path, "")).shown
    for text in vars(finding).values():
        assert text in shown
    lines = scene_check_lines(found.findings)
    assert lines == ["scene check", f"  overlapping faces: {finding.what}", "    They hide light. Move one."]
    assert scene_check_lines(()) == []
