# SPDX-License-Identifier: GPL-3.0-or-later
"""Results appear whole or not at all, and what is not ours stays."""

import errno

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
