# SPDX-License-Identifier: GPL-3.0-or-later
"""The verdict in sentences."""

import re
from dataclasses import replace

import numpy as np
from etalon.lib.pages.formats import format_duration, format_percent
from etalon.lib.report.document import document
from etalon.lib.report.words import sentences
from etalon.tests.lib.report.comparisons import PLAN, comparison_of, made, written_page


def test_the_verdict_in_words():
    said = {name: sentences(comparison_of(name)) for name in ("equivalent", "different", "undecided", "one replicate")}
    assert re.fullmatch(
        r"Cycles agrees with the reference to within 0\.\d+ % everywhere \(99 % confidence\)\.", said["equivalent"][0]
    )
    assert said["equivalent"][1].startswith(
        "Within 1 %: the whole image; the only one of the materials; all 2 cells of"
    )
    assert said["different"][0].startswith("Cycles differs from the reference by more than 1 % in ")
    assert "Furthest off: material Test +5" in said["different"][3]
    assert said["undecided"][0].startswith("Cycles agrees with the reference to within ")
    assert said["undecided"][0].endswith("; whether to within 1 % is not decided yet.")
    assert said["undecided"][-1].startswith("Forecast: 1 % everywhere after about ")
    assert any("Fewer than two replicates" in sentence for sentence in said["one replicate"])


def test_a_smaller_image_is_said_to_be_one():
    found = replace(comparison_of("equivalent"), divisor=2)
    (said,) = (s for s in sentences(found) if "narrower" in s)
    assert said.startswith("Compared at 24 x 20 pixels, 2 times narrower and lower than the scene asks for")


def test_caustics_are_said_where_they_keep_a_region_open():
    found = comparison_of("undecided")
    share = np.full(len(found.regions), 0.001)
    share[3] = 0.052
    # Noise keeps all regions open here; caustics are no reason.
    assert not any("Caustics" in s for s in sentences(replace(found, caustics=share)))
    rare = replace(found, caustics=share, verdict=replace(found.verdict, rare=found.verdict.bounds))
    (said,) = (s for s in sentences(rare) if "Caustics" in s)
    assert f"of 1 region, most in block {found.regions.names[3]}: at most 5.2 %" in said


def test_a_blender_newer_than_the_newest_checked_is_reported_in_words_and_figures(tmp_path):
    settings = {"version": "99.1.0", "build": "abc123, 2099-01-01"}
    known = made(settings=settings)
    newer = replace(known, blender=(99, 1))
    (said,) = (s for s in sentences(newer) if "99.1" in s)
    assert said.startswith("Blender 99.1 is newer than")
    assert not any("newer" in s for s in sentences(known))
    figures = document(newer, PLAN, "")["blender"]
    assert figures["is_newer_than_checked"]
    assert not document(known, PLAN, "")["blender"]["is_newer_than_checked"]
    assert (figures["version"], figures["build"]) == ("99.1.0", "abc123, 2099-01-01")
    page = written_page(newer, tmp_path, "")
    assert "Blender 99.1.0 (build abc123, 2099-01-01)" in page
    assert said in page


def test_numbers_in_words():
    assert [format_percent(v) for v in (0.01234, -0.5, float("inf"))] == ["+1.23 %", "-50 %", "unbounded"]
    assert [format_duration(v) for v in (0.5, 42, 600, 7200, 3e5, 1e9)] == [
        "0.5 s",
        "42 s",
        "10 min",
        "2 h",
        "3 days",
        "years",
    ]
