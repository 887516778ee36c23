# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon batch`: the plan that it prints before any render, and wrong command lines."""

import json
import tomllib

import pytest
from etalon.addon.command import cli
from etalon.lib.exit_codes import ExitCode

PLAN = """
out = "sweep"
scenes = ["furnace"]
frames = [1, 2]
[options]
time = "10s"
tolerance = ["1%", "2%"]
"""


@pytest.fixture
def plan(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        "etalon.lib.batch.prepare.ask_plan", lambda target, words, progress: type("A", (), {"found": {}, "error": ""})
    )
    (tmp_path / "plan.toml").write_text(PLAN)
    return tmp_path


def test_the_example_is_printed_as_it_can_be_read(capsys):
    assert cli.main(["batch", "--example"]) == ExitCode.DONE
    assert tomllib.loads(capsys.readouterr().out)["scenes"] == ["glossy_spheres"]


def test_a_dry_run_lists_what_would_be_run_and_how_long_it_takes(plan, capsys):
    assert cli.main(["batch", "plan.toml", "--dry-run", "--jobs=2", "--quiet"]) == ExitCode.DONE
    *rows, last = capsys.readouterr().out.splitlines()
    assert rows[0] == "to run    furnace frame=1 tolerance=1%"
    assert len(rows) == 4
    assert last == "4 comparisons, 4 to run, 2 side by side; at most about 40 s"
    assert cli.main(["batch", "plan.toml", "--dry-run", "--jobs=1", "--quiet", "--json"]) == ExitCode.DONE
    figures = json.loads(capsys.readouterr().out)
    assert (figures["count"], figures["missing"], figures["most_seconds"]) == (4, 4, 80.0)
    assert {path.name for path in (plan / "sweep").iterdir()} == {"journal.sqlite"}


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "name a plan, as in etalon batch PLAN.toml; --example prints one"),
        (["nowhere.toml"], "nowhere.toml: cannot be read"),
        (["plan.toml", "--fail-on=bond"], "--fail-on: 'bond' is no rule; give different, changed or bound:2%"),
        (["plan.toml", "--fail-on=changed"], "--fail-on changed needs an earlier batch; add --against EARLIER"),
        (["plan.toml", "--against=nowhere"], "nowhere: cannot be read"),
        (
            ["plan.toml", "--scheduler=tcp://h:1", "--jobs=2"],
            "--jobs: workers say themselves how much runs side by side",
        ),
        (["plan.toml", "--jobs=0"], "0 is out of range; give at least 1"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_is_one_line(plan, words, says, capsys):
    assert cli.main(["batch", *words, "--quiet"]) == ExitCode.BAD_INPUT
    errors = capsys.readouterr().err.strip()
    assert says in errors
    assert len(errors.splitlines()) == 1


def test_the_folder_of_this_batch_is_no_earlier_one(plan, capsys):
    (plan / "sweep").mkdir()
    (plan / "sweep" / "batch.json").write_text('{"format": "etalon-batch", "version": 1}')
    assert cli.main(["batch", "plan.toml", "--against=sweep", "--quiet"]) == ExitCode.BAD_INPUT
    assert "is the folder of this batch; name that of an earlier one" in capsys.readouterr().err
