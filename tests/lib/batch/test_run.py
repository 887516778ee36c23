# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch, with a stand-in for `etalon compare` that writes a verdict, refuses, crashes or hangs as it is told."""

import csv
import json
import sqlite3
import sys
from contextlib import closing

import pytest
from etalon.lib.batch import run as batch
from etalon.lib.errors import EtalonError
from etalon.lib.report.document import FORMAT, VERSION

# Notes each call, then ends as the value of --set says; the file it stands in for has the layout of a real verdict.json.
STAND_IN = """
import json, os, sys
from pathlib import Path
arguments = dict(a[2:].split("=", 1) for a in sys.argv[1:] if a.startswith("--"))
value = json.loads(sys.argv[3].rpartition("=")[2])
with open("calls.txt", "a") as calls:
    print(json.dumps(sys.argv[1:]), file=calls)
if value == "crash":
    os.abort()
if value == "refuse":
    print("etalon: Floor: Velvet BSDF is not simulated; use a Glossy BSDF", file=sys.stderr)
    sys.exit(2)
out = Path(arguments["out"])
out.mkdir(parents=True)
(out / "verdict.json").write_text(open("verdict.json").read())
sys.exit(int(value))
"""


@pytest.fixture
def folder(tmp_path, monkeypatch, verdict_json):
    """A folder with a plan's surroundings, in which `etalon` is the stand-in."""
    (tmp_path / "stand_in.py").write_text(STAND_IN)
    (tmp_path / "verdict.json").write_text(verdict_json)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(batch, "etalon_command", lambda: [sys.executable, str(tmp_path / "stand_in.py")])
    return tmp_path


@pytest.fixture
def verdict_json():
    """What a comparison leaves behind, as far as the tables read it."""
    return json.dumps(
        {"format": FORMAT, "version": VERSION, "image": {"difference": 0.0012, "interval": [-0.001, 0.003]}}
    )


def write_plan(folder, values, scenes=("glossy_spheres",)):
    """A plan over one property."""
    path = folder / "plan.toml"
    path.write_text(
        f'out = "out"\nscenes = {json.dumps(scenes)}\n[options]\ntime = 5\n'
        f'[[vary]]\nname = "<b>rough</b>"\npath = \'objects["A"].x\'\nvalues = {json.dumps(values)}\n'
    )
    return path


def run(path):
    """What `etalon batch` does with a plan."""
    return batch.run_plan(batch.read_plan(path))


def calls(folder):
    """The command lines that were run."""
    return [json.loads(line) for line in (folder / "calls.txt").read_text().splitlines()]


def statuses(folder):
    """Status and exit code of each value in the journal."""
    with closing(sqlite3.connect(folder / "out" / "journal.sqlite")) as journal:
        rows = journal.execute("select assignments, status, exit_code from units order by rowid").fetchall()
    return {json.loads(a)["<b>rough</b>"]: (status, code) for a, status, code in rows}


def test_all_combinations_run_and_the_worst_verdict_counts(folder):
    assert run(write_plan(folder, [0, 1, 3], scenes=["glossy_spheres", "furnace"])) == 1
    assert len(calls(folder)) == 6
    assert calls(folder)[1][:4] == ["compare", "glossy_spheres", '--set=objects["A"].x=1', "--time=5"]


def test_a_crash_and_a_refusal_are_recorded_and_the_rest_go_on(folder):
    assert run(write_plan(folder, ["crash", "refuse", 0])) == 2
    recorded = statuses(folder)
    assert recorded["crash"][0] == "failed"
    assert recorded["refuse"] == ("refused", 2)
    assert recorded[0] == ("finished", 0)
    with (folder / "out" / "batch.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["verdict"] for row in rows] == ["", "", "EQUIVALENT"]
    assert rows[1]["message"] == "etalon: Floor: Velvet BSDF is not simulated; use a Glossy BSDF"
    assert float(rows[2]["relative_difference"]) == 0.0012


def test_the_same_command_runs_only_what_is_missing(folder):
    path = write_plan(folder, ["crash", 0])
    run(path)
    run(path)
    assert [call[2].rpartition("=")[2] for call in calls(folder)] == ['"crash"', "0", '"crash"']


def test_a_finished_unit_whose_folder_was_removed_runs_again(folder):
    path = write_plan(folder, [0])
    run(path)
    (verdict,) = (folder / "out").glob("*/verdict.json")
    verdict.unlink()
    verdict.parent.rmdir()
    run(path)
    assert len(calls(folder)) == 2


def test_a_verdict_of_an_older_version_is_told_and_compared_again(folder, capfd):
    path = write_plan(folder, [0])
    run(path)
    (verdict,) = (folder / "out").glob("*/verdict.json")
    old = json.loads(verdict.read_text()) | {"version": 1}
    verdict.write_text(json.dumps(old))
    (folder / "stand_in.py").write_text(STAND_IN.replace("out.mkdir(parents=True)", ""))
    assert run(path) == 0
    assert len(calls(folder)) == 2
    told = capfd.readouterr().err
    assert "is of version 1" in told
    assert "Version 2: " in told


def test_ctrl_c_keeps_what_is_finished_and_the_tables(folder, monkeypatch):
    path = write_plan(folder, [0, 1, 3])
    run_unit = batch._run_unit

    def interrupted(arguments):
        if len(calls(folder)) == 2:
            raise KeyboardInterrupt
        return run_unit(arguments)

    (folder / "calls.txt").touch()
    monkeypatch.setattr(batch, "_run_unit", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(path)
    assert list(statuses(folder)) == [0, 1]
    assert "not run" in (folder / "out" / "batch.html").read_text()
    monkeypatch.setattr(batch, "_run_unit", run_unit)
    assert run(path) == 1
    assert len(calls(folder)) == 3


def test_names_are_escaped_in_the_grid(folder):
    run(write_plan(folder, ["refuse"], scenes=["<script>alert(1)</script>"]))
    page = (folder / "out" / "batch.html").read_text()
    assert "<script>alert" not in page
    assert "&lt;script&gt;" in page
    assert "<b>rough" not in page


def test_a_scene_name_never_becomes_a_path(folder):
    run(write_plan(folder, [0], scenes=["../../escape"]))
    inside = [p.name for p in (folder / "out").iterdir() if p.is_dir()]
    assert len(inside) == 1
    assert inside[0].startswith("escape-")
    assert not (folder.parent / "escape").exists()


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("scenes = [", "is not TOML"),
        ("scenes = []", "'scenes' must be"),
        ('scenes = ["a"]\ncolour = 1', "unknown entry 'colour'"),
        ('scenes = ["a"]\n[[vary]]\npath = "x"', "'values'"),
        ('scenes = ["a"]\n[[vary]]\npath = "x"\nvalues = []', "is empty"),
        ('scenes = ["a"]\noptions = 3', "'options' a table"),
    ],
)
def test_a_wrong_plan_is_told_by_name(tmp_path, text, complaint):
    path = tmp_path / "plan.toml"
    path.write_text(text)
    with pytest.raises(EtalonError, match=complaint):
        run(path)
    assert list(tmp_path.iterdir()) == [path]


def test_a_missing_plan_is_told_by_name(tmp_path):
    with pytest.raises(EtalonError, match=r"nowhere\.toml: cannot be read"):
        run(tmp_path / "nowhere.toml")


def test_a_foreign_journal_is_left_alone(folder):
    (folder / "out").mkdir()
    (folder / "out" / "journal.sqlite").write_text("a shopping list, long enough to be no empty database " * 20)
    with pytest.raises(EtalonError, match="is not a journal"):
        run(write_plan(folder, [0]))
