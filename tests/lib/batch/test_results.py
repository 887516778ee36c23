# SPDX-License-Identifier: GPL-3.0-or-later
"""The results of a batch.

They are JSON, JUnit XML, maps, what changed since an earlier one, and the rule by which it fails.
"""

import json
from pathlib import Path
from xml.etree import ElementTree

import etalon.lib.batch as package
import pytest
from etalon.lib.batch.against import find_changes, read_batch
from etalon.lib.batch.plan import BatchPlan, Variation
from etalon.lib.batch.results import End, Results, read_fail_on, write_results
from etalon.lib.errors import EtalonError
from etalon.lib.exit_codes import ExitCode
from etalon.lib.report.batch import Row
from etalon.lib.report.document import FORMAT
from etalon.lib.report.document import VERSION as VERDICT
from jsonschema import Draft202012Validator

ROUGHNESS = Variation("rough", "x", (0.1, 0.3, 0.5, 0.7), ((),) * 4)
SCHEMA = json.loads((Path(package.__file__).parent / "batch.schema.json").read_text(encoding="utf-8"))
VERDICTS = ("EQUIVALENT", "DIFFERENT", "UNDECIDED", "EXPLAINED")


def rows(verdicts=VERDICTS, difference=0.01):
    """A row for each verdict, or for a status in lower case."""
    found = []
    for value, verdict in zip(ROUGHNESS.values, verdicts, strict=False):
        label = f"room rough={value}"
        if verdict.islower():
            found.append((label, Row("room", (value,), verdict, message="no such <node>\x00")))
            continue
        numbers = {"difference": difference, "low": difference - 0.001, "high": difference + 0.001, "bound": 0.015}
        row = Row("room", (value,), "finished", verdict, **numbers, seconds=2.0, folder=f"room-{value}", tolerance=0.01)
        found.append((label, row))
    return found


def results(folder, end=None, **made):
    return Results(BatchPlan(folder, ("room",), folder, (), (ROUGHNESS,)), rows(**made), end or End())


def write(folder, difference, **made):
    """Write a batch with a verdict.json for each comparison.

    The wall of each differs by `difference` in red.
    """
    for value in ROUGHNESS.values:
        place = folder / f"room-{value}"
        place.mkdir(parents=True, exist_ok=True)
        region = {"kind": "material", "name": "Wall", "difference": [difference, 0, 0]}
        region |= {"low": [difference - 0.001, -0.1, None], "high": [difference + 0.001, 0.1, None]}
        verdict = {"format": FORMAT, "version": VERDICT, "regions": [region, region | {"kind": "block"}]}
        (place / "verdict.json").write_text(json.dumps(verdict))
    write_results(results(folder, **made))


def test_json_and_junit_say_the_same_as_the_rows(tmp_path):
    found = results(tmp_path, verdicts=("EQUIVALENT", "DIFFERENT", "UNDECIDED", "refused"))
    write_results(found)
    figures = json.loads((tmp_path / "batch.json").read_text())
    assert [one["verdict"] for one in figures["comparisons"]] == ["EQUIVALENT", "DIFFERENT", "UNDECIDED", ""]
    assert figures["comparisons"][0]["values"] == {"rough": 0.1}
    assert figures["exit_code"] == ExitCode.BAD_INPUT
    suite = ElementTree.parse(tmp_path / "junit.xml").getroot()
    assert {name: suite.get(name) for name in ("tests", "failures", "errors", "skipped", "time")} == {
        "tests": "4",
        "failures": "1",
        "errors": "1",
        "skipped": "1",
        "time": "6.0",
    }
    assert [[child.tag for child in case] for case in suite] == [[], ["failure"], ["skipped"], ["error"]]
    assert suite[3][0].get("message") == "refused: no such <node>\\x00"


