# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands without Blender, or without its system libraries.

A command says in one line what to install and ends with code 2.
"""

import json
import subprocess
import sys

import pytest

NOT_INSTALLED = "sys.modules['bpy'] = None"
# What the dynamic linker says of the first library that it does not find.
NO_LIBRARY = """
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == "bpy":
            raise ImportError("libX11.so.6: cannot open shared object file: No such file or directory", name="bpy")
sys.meta_path.insert(0, Finder())
"""


# One process for all commands: what they import takes most of the time.
SCRIPT = """
import contextlib, io, json, sys
{state}
from etalon.addon.command.cli import main
said = []
for words in json.loads(sys.argv[1]):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(words)
    said.append([code, out.getvalue(), err.getvalue()])
print(json.dumps(said))
"""
COMMANDS = (
    ("compare", "furnace"),
    ("render", "furnace", "--out=x.exr"),
    ("plan", "a.blend"),
    ("scenes",),
    ("cost", "furnace"),
    ("audit", "furnace"),
)


@pytest.mark.parametrize(
    ("state", "remedy"),
    [
        (NOT_INSTALLED, "pip install bpy"),
        pytest.param(NO_LIBRARY, "apt-get install libx11-6", marks=pytest.mark.slow),
    ],
    ids=["not installed", "without a library"],
)
def test_one_line_of_each_command_says_what_to_install(state, remedy, tmp_path):
    call = [sys.executable, "-c", SCRIPT.format(state=state), json.dumps(COMMANDS)]
    done = subprocess.run(call, capture_output=True, text=True, timeout=300, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    for words, (code, _, err) in zip(COMMANDS, json.loads(done.stdout), strict=True):
        (line,) = err.splitlines()
        assert code == 2, words
        assert line.startswith("etalon: Blender "), words
        assert remedy in line, words
    assert not list(tmp_path.iterdir())
