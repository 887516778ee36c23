# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch, with a stand-in for `etalon compare`.

The stand-in writes a verdict, refuses, crashes or hangs as it is told.
"""

import csv
import json
import sys

import pytest
from etalon.lib.batch import run as batch
from etalon.lib.batch.journal import Entry, open_journal
from etalon.lib.batch.plan import read_plan
from etalon.lib.batch.prepare import Host, How
from etalon.lib.errors import EtalonError
from etalon.tests.lib.batch.stand_in import STAND_IN, calls, run, statuses, write_plan, write_scene


def test_all_combinations_run_and_the_worst_verdict_counts(folder):
    assert run(write_plan(folder, [0, 1, 3], scenes=["glossy_spheres", "furnace"])) == 1
    assert len(calls(folder)) == 6
    assert calls(folder)[1][:4] == ["compare", "glossy_spheres", '--set=objects["A"].x=1', "--time=5"]


def test_what_an_error_in_etalon_itself_said_is_kept_until_the_comparison_is_finished(folder):
    path, told = write_plan(folder, ["wrong"]), []
    assert run(path, told=told) == 2
    said = next(line for line in told if line.startswith("[1/1]"))
    assert "an error in etalon itself (IndexError: out of <range>); please report it with the file crash.txt" in said
    (kept,) = folder.glob("out/*/crash.txt")
    assert "a line of it" in kept.read_text(encoding="utf-8")
    (folder / "mended").touch()
    assert run(path, retry=True) == 0
    assert not kept.exists()


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


# Says that a comparison was told to end, and would go on with the next; notes that it left.
ORDERED = """
import json, os, sys
from pathlib import Path
if sys.argv[1] == "plan":
    print("{}")
    sys.exit(0)
for number, line in enumerate(sys.stdin):
    out = Path(json.loads(line)[-1].partition("=")[2])
    out.mkdir(parents=True, exist_ok=True)
    (out / "verdict.json").write_text(json.dumps(json.load(open("verdict.json")) | {"stopped": "cancelled"}))
    with open("calls.txt", "a") as calls:
        print(json.dumps([os.getpid(), number]), file=calls)
    print(os.environ["ETALON_ANSWER"] + "3", file=sys.stderr, flush=True)
"""


def test_a_process_that_was_told_to_end_runs_no_other_comparison(folder):
    (folder / "stand_in.py").write_text(ORDERED)
    path = write_plan(folder, [0, 1])
    path.write_text(f"per_process = 20\n{path.read_text()}")
    assert run(path) == 2
    assert [status for status, _ in statuses(folder).values()] == ["ended", "ended"]
    assert [number for _, number in calls(folder)] == [0, 0]


@pytest.mark.parametrize(
    ("entry", "limits", "numbers"),
    [
        ("", "", [0, 0, 0]),
        ("per_process = 2", "", [0, 1, 0]),
        ("per_process = 20", "", [0, 1, 2]),
        ("per_process = 20", '[limits]\nmemory = "8 GB"', [0, 0, 0]),
    ],
)
def test_a_process_serves_as_many_comparisons_as_the_plan_says(folder, verdict_json, entry, limits, numbers):
    """Where it says nothing, and with `memory` in its limits, each comparison has a process of its own."""
    (folder / "stand_in.py").write_text(ORDERED.replace(' | {"stopped": "cancelled"}', ""))
    path = write_plan(folder, [0, 1, 2])
    path.write_text(f"{entry}\n{path.read_text()}\n{limits}\n")
    assert run(path) == 3
    assert [number for _, number in calls(folder)] == numbers


def test_scenes_that_took_longest_go_first(folder):
    """Going by the journal's results, whatever they were obtained with; scenes that it does not know go before all."""
    (folder / "out").mkdir()
    with open_journal(folder / "out") as journal:
        for number, (scene, seconds) in enumerate((("furnace", 2.0), ("cornell_glossy", 9.0), ("furnace", 4.0))):
            journal.write(Entry(f"key{number}", scene, "{}", "finished", 0, seconds, "", "x"))
        journal.write(Entry("key3", "furnace", "{}", "refused", 2, 60.0, "no", "x"))
    run(write_plan(folder, [0, 3], scenes=["furnace", "glossy_spheres", "cornell_glossy"]))
    assert [call[1] for call in calls(folder)] == ["glossy_spheres"] * 2 + ["cornell_glossy"] * 2 + ["furnace"] * 2
