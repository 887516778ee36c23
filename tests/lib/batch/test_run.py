# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch, with a stand-in for `etalon compare` that writes a verdict, refuses, crashes or hangs as it is told."""

import csv
import json
import sqlite3
import subprocess
import sys
from contextlib import closing

import pytest
from etalon.lib.batch import asked
from etalon.lib.batch import run as batch
from etalon.lib.batch.journal import open_journal
from etalon.lib.batch.plan import read_plan
from etalon.lib.batch.prepare import Host, How
from etalon.lib.batch.results import End
from etalon.lib.errors import EtalonError
from etalon.lib.files.atomic import UNFINISHED
from etalon.lib.files.ownership import OWNER, owned_folder
from etalon.lib.report.document import FORMAT, VERSION

# Notes each call, then ends as the value of --set says; the file it stands in for has the layout of a real verdict.json.
STAND_IN = """
import json, os, sys
from pathlib import Path
if sys.argv[1] == "plan":
    if any(a.endswith('="nowhere"') for a in sys.argv):
        print("etalon: x: no such property", file=sys.stderr)
        sys.exit(2)
    print("{}")
    sys.exit(0)
arguments = dict(a[2:].split("=", 1) for a in sys.argv[1:] if "=" in a)
value = json.loads(sys.argv[3].split(".x=", 1)[1])
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
    for module in (batch, asked):
        monkeypatch.setattr(module, "etalon_command", lambda: [sys.executable, str(tmp_path / "stand_in.py")])
    return tmp_path


@pytest.fixture
def verdict_json():
    """What a comparison leaves behind, as far as the tables read it."""
    return json.dumps(
        {
            "format": FORMAT,
            "version": VERSION,
            "image": {"difference": 0.0012, "interval": [-0.001, 0.003]},
            "bound": {"value": 0.0042},
            "regions": [{"outcome": "EQUIVALENT"}] * 3 + [{"outcome": "DIFFERENT"}],
            "tolerance": 0.01,
            "confidence": 0.99,
            "versions": {"etalon": "0.1.0"},
            "blender": {"version": "5.3.0"},
        }
    )


def write_plan(folder, values, scenes=("glossy_spheres",)):
    """A plan over one property."""
    path = folder / "plan.toml"
    path.write_text(
        f'out = "out"\nscenes = {json.dumps(scenes)}\n[options]\ntime = 5\n'
        f'[[vary]]\nname = "<b>rough</b>"\npath = \'objects["A"].x\'\nvalues = {json.dumps(values)}\n'
    )
    return path


def run(path, blender="5.3.0", told=None, end=None, **how):
    """What `etalon batch` does with a plan."""
    tell = [].append if told is None else told.append
    return batch.run_plan(read_plan(path), How(blender, **how), tell, end=end or End())


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
    assert rows[1]["message"] == "Floor: Velvet BSDF is not simulated; use a Glossy BSDF"
    assert float(rows[2]["relative_difference"]) == 0.0012


def test_what_a_killed_batch_of_another_plan_left_goes_and_what_is_being_written_stays(folder):
    left = folder / "out" / "room-of_another_plan" / f"{UNFINISHED}left"
    left.mkdir(parents=True)
    (left / OWNER).touch()
    beside = folder / "out" / "room-of_another_process"
    beside.mkdir()
    with owned_folder(beside, UNFINISHED) as written:
        run(write_plan(folder, [0]))
        assert written.is_dir()
    assert not left.parent.exists()


def test_the_same_command_runs_only_what_is_missing(folder):
    path = write_plan(folder, ["crash", 0])
    for how, values in (
        ({}, ['"crash"', '"crash"', "0"]),  # a crash is tried once more
        ({}, []),
        ({"retry": True}, ['"crash"', '"crash"']),
        ({"force": True}, ['"crash"', '"crash"', "0"]),
    ):
        (folder / "calls.txt").write_text("")
        run(path, **how)
        assert [call[2].rpartition("=")[2] for call in calls(folder)] == values


def test_a_finished_unit_whose_folder_was_removed_runs_again(folder):
    path = write_plan(folder, [0])
    run(path)
    (verdict,) = (folder / "out").glob("*/verdict.json")
    verdict.unlink()
    verdict.parent.rmdir()
    run(path)
    assert len(calls(folder)) == 2


def test_a_verdict_of_an_older_version_is_told_and_compared_again(folder):
    path = write_plan(folder, [0])
    run(path)
    (verdict,) = (folder / "out").glob("*/verdict.json")
    old = json.loads(verdict.read_text()) | {"version": 1}
    verdict.write_text(json.dumps(old))
    (folder / "stand_in.py").write_text(STAND_IN.replace("out.mkdir(parents=True)", ""))
    told = []
    assert run(path, told=told) == 0
    assert len(calls(folder)) == 2
    assert "is of version 1" in told[0]
    assert "Version 2: " in told[0]


def test_ctrl_c_keeps_what_is_finished_and_the_tables(folder, monkeypatch):
    path = write_plan(folder, [0, 1, 3])
    run_comparison = batch.run_comparison

    def interrupted(*arguments):
        if len(calls(folder)) == 2:
            raise KeyboardInterrupt
        return run_comparison(*arguments)

    (folder / "calls.txt").touch()
    monkeypatch.setattr(batch, "run_comparison", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(path)
    assert list(statuses(folder)) == [0, 1]
    assert "not run" in (folder / "out" / "batch.html").read_text()
    monkeypatch.setattr(batch, "run_comparison", run_comparison)
    assert run(path) == 1
    assert len(calls(folder)) == 3


def test_the_grid_says_what_its_verdicts_rest_on(folder):
    run(write_plan(folder, [0, 3, "refuse"]))
    page = (folder / "out" / "batch.html").read_text(encoding="utf-8")
    for said in ("3 comparisons of Cycles", "bound 0.42 %", "3 EQUIVALENT, 1 DIFFERENT of 4 regions", "<dd>1 %</dd>"):
        assert said in page
    for said in ("Blender 5.3.0, etalon 0.1.0", str(folder / "out"), "refused", 'href="#first-EQUIVALENT"'):
        assert said in page
    assert page.count('id="first-EQUIVALENT"') == 1


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


def test_a_foreign_journal_is_left_alone(folder):
    (folder / "out").mkdir()
    (folder / "out" / "journal.sqlite").write_text("a shopping list, long enough to be no empty database " * 20)
    with pytest.raises(EtalonError, match="is not a journal"):
        run(write_plan(folder, [0]))


def test_a_batch_that_runs_already_is_told_in_one_line(folder):
    path = write_plan(folder, [0])
    plan = read_plan(path)
    plan.out.mkdir()
    with open_journal(plan.out), pytest.raises(EtalonError, match="another batch is running there; wait for it"):
        run(path)
    assert not (folder / "calls.txt").exists()
    assert run(path) == 0
    assert not (plan.out / "journal.lock").exists()


def test_a_killed_batch_holds_no_lock(folder):
    path = write_plan(folder, [0])
    (folder / "out").mkdir()
    script = (
        "import os, sys; from pathlib import Path; from etalon.lib.batch.journal import open_journal\n"
        "with open_journal(Path(sys.argv[1])): os.abort()"
    )
    done = subprocess.run([sys.executable, "-c", script, str(folder / "out")], capture_output=True, timeout=60)
    assert done.returncode != 0
    assert (folder / "out" / "journal.lock").exists()
    assert run(path) == 0
    assert not (folder / "out" / "journal.lock").exists()


def test_a_journal_that_another_program_holds_is_no_foreign_one(folder, monkeypatch):
    path = write_plan(folder, [0])
    run(path)
    connect = sqlite3.connect
    monkeypatch.setattr(sqlite3, "connect", lambda *a, **k: connect(*a, timeout=0.0, **k))
    with closing(connect(folder / "out" / "journal.sqlite", isolation_level=None)) as other:
        other.execute("begin exclusive")
        with pytest.raises(EtalonError, match="is open in another program; close it there"):
            run(path)


def test_a_database_of_something_else_is_no_journal(folder):
    (folder / "out").mkdir()
    with closing(sqlite3.connect(folder / "out" / "journal.sqlite")) as other:
        other.execute("create table units (colour text)")
    with pytest.raises(EtalonError, match="is not a journal of this command"):
        run(write_plan(folder, [0]))


def test_another_blender_compares_again(folder):
    path = write_plan(folder, [0])
    for blender in ("5.2.3", "5.3.0", "5.3.0"):
        run(path, blender)
    assert len(calls(folder)) == 2


def test_every_comparison_and_the_whole_are_told(folder):
    told = []
    assert run(write_plan(folder, ["crash", "refuse", 0, 3]), told=told) == 2
    *units, summary = told
    assert [line.split(": ")[1].split(" (")[0] for line in units] == ["failed", "refused", "EQUIVALENT", "UNDECIDED"]
    assert "it was ended by signal 6" in units[0] or "code" in units[0]
    assert "refused: Floor: Velvet BSDF is not simulated; use a Glossy BSDF" in units[1]
    assert units[2].startswith("[3/4] glossy_spheres <b>rough</b>=0: EQUIVALENT")
    assert summary == "4 comparisons: 1 failed, 1 refused, 1 EQUIVALENT, 1 UNDECIDED"


def test_a_plan_of_which_everything_fails_says_so(folder):
    told = []
    path = write_plan(folder, ["refuse", "crash"])
    assert run(path) == 2
    assert run(path, told=told) == 2
    assert told == ["2 of 2 comparisons were done before", "2 comparisons: 1 refused, 1 failed"]


def test_a_verdict_of_a_comparison_that_was_ended_is_none(folder, verdict_json):
    stopped = json.loads(verdict_json) | {"stopped": "cancelled"}
    (folder / "verdict.json").write_text(json.dumps(stopped))
    assert run(write_plan(folder, [3])) == 2
    assert statuses(folder)[3][0] == "ended"
    run(folder / "plan.toml")
    assert len(calls(folder)) == 2


def test_what_a_child_leaves_half_written_is_removed(folder):
    (folder / "stand_in.py").write_text(
        """
