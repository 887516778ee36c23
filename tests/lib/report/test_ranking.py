# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions in order, and the verdict in one line."""

import pytest
from etalon.lib.film.light_passes import LightPass
from etalon.lib.report.document import document
from etalon.lib.report.headline import TEMPLATES, details, headline
from etalon.lib.report.page import GRIDS, URGENCY, order_regions
from etalon.lib.report.ranking import rank_regions
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.report.comparisons import BRIGHTER, CASES, PLAN, comparison_of, made


@pytest.mark.parametrize("case", CASES)
def test_regions_stand_in_the_order_of_the_page(case):
    comparison = comparison_of(case)
    regions = document(comparison, PLAN, "")["regions"]
    there = [k for k in order_regions(regions) if regions[k]["excluded_pixels"] < regions[k]["pixels"]]
    assert [(r.kind, r.name) for r in rank_regions(comparison)] == [
        (regions[k]["kind"], regions[k]["name"]) for k in there
    ]


def test_a_region_has_the_figures_of_the_channel_that_is_furthest_off():
    comparison = comparison_of("different")
    named = next(r for r in rank_regions(comparison) if r.kind == "material")
    assert named.low <= named.difference <= named.high
    assert named.difference == pytest.approx(0.05, rel=0.2)
    assert named.margin >= named.high - named.difference
    assert named.box == (0.0, 0.0, 0.5, 1.0)


def test_the_regions_of_a_part_of_the_light_have_the_figures_of_that_part():
    """The image agrees: what glossy light lacks, diffuse light has."""
    comparison = comparison_of("passes")
    figures = {part["name"]: part["regions"] for part in document(comparison, PLAN, "")["passes"]}
    whole = {(r.kind, r.name) for r in rank_regions(comparison)}
    for part in comparison.passes.passes:
        ranked = rank_regions(comparison, part)
        assert {(r.kind, r.name) for r in ranked} == {one for one in whole if one[0] not in GRIDS}
        assert [URGENCY.index(r.outcome.value) for r in ranked] == sorted(
            URGENCY.index(r.outcome.value) for r in ranked
        )
        assert {r.difference for r in ranked} == {
            one["difference"]["RGB".index(one["channel"])] for one in figures[str(part)]
        }
    assert rank_regions(comparison, LightPass.GLOSSY_INDIRECT)[0].outcome is Outcome.DIFFERENT
    assert rank_regions(comparison)[0].outcome is not Outcome.DIFFERENT


def test_a_part_of_the_light_that_was_not_compared_has_no_regions():
    with pytest.raises(ValueError, match="emission was not compared"):
        rank_regions(comparison_of("passes"), LightPass.EMISSION)


def said(case):
    comparison = comparison_of(case)
    return str(headline(comparison, rank_regions(comparison))), [str(phrase) for phrase in details(comparison)]


def test_the_headline_states_the_bound_where_all_agrees():
    line, below = said("equivalent")
    assert line.startswith("Agrees with Cycles' render within 0.")
    assert line.endswith("everywhere")
    assert below[0].endswith("regions tested, 99 % confidence")


def test_the_headline_names_the_material_that_differs():
    line, below = said("different")
    assert line.startswith("Differs by +5")
    assert line.endswith("on 'Test'")
    assert "regions differ" in below[0]


def test_the_light_that_differs_stands_below_an_image_that_agrees():
    line, below = said("passes")
    assert line.startswith("Agrees")
    assert below[0].startswith("Glossy indirect differs by -5")


def test_the_light_that_differs_is_the_headline_of_an_image_that_differs():
    passes = {LightPass.GLOSSY_INDIRECT: (0.1, 0.15), LightPass.DIFFUSE_DIRECT: (0.9, 0.9)}
    comparison = made(other=BRIGHTER, passes=passes)
    line = str(headline(comparison, rank_regions(comparison)))
    assert line.startswith("Glossy indirect differs by +")
    assert line.endswith("on 'Test'")


def test_a_known_reason_stands_below():
    _, below = said("explained")
    assert below[0] == "For a known reason: known"


def test_noise_and_an_early_end_are_said():
    line, below = said("undecided")
    assert line.startswith("Agrees within ")
    assert line.endswith("so far; 1 % is not decided yet")
    assert any(text.startswith("About ") for text in below)
    assert "Cancelled; this is what was gathered" in said("cancelled")[1]
    assert said("one replicate")[0] == "Too few samples to say anything yet"


@pytest.mark.parametrize("case", CASES)
def test_every_line_is_a_template_with_its_values(case):
    comparison = comparison_of(case)
    for phrase in (headline(comparison, rank_regions(comparison)), *details(comparison)):
        assert phrase.template in TEMPLATES
        assert len(str(phrase)) < 120
