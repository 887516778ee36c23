# SPDX-License-Identifier: GPL-3.0-or-later
"""Other processes: started, spoken to, ended."""

import subprocess
import sys
from types import SimpleNamespace

import pytest
from etalon.lib.batch.process import end, etalon_command, find_blender, own_errors, send, start


def test_ending_a_process_ends_its_children_too():
    grandchild = "import sys; print(1, flush=True); sys.stdin.read()"
    child = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {grandchild!r}])"
    process = start([sys.executable, "-c", child], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert process.stdout.readline() == "1\n"
    end(process)
    assert process.stdout.read() == ""  # the pipe is closed: nobody holds it any more
    process.stdin.close()
    process.stdout.close()
    end(process)


def test_temporary_files_go_where_they_are_told(tmp_path):
    script = "import tempfile; print(tempfile.mkdtemp())"
    process = start([sys.executable, "-c", script], temporary=tmp_path, stdout=subprocess.PIPE)
    assert process.stdout.read().startswith(str(tmp_path))
    process.wait()
    process.stdout.close()


def test_a_line_arrives_at_once():
    process = start([sys.executable, "-c", "print(input())"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    send(process, "étalon\n")
    assert process.stdout.read() == "étalon\n"
    process.wait()
    process.stdin.close()
    process.stdout.close()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGPIPE")
def test_a_process_that_is_gone_is_an_error_and_no_signal():
    """As in Blender, where SIGPIPE keeps its default: it ends the program."""
    script = """
import signal, subprocess, sys
from etalon.lib.batch.process import send, start
signal.signal(signal.SIGPIPE, signal.SIG_DFL)
gone = start([sys.executable, "-c", ""], stdin=subprocess.PIPE)
gone.wait()
try:
    send(gone, "hello")
except OSError:
    print("told")
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "told\n"), done.stderr


def test_a_folder_is_no_blender(monkeypatch, tmp_path):
    # A script that sets bpy.app.binary_path = "" finds the working directory there.
    program = tmp_path / "blender"
    program.touch()
    for path, found in ((tmp_path, None), (program, str(program)), ("", None)):
        monkeypatch.setitem(sys.modules, "bpy", SimpleNamespace(app=SimpleNamespace(binary_path=str(path))))
        assert find_blender() == found
        assert etalon_command()[0] == (found or sys.executable)


def test_what_blender_says_after_an_error_is_not_the_reason():
    said = (
        "Read blend: a.blend\netalon: the scene has no camera\netalon: add one\r\nError: Not freed memory blocks: 6\n"
    )
    assert own_errors(said) == ["the scene has no camera", "add one"]
