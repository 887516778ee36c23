# SPDX-License-Identifier: GPL-3.0-or-later
"""Results appear whole or not at all, and what is not ours stays."""

import errno
import os
import subprocess
import sys

import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.files.atomic import replace_file, replace_files


def test_files_move_in_when_the_block_ends_well(tmp_path):
    out = tmp_path / "a" / "b"
    out.mkdir(parents=True)
    (out / "mine.txt").write_text("stays")
    (out / "report.html").write_text("old")
    with replace_files(out) as beside:
        (beside / "report.html").write_text("new")
        assert (out / "report.html").read_text() == "old"
    assert {p.name: p.read_text() for p in out.iterdir()} == {"mine.txt": "stays", "report.html": "new"}


def test_nothing_is_left_when_it_does_not(tmp_path):
    def write_half():
        with replace_files(tmp_path / "a" / "b") as beside:
            (beside / "half.exr").write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        write_half()
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_told_in_one_line(tmp_path):
    with (
        pytest.raises(EtalonError, match=r"image.exr cannot be written \(No space left on device\); make room"),
        replace_files(tmp_path / "out"),
    ):
        raise OSError(errno.ENOSPC, "No space left on device", "image.exr")
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_told_before_the_block_runs(tmp_path):
    (tmp_path / "file").touch()
    for target in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(EtalonError), replace_files(target):
            pytest.fail("the block ran")
    with pytest.raises(EtalonError, match="is a folder"), replace_file(tmp_path):
        pytest.fail("the block ran")


def test_one_file(tmp_path):
    with replace_file(tmp_path / "new" / "x.exr") as path:
        path.write_text("image")
    assert (tmp_path / "new" / "x.exr").read_text() == "image"
    assert len(list((tmp_path / "new").iterdir())) == 1


def contents(folder):
    """The names and texts of the files in a folder."""
    return {path.name: path.read_text() for path in folder.iterdir()}


@pytest.fixture
def old(tmp_path):
    """A folder with three results of an older run and a file of the user's."""
    for name in ("a.exr", "b.json", "stale.blend"):
        (tmp_path / name).write_text("old")
    (tmp_path / "mine.txt").write_text("mine")
    return tmp_path


def test_a_file_that_is_no_result_any_more_goes_with_the_old_ones(old):
    with replace_files(old, without=["stale.blend", "b.json", "never.blend"]) as beside:
        (beside / "a.exr").write_text("new")
        (beside / "b.json").write_text("new")
    assert contents(old) == {"a.exr": "new", "b.json": "new", "mine.txt": "mine"}


@pytest.mark.parametrize("failing", range(5))
def test_a_move_that_fails_brings_the_old_files_back(old, monkeypatch, failing):
    moves = []
    replace = os.replace

    def fails(source, target):
        moves.append(target)
        if len(moves) == failing + 2:  # the first one completes the note
            raise PermissionError(errno.EACCES, "Permission denied", str(target))
        replace(source, target)

    def write_new():
        with replace_files(old, without=["stale.blend"]) as beside:
            (beside / "a.exr").write_text("new")
            (beside / "b.json").write_text("new")

    before = contents(old)
    monkeypatch.setattr(os, "replace", fails)
    with pytest.raises(EtalonError, match="cannot be written"):
        write_new()
    assert contents(old) == before


KILLED = """
import os, sys
from pathlib import Path
from etalon.lib.files.atomic import replace_files
replace, moves = os.replace, 0
def counted(source, target):
    global moves
    if moves == int(sys.argv[2]):
        os.abort()
    moves += 1
    replace(source, target)
os.replace = counted
with replace_files(Path(sys.argv[1]), without=["stale.blend"]) as beside:
    for name in ("a.exr", "b.json"):
        (beside / name).write_text("new")
"""


@pytest.mark.parametrize("moves", range(6))
def test_a_process_that_ends_between_two_moves_mixes_nothing(old, moves):
    done = subprocess.run([sys.executable, "-c", KILLED, str(old), str(moves)], capture_output=True, timeout=60)
    assert done.returncode != 0
    shown = [path.read_text() for path in old.iterdir() if path.is_file()]
    assert not {"old", "new"} <= set(shown)
    with replace_files(old):
        pass
    now = {"a.exr": "new", "b.json": "new", "mine.txt": "mine"}
    before = {"a.exr": "old", "b.json": "old", "stale.blend": "old", "mine.txt": "mine"}
    assert contents(old) == (now if moves else before)


def test_a_file_that_stayed_empty_is_a_full_disk(old):
    before = contents(old)

    def write_nothing():
        with replace_files(old) as beside:
            (beside / "a.exr").touch()

    with pytest.raises(EtalonError, match=r"a\.exr cannot be written \(it stayed empty; the disk may be full\)"):
        write_nothing()
    assert contents(old) == before


def test_a_folder_in_the_place_of_a_file_is_told_and_stays(tmp_path):
    (tmp_path / "a.exr").mkdir()

    def write():
        with replace_files(tmp_path) as beside:
            (beside / "a.exr").write_text("new")

    with pytest.raises(EtalonError, match=r"a\.exr cannot be written \(Is a directory\)"):
        write()
    assert [path.name for path in tmp_path.iterdir()] == ["a.exr"]


def test_errors_name_the_place_that_a_file_was_to_get(tmp_path):
    def fail():
        with replace_files(tmp_path / "out") as beside:
            raise EtalonError(f"{beside / 'a.png'}: cannot be written (no room)")

    with pytest.raises(EtalonError, match="no room") as caught:
        fail()
    assert str(caught.value) == f"{tmp_path / 'out' / 'a.png'}: cannot be written (no room)"


@pytest.mark.skipif(not hasattr(os, "O_DIRECTORY"), reason="folders are not written to the disk here")
def test_files_are_written_to_the_disk_once_however_deep_their_folders(tmp_path, monkeypatch):
    """Each file once where it ends, and the folders and the note around it; not again for each folder in between."""
    flush, flushed = os.fsync, []
    monkeypatch.setattr(os, "fsync", lambda one: (flushed.append(os.fstat(one).st_ino), flush(one)))
    with replace_files(tmp_path / "out") as outer:
        with replace_files(outer) as inner:
            (inner / "a.png").write_text("a")
            with replace_file(inner / "b.exr") as beside:
                beside.write_text("b")
        assert flushed == []
    files = {path.stat().st_ino for path in (tmp_path / "out").iterdir()}
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"a.png", "b.exr"}
    assert files <= set(flushed)
    assert (tmp_path / "out").stat().st_ino == flushed[-1]
    assert len(flushed) == len(set(flushed)) == 6