import os, sys
from pathlib import Path
from etalon.lib.files.atomic import replace_files
if sys.argv[1] == "plan":
    print("{}")
    sys.exit(0)
with replace_files(Path(sys.argv[-1].partition("=")[2])) as beside:
    (beside / "half.exr").write_text("half")
    os.abort()
"""
    )
    run(write_plan(folder, [0]))
    assert {path.name for path in (folder / "out").iterdir()} == {
        "journal.sqlite",
        "batch.csv",
        "batch.html",
        "batch.json",
        "junit.xml",
    }


def test_cells_that_a_spreadsheet_would_run_begin_with_an_apostrophe(folder):
    run(write_plan(folder, ["refuse", "=1+1", "-1", -1, "@x", "+x"]))
    with (folder / "out" / "batch.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["<b>rough</b>"] for row in rows] == ["refuse", "'=1+1", "-1", "-1", "'@x", "'+x"]


def test_a_property_that_cannot_be_set_is_told_before_the_first_comparison(folder):
    with pytest.raises(EtalonError, match="glossy_spheres: x: no such property"):
        run(write_plan(folder, [0, "nowhere"]))
    assert not (folder / "calls.txt").exists()


def test_what_is_finished_is_not_asked_again(folder):
    path = write_plan(folder, [0])
    assert run(path) == 0
    (folder / "stand_in.py").unlink()
    assert run(path) == 0


def write_scene(folder, text, files):
    """A scene of that content, which refers to `files`, and a plan over it."""
    (folder / "room.blend").write_text(text)
    found = json.dumps({"files": [str(folder / name) for name in files], "frames": [1, 250], "cameras": ["Front"]})
    (folder / "stand_in.py").write_text(STAND_IN.replace('print("{}")', f"print({found!r})"))
    return write_plan(folder, [0], scenes=["room.blend"])


def test_a_scene_is_compared_again_where_it_or_a_file_that_it_refers_to_has_another_content(folder):
    texture = folder / "wood.png"
    texture.write_text("oak")
    path = write_scene(folder, "one", ["wood.png", "not_there.png"])
    counts = []
    for change in (
        lambda: None,
        lambda: None,
        lambda: texture.write_text("pine"),
        lambda: (folder / "room.blend").write_text("two"),
        lambda: texture.write_text("oak"),
        lambda: (folder / "not_there.png").write_text("there"),
        lambda: (folder / "room.blend").touch(),
    ):
        change()
        run(path)
        counts.append(len(calls(folder)))
    assert counts == [1, 1, 2, 3, 4, 5, 5]


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("frames = [1, 251]", "room.blend: frame 251 is outside its frames 1 to 250; change 'frames' of the plan"),
        ('cameras = ["Fornt"]', "room.blend: unknown camera 'Fornt'; did you mean 'Front'?"),
    ],
)
def test_what_a_scene_has_not_is_told_before_the_first_comparison(folder, entry, says):
    path = write_scene(folder, "one", [])
    path.write_text(f"{entry}\n{path.read_text()}")
    with pytest.raises(EtalonError) as caught:
        run(path)
    assert str(caught.value) == says
    assert not (folder / "calls.txt").exists()


def test_a_preview_renders_nothing_and_says_what_is_missing(folder):
    path = write_plan(folder, [0, 1])
    outlook = batch.preview_plan(read_plan(path), How("5.3.0", jobs=2), [].append)
    assert (len(outlook.missing), outlook.most, outlook.expected) == (2, 15.0, None)
    assert not (folder / "calls.txt").exists()
    run(write_plan(folder, [0]))
    outlook = batch.preview_plan(read_plan(write_plan(folder, [0, 1])), How("5.3.0"), [].append)
    assert [unit.label for unit in outlook.missing] == ["glossy_spheres <b>rough</b>=1"]
    assert outlook.expected > 0


def test_units_run_side_by_side_and_each_in_its_own_blender(folder):
    """Each waits for a file that the other one writes; alone, neither would end."""
    (folder / "stand_in.py").write_text(
        STAND_IN.replace(
            'with open("calls.txt"',
            """import time
