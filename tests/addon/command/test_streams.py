# SPDX-License-Identifier: GPL-3.0-or-later
"""What is printed never ends a command with a traceback.

Streams are closed, full and broken, have few characters, and get control characters.
"""

import errno
import io
import json
import os
import subprocess
import sys

import pytest
from etalon.addon.command.streams import Stream

posix = pytest.mark.skipif(sys.platform == "win32", reason="the shell is POSIX's")
ETALON = f"'{sys.executable}' -m etalon"


class Broken(io.StringIO):
    """A stream whose reader is gone."""

    def write(self, text):
        raise OSError(self.number, "nobody reads")

    def fileno(self):
        return self.descriptor


@pytest.mark.parametrize("number", [errno.EPIPE, errno.ENOSPC])
def test_an_error_is_kept_and_not_raised(tmp_path, number):
    with (tmp_path / "out").open("w") as file:
        broken = Broken()
        broken.number, broken.descriptor = number, file.fileno()
        stream = Stream(broken)
        assert stream.write("one") == 3
        stream.write("two")
        assert stream.error.errno == number
        file.write("goes nowhere")
    assert (tmp_path / "out").read_text() == ""


def test_characters_that_the_encoding_lacks_are_escaped():
    raw = io.BytesIO()
    stream = Stream(io.TextIOWrapper(raw, encoding="ascii"))
    stream.write("Étalon \udcff – ok\n")
    stream.flush()
    assert raw.getvalue() == b"\\xc9talon \\udcff \\u2013 ok\n"


def test_control_characters_do_not_reach_the_terminal():
    text = io.StringIO()
    Stream(text).write("a\x1b[2J\x07\x9b\u202eb\x1b]0;title\x07 \x1b[31mred\x1b[0m\r\tline\n")
    assert text.getvalue() == "a\\x1b[2J\\x07\\x9b\\u202eb\\x1b]0;title\\x07 \x1b[31mred\x1b[0m\r\tline\n"


def shell(command, folder, **environment):
    """What a shell command gives, with `etalon` for this package's command."""
    import os

    line = f'etalon() {{ {ETALON} "$@"; }}; {command}'
    done = subprocess.run(
        ["sh", "-c", line], capture_output=True, text=True, timeout=120, cwd=folder, env=os.environ | environment
    )
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr
    return done


@posix
@pytest.mark.parametrize(
    ("command", "code"),
    [
        ("etalon --help >&-", 0),
        ("etalon --help 2>&-", 0),
        ("etalon --help <&- >&- 2>&-", 0),
        ("etalon frobnicate 2>&-", 2),
        pytest.param("etalon stability --points=2 --no-scenes | head -1", 0, marks=pytest.mark.slow),
        ("etalon frobnicate 2>&1 >&- | true", 0),
    ],
)
def test_a_stream_that_is_closed_ends_nothing(tmp_path, command, code):
    done = shell(command, tmp_path)
    assert done.returncode == code
    assert len(done.stderr.splitlines()) <= 1
    if "stability" in command:
        assert (tmp_path / "etalon-out" / "stability" / "stability.json").stat().st_size > 1000


@posix
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="/dev/full is Linux's")
def test_output_to_a_full_disk_is_one_line_and_code_2(tmp_path):
    done = shell("etalon --help > /dev/full", tmp_path)
    assert done.returncode == 2
    assert done.stderr == (
        "etalon: standard output cannot be written (No space left on device); make room or write elsewhere\n"
    )


@posix
@pytest.mark.parametrize(
    "environment", [{"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}]
)
def test_names_that_are_not_ascii_are_shown(tmp_path, environment):
    done = shell("etalon Küche", tmp_path, **environment)
    assert done.returncode == 2
    assert "unknown command" in done.stderr


@posix
def test_the_head_of_a_list_is_all_that_is_said(tmp_path):
    done = shell("etalon scenes | head -1", tmp_path)
    assert done.stderr == ""
    assert len(done.stdout.splitlines()) == 1


@posix
def test_control_characters_of_a_name_are_escaped_in_errors(tmp_path):
    done = shell("etalon batch \"$(printf 'a\\033[2J\\nb.toml')\"", tmp_path)
    assert done.stderr.splitlines() == [
        "etalon: a\\x1b[2J\\nb.toml: cannot be read (No such file or directory); check the path"
    ]


LATE = """
import atexit, ctypes, sys
from etalon.addon.command import supervised
atexit.register(lambda: ctypes.CDLL(None).puts(b"Error: Not freed memory blocks: 6"))
sys.argv = ["etalon", "scenes", "--json"]
sys.exit(supervised.main())
"""


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    """A command that has loaded Blender, and the folder that it had for temporary files."""
    folder = tmp_path_factory.mktemp("temporary")
    environment = os.environ | {"TMPDIR": str(folder)}
    return subprocess.run([sys.executable, "-c", LATE], capture_output=True, text=True, env=environment), folder


@posix
def test_what_blender_prints_as_the_process_ends_does_not_follow_the_answer(ended):
    done, _ = ended
    assert done.returncode == 0
    assert "glossy_spheres" in str(json.loads(done.stdout))


@posix
def test_a_command_that_has_loaded_blender_leaves_no_temporary_file(ended):
    _, folder = ended
    assert list(folder.iterdir()) == []
