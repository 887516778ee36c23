# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures of a comparison: under their schema, and read back."""

import json
from pathlib import Path

import pytest
from etalon.lib import report as package
from etalon.lib.errors import EtalonError
from etalon.lib.report import write_report
from etalon.lib.report.document import CHANGES, VERSION, document
from etalon.lib.report.read import read_verdict
from etalon.tests.lib.report.comparisons import PLAN, comparison_of
from jsonschema import Draft202012Validator

SCHEMA = json.loads((Path(package.__file__).parent / "verdict.schema.json").read_text(encoding="utf-8"))


def test_the_schema_is_one():
    Draft202012Validator.check_schema(SCHEMA)


def test_figures_are_what_the_schema_says(comparison):
    figures = json.loads(json.dumps(document(comparison, PLAN, "etalon compare"), allow_nan=False))
    errors = [f"{list(e.absolute_path)}: {e.message[:200]}" for e in Draft202012Validator(SCHEMA).iter_errors(figures)]
    assert errors == []
    assert figures["exit_code"] == comparison.verdict.outcome.exit_code


def test_the_schema_notices_what_is_amiss():
    figures = json.loads(json.dumps(document(comparison_of("equivalent"), PLAN, "")))
    valid = Draft202012Validator(SCHEMA).is_valid
    assert valid(figures)
    for broken in ({"version": 2}, {"verdict": "FINE"}, {"tolerance": 0}, {"surplus": 1}, {"regions": [{}]}):
        assert not valid(figures | broken)
    assert not valid({key: value for key, value in figures.items() if key != "looks"})


def test_a_verdict_is_read_back_and_an_older_one_told_apart(tmp_path):
    path = tmp_path / "verdict.json"
    write_report(comparison_of("equivalent"), PLAN, tmp_path)
    figures = read_verdict(path)
    assert figures["verdict"] == "EQUIVALENT"
    assert [entry["version"] for entry in figures["changes"]] == list(CHANGES) == list(range(2, VERSION + 1))
    for broken, told in (
        ({"version": 1}, "is of version 1, .*compare again. Version 2: .*departures.* Version 3: .*plan"),
        ({"version": 2}, "is of version 2, .*compare again. Version 3: "),
        ({"version": VERSION + 1}, f"only version {VERSION} is known here; update etalon"),
        ({"version": None}, "is of version None"),
        ({"format": "shopping"}, "is no verdict of etalon's"),
    ):
        path.write_text(json.dumps(figures | broken))
        with pytest.raises(EtalonError, match=told):
            read_verdict(path)
    for text, told in (("{", "is not JSON"), ("[]", "is no verdict")):
        path.write_text(text)
        with pytest.raises(EtalonError, match=told):
            read_verdict(path)
    with pytest.raises(EtalonError, match="cannot be read"):
        read_verdict(tmp_path / "nowhere.json")