Path(f"begun{value}").touch()
while not Path(f"begun{1 - value}").exists():
    time.sleep(0.01)
with open("calls.txt\"""".replace('\\"', '"'),
        )
    )
    assert run(write_plan(folder, [0, 1]), jobs=2, threads=1) == 1
    assert all("--threads=1" in call for call in calls(folder))


def test_a_plan_names_blenders_and_each_result_is_that_of_one(folder):
    path = write_plan(folder, [0])
    path.write_text(f'blenders = ["4.5", "5.2"]\n{path.read_text()}')
    stand_in = [sys.executable, str(folder / "stand_in.py")]

    def hosts(build):
        return {
            name: Host(f"{name} {build}", lambda words, name=name: [*stand_in, *words, name]) for name in ("4.5", "5.2")
        }

    assert run(path, hosts=hosts("a")) == 0
    assert [call[-1] for call in calls(folder)] == ["4.5", "5.2"]
    run(path, hosts=hosts("a"))
    assert len(calls(folder)) == 2
    run(path, hosts=hosts("b"))
    assert len(calls(folder)) == 4
    assert (
        "blender = 5.2" not in (folder / "out" / "batch.html").read_text()
    )  # the last axis goes across, blenders down


def test_a_journal_of_a_newer_format_is_left_alone(folder):
    path = write_plan(folder, [0])
    run(path)
    with closing(sqlite3.connect(folder / "out" / "journal.sqlite")) as journal:
        journal.execute("pragma user_version = 3")
    with pytest.raises(EtalonError, match="is a journal of format 3, and this Étalon knows 2; update Étalon"):
        run(path)


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="the memory of another process is read from Linux's /proc"
)
def test_a_unit_that_takes_too_long_or_too_much_memory_is_ended_and_says_so(folder):
    (folder / "stand_in.py").write_text(
        STAND_IN.replace(
            'if value == "crash":',
            'if value == "large":\n    kept = b"x" * 200_000_000\nif value in ("long", "large"):',
        ).replace("    os.abort()", "    import time\n    time.sleep(60)")
    )
    path = write_plan(folder, ["long", "large"])
    for limit, says in (
        ('time = "1s"', "took longer than 1 s"),
        ('memory = "0.15 GB"', "took more than 0.15 GB of memory"),
    ):
        told = []
        value = ["long"] if "time" in limit else ["large"]
        path = write_plan(folder, value)
        path.write_text(f"{path.read_text()}\n[limits]\n{limit}\n")
        assert run(path, told=told) == 2
        assert says in told[0]


def test_ten_thousand_results_are_found_again_in_one_query(folder):
    path = write_plan(folder, [0])
    run(path)
    rows = [(f"{number:016x}", "room", "{}", "refused", 2, 1.0, "no", "x") for number in range(10_000)]
    with closing(sqlite3.connect(folder / "out" / "journal.sqlite")) as journal, journal:
        journal.executemany("insert into units values (?, ?, ?, ?, ?, ?, ?, ?)", rows)
    with open_journal(folder / "out") as journal:
        assert len(journal.read_all()) == 10_001
    run(path)
    assert len(calls(folder)) == 1
