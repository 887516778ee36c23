# SPDX-License-Identifier: GPL-3.0-or-later
"""The verdict in sentences."""

from dataclasses import replace

from etalon.lib.pages.formats import format_duration, format_percent
from etalon.lib.report.document import document
from etalon.lib.report.words import sentences
from etalon.tests.lib.report.comparisons import CASES, PLAN, made, written_page


def test_the_verdict_in_words():
    said = {name: sentences(made(**CASES[name])) for name in ("equivalent", "different", "undecided", "one replicate")}
    assert said["equivalent"][0] == "Cycles agrees with the reference to within 1 % in all 6 regions."
    assert said["different"][0].startswith("Cycles differs from the reference by more than 1 % in ")
    assert "Furthest off: material Test +5" in said["different"][2]
    assert said["undecided"][0] == "Whether Cycles agrees with the reference to within 1 % is not decided."
    assert said["undecided"][-1].startswith("Deciding the 6 open regions takes ")
    assert any("Fewer than two replicates" in sentence for sentence in said["one replicate"])


def test_a_smaller_image_is_recommended_where_a_large_one_takes_long(monkeypatch):
    found = made(**CASES["undecided"])
    advice = "--set scene.render.resolution_percentage=25"
    assert advice not in sentences(found)[-1]
    monkeypatch.setattr("etalon.lib.report.words.LARGE", 400)
    slow = replace(found, round_seconds=1e3)
    assert advice in sentences(slow)[-1]
    assert advice not in sentences(replace(found, round_seconds=1e-6))[-1]


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
