# SPDX-License-Identifier: GPL-3.0-or-later
"""A stand-in for `etalon compare`, and batches that run it.

It writes a verdict, refuses, crashes or hangs, as the value of --set says.
"""

import json
import sqlite3
from contextlib import closing

from etalon.lib.batch import run as batch
from etalon.lib.batch.plan import read_plan
from etalon.lib.batch.prepare import How
from etalon.lib.batch.results import End

# Notes each call, then ends as the value of --set says; the file it stands in for has the layout of a real verdict.json.
STAND_IN = """
import json, os, sys
from pathlib import Path
if os.environ.get("ETALON_LEASH") == "ahead":
    sys.argv[2:2] = json.loads(sys.stdin.readline() or sys.exit(0))
if sys.argv[1] == "plan":
    if any(a.endswith('="nowhere"') for a in sys.argv):
        print("etalon: x: no such property", file=sys.stderr)
        sys.exit(2)
    print("{}")
    sys.exit(0)
arguments = dict(a[2:].split("=", 1) for a in sys.argv[1:] if "=" in a)
value = json.loads(sys.argv[3].split(".x=", 1)[1])
with open("calls.txt", "a") as calls:
    print(json.dumps(sys.argv[1:]), file=calls)
if value == "crash":
    os.abort()
if value == "wrong" and not os.path.exists("mended"):
    print("Traceback (most recent call last):\\n  a line of it\\nIndexError: out of <range>", file=sys.stderr)
    print("etalon: this is an error in etalon itself; please report it with the text above", file=sys.stderr)
    sys.exit(70)
if value == "refuse":
    print("etalon: Floor: Velvet BSDF is not simulated; use a Glossy BSDF", file=sys.stderr)
    sys.exit(2)
out = Path(arguments["out"])
out.mkdir(parents=True, exist_ok=True)
(out / "verdict.json").write_text(open("verdict.json").read())
sys.exit(0 if value == "wrong" else int(value))
"""


def write_plan(folder, values, scenes=("glossy_spheres",)):
    """A plan over one property."""
    path = folder / "plan.toml"
    path.write_text(
        f'out = "out"\nscenes = {json.dumps(scenes)}\n[options]\ntime = 5\n'
        f'[[vary]]\nname = "<b>rough</b>"\npath = \'objects["A"].x\'\nvalues = {json.dumps(values)}\n'
    )
    return path


def run(path, blender="5.3.0", told=None, end=None, **how):
    """What `etalon batch` does with a plan."""
    tell = [].append if told is None else told.append
    return batch.run_plan(read_plan(path), How(blender, **how), tell, end=end or End())


def calls(folder):
    """The command lines that were run."""
    return [json.loads(line) for line in (folder / "calls.txt").read_text().splitlines()]


def statuses(folder):
    """Status and exit code of each value in the journal."""
    with closing(sqlite3.connect(folder / "out" / "journal.sqlite")) as journal:
        rows = journal.execute("select assignments, status, exit_code from units order by rowid").fetchall()
    return {json.loads(a)["<b>rough</b>"]: (status, code) for a, status, code in rows}


def write_scene(folder, text, files):
    """A scene of that content, which refers to `files`, and a plan over it."""
    (folder / "room.blend").write_text(text)
    found = json.dumps({"files": [str(folder / name) for name in files], "frames": [1, 250], "cameras": ["Front"]})
    (folder / "stand_in.py").write_text(STAND_IN.replace('print("{}")', f"print({found!r})"))
    return write_plan(folder, [0], scenes=["room.blend"])
