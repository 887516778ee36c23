# SPDX-License-Identifier: GPL-3.0-or-later
"""The journal of a batch: what is kept, what runs again, and whose file it is."""

import json
import sqlite3
import subprocess
import sys
from contextlib import closing

import pytest
from etalon.lib.batch.journal import open_journal
from etalon.lib.batch.plan import read_plan
from etalon.lib.errors import EtalonError
from etalon.lib.files.atomic import UNFINISHED
from etalon.lib.files.ownership import OWNER, owned_folder
from etalon.tests.lib.batch.stand_in import STAND_IN, calls, run, write_plan, write_scene


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


def test_what_is_finished_is_not_asked_again(folder):
    path = write_plan(folder, [0])
    assert run(path) == 0
    (folder / "stand_in.py").unlink()
    assert run(path) == 0


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


def test_a_journal_of_a_newer_format_is_left_alone(folder):
    path = write_plan(folder, [0])
    run(path)
    with closing(sqlite3.connect(folder / "out" / "journal.sqlite")) as journal:
        journal.execute("pragma user_version = 3")
    with pytest.raises(EtalonError, match="is a journal of format 3, and this Étalon knows 2; update Étalon"):
        run(path)


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