def test_batch_json_is_what_its_schema_says(tmp_path):
    Draft202012Validator.check_schema(SCHEMA)
    write(tmp_path / "before", 0.01)
    write(
        tmp_path / "now",
        0.02,
        verdicts=("EQUIVALENT", "DIFFERENT", "refused", "not run"),
        end=End(read_fail_on("changed"), read_batch(tmp_path / "before")),
    )
    figures = json.loads((tmp_path / "now" / "batch.json").read_text())
    assert figures["changes"][0]["moved"]
    assert figures["failing"]
    Draft202012Validator(SCHEMA).validate(figures)
    for amiss in ({"version": 2}, {"comparisons": [{}]}, {"more": 1}):
        assert not Draft202012Validator(SCHEMA).is_valid(figures | amiss)


def test_maps_show_every_number_with_its_share_of_the_colour(tmp_path):
    write_results(results(tmp_path, difference=-0.005))
    page = (tmp_path / "batch.html").read_text(encoding="utf-8")
    assert page.count('class="heat"') == 3
    assert '<td class="low" style="--part: 35%">-0.5 %</td>' in page
    assert '<td class="high" style="--part: 52%">1.5 %</td>' in page


@pytest.mark.parametrize(
    ("rule", "verdicts", "code"),
    [
        ("different", ("EQUIVALENT", "UNDECIDED", "EXPLAINED"), 0),
        ("different", ("EQUIVALENT", "DIFFERENT"), 1),
        ("bound:2%", ("DIFFERENT", "UNDECIDED"), 0),
        ("bound:1%", ("EQUIVALENT",), 1),
        ("different", ("EQUIVALENT", "failed"), 2),
        (None, ("EQUIVALENT", "EXPLAINED"), 4),
        (None, ("UNDECIDED", "EXPLAINED"), 3),
    ],
)
def test_a_rule_decides_the_exit_code_and_without_one_the_worst_comparison(tmp_path, rule, verdicts, code):
    found = results(tmp_path, End(rule and read_fail_on(rule)), verdicts=verdicts)
    assert found.exit_code == code
    assert len(found.failing) == (code == 1)


@pytest.mark.parametrize("text", ["", "diferent", "bound", "bound:", "bound:0", "bound:x", "different:2%"])
def test_a_rule_that_there_is_not_is_one_line(text):
    with pytest.raises(ValueError, match="give"):
        read_fail_on(text)


def test_what_changed_since_an_earlier_batch_is_told_with_its_intervals(tmp_path):
    write(tmp_path / "old", 0.010)
    write(tmp_path / "new", 0.013, verdicts=("DIFFERENT", "DIFFERENT", "refused"))
    earlier = read_batch(tmp_path / "old")
    plan = BatchPlan(tmp_path / "new", ("room",), tmp_path, (), (ROUGHNESS,))
    found = Results(plan, rows(("DIFFERENT", "DIFFERENT", "refused")), End(read_fail_on("changed"), earlier))
    first, second, third = found.changes
    assert (first.before, first.after) == ("EQUIVALENT", "DIFFERENT")
    assert (second.before, second.after) == ("DIFFERENT", "DIFFERENT")
    (moved,) = second.moved
    assert (moved.name, moved.channel, moved.before[0], moved.after[0]) == ("Wall", "R", 0.010, 0.013)
    assert (third.after, third.moved) == ("refused", ())
    assert str(second) == "room rough=0.3; material 'Wall', channel R: +1 % before, now +1.3 %"
    assert len(found.failing) == 3
    assert "changed: room rough=0.3; material" in "\n".join(found.sentences())


def test_intervals_that_overlap_are_no_change(tmp_path):
    write(tmp_path / "old", 0.0100)
    write(tmp_path / "new", 0.0115)
    assert find_changes(read_batch(tmp_path / "old"), rows(), tmp_path / "new") == ()


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "cannot be read"),
        ("{", "is not JSON"),
        ("[]", "is no batch.json of etalon's"),
        ('{"format": "etalon-batch", "version": 9}', "is of version 9, and this Étalon knows 1"),
    ],
)
def test_an_earlier_batch_that_cannot_be_read_is_one_line(tmp_path, content, says):
    if content is not None:
        (tmp_path / "batch.json").write_text(content)
    with pytest.raises(EtalonError, match=says) as caught:
        read_batch(Path(tmp_path))
    assert "\n" not in str(caught.value)
