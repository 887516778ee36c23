# SPDX-License-Identifier: GPL-3.0-or-later
"""What belongs to a process goes with it: locks at once, folders when they are swept."""

import os
import signal
import subprocess
import sys
import tempfile

import pytest
from etalon.lib.files.ownership import OWNER, TEMPORARY, lock, owned_folder, sweep, temporary_folder

HOLDER = """
import sys
from pathlib import Path
from etalon.lib.files.ownership import owned_folder
with owned_folder(Path(sys.argv[1]), "mine-") as folder:
    (folder / "content").write_text("x")
    print(folder.name, flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def holder(tmp_path):
    """A process that owns a folder in tmp_path, and the folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    folder = tmp_path / process.stdout.readline().strip()
    yield process, folder
    process.kill()
    process.communicate()


def swept(parent):
    """The names of the folders that a sweep removes."""
    return [folder.name for folder in sweep(parent, "mine-")]


def test_a_file_is_locked_by_one_at_a_time(tmp_path):
    first = lock(tmp_path / "lock")
    assert lock(tmp_path / "lock") is None
    os.close(first)
    second = lock(tmp_path / "lock")
    assert second is not None
    os.close(second)


def test_a_folder_of_a_running_process_stays(tmp_path, holder):
    _, folder = holder
    assert swept(tmp_path) == []
    assert (folder / "content").exists()


def test_a_folder_of_a_killed_process_is_swept(tmp_path, holder):
    process, folder = holder
    process.kill()
    process.wait()
    assert swept(tmp_path) == [folder.name]
    assert list(tmp_path.iterdir()) == []


def test_a_folder_goes_at_the_end_of_its_block(tmp_path):
    with owned_folder(tmp_path, "mine-") as folder:
        (folder / "below").mkdir()
        (folder / "below" / "file").touch()
        assert swept(tmp_path) == []
    assert list(tmp_path.iterdir()) == []


def test_folders_that_no_process_owned_stay_unless_they_are_empty(tmp_path):
    (tmp_path / "mine-empty").mkdir()
    (tmp_path / "mine-of-somebody").mkdir()
    (tmp_path / "mine-of-somebody" / "letter").touch()
    (tmp_path / "mine-file").touch()
    assert swept(tmp_path) == []
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine-file", "mine-of-somebody"]


@pytest.mark.skipif(sys.platform == "win32", reason="symbolic links need a privilege there")
def test_links_are_not_followed(tmp_path):
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / OWNER).touch()
    (tmp_path / "mine-link").symlink_to(tmp_path / "far")
    (tmp_path / "mine-linked").mkdir()
    (tmp_path / "mine-linked" / OWNER).symlink_to(tmp_path / "far" / OWNER)
    assert swept(tmp_path) == []
    assert (tmp_path / "far" / OWNER).exists()
    assert (tmp_path / "mine-linked").exists()


def test_temporary_folders_of_killed_processes_are_swept(tmp_path, monkeypatch):
    script = (
        "import os; from etalon.lib.files.ownership import temporary_folder\n"
        "with temporary_folder() as folder: (folder / 'x').touch(); os.kill(os.getpid(), 9)"
    )
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", script], env=environment, timeout=60)
    assert done.returncode == -signal.SIGKILL
    (left,) = tmp_path.iterdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with temporary_folder() as folder:
        assert folder.name.startswith(TEMPORARY)
        assert not left.exists()
    assert list(tmp_path.iterdir()) == []
