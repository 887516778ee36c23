# SPDX-License-Identifier: GPL-3.0-or-later
"""Without Blender, or without its system libraries, a command says in one line what to install and ends with code 2."""

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


@pytest.mark.parametrize(
    ("state", "remedy"),
    [(NOT_INSTALLED, "pip install bpy"), (NO_LIBRARY, "apt-get install libx11-6")],
    ids=["not installed", "without a library"],
)
@pytest.mark.parametrize(
    "words",
    [
        ["compare", "furnace"],
        ["render", "furnace", "--out=x.exr"],
        ["plan", "a.blend"],
        ["scenes"],
        ["cost"],
        ["audit"],
    ],
    ids=lambda words: words[0],
)
def test_one_line_says_what_to_install(state, remedy, words, tmp_path):
    script = f"import sys\n{state}\nfrom etalon.addon.command.cli import main\nsys.exit(main(sys.argv[1:]))"
    done = subprocess.run(
        [sys.executable, "-c", script, *words], capture_output=True, text=True, timeout=120, cwd=tmp_path
    )
    (line,) = done.stderr.splitlines()
    assert done.returncode == 2
    assert line.startswith("etalon: Blender ")
    assert remedy in line
    assert not list(tmp_path.iterdir())
