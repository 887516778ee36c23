# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole process is set up for tracing where it is Étalon's own, and nowhere else."""

import ast
import subprocess
import sys
from pathlib import Path

import etalon
import pytest
from etalon.lib.wavefront import tuning

ROOT = Path(etalon.__file__).parent
PROCESS_WIDE = {"tune_process", "setswitchinterval", "mallopt"}
PROGRAM = """
import sys
from etalon.lib.wavefront import tuning
asked = []
tuning._glibc = lambda name: (lambda *values: asked.append((name, *values)))
before = sys.getswitchinterval()
{action}
assert abs(sys.getswitchinterval() - (tuning.SWITCH_INTERVAL if {tuned} else before)) < 1e-9
assert bool(asked) == {tuned}, asked
"""
RENDER = """
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import diffuse, floor, perspective, scene
room = scene(floor(2.0, 0.0), diffuse(0.5), perspective(4, 4, 0.8, (0.0, 0.0, 3.0), (0.0, 0.0, -1.0)))
ReferenceRenderer(room).render(0, 1)
"""
COMMAND = """
from etalon.addon.command.cli import main
assert main(["scenes"]) == 0
"""


def run(action, tuned):
    code = PROGRAM.format(action=action, tuned=tuned)
    return subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(("action", "tuned"), [(RENDER, False), (COMMAND, True)], ids=["a script", "the command"])
def test_only_the_command_sets_up_its_process(action, tuned):
    """A script that renders stands for the user's Blender.

    There the extension renders in the same way.
    """
    done = run(action, tuned)
    assert done.returncode == 0, done.stderr


def test_memory_is_given_back_once_the_heap_keeps_it():
    done = run("tuning.tune_process(); asked.clear(); tuning.give_back_memory()", True)
    assert done.returncode == 0, done.stderr
    done = run("tuning.give_back_memory()", False)
    assert done.returncode == 0, done.stderr


def test_who_asks_for_it():
    """The command line's main and the second Blender's worker.

    No other file changes the allocator or the threads' turns.
    """
    callers = []
    for path in (p for room in ("lib", "addon") for p in sorted((ROOT / room).rglob("*.py"))):
        source = path.read_text(encoding="utf-8")
        if not any(word in source for word in PROCESS_WIDE):
            continue
        names = {
            node.attr if isinstance(node, ast.Attribute) else node.id
            for node in ast.walk(ast.parse(source))
            if isinstance(node, ast.Attribute | ast.Name)
        }
        if names & PROCESS_WIDE and path.name != "tuning.py":
            callers.append(path.relative_to(ROOT).as_posix())
    assert callers == ["addon/command/cli.py", "addon/cycles/worker.py"]
    assert tuning.SWITCH_INTERVAL < 5e-3
