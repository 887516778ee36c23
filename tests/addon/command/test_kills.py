# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands that are ended at random moments lose nothing that was finished.

They leave neither processes nor files behind.
"""

import signal
import subprocess
import sys
from collections import Counter

import pytest
from etalon.tests.killed import ENDS, PATIENCE, SMALL, Place

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are found in Linux's /proc")
PLAN = f"""
out = "sweep"
scenes = ["lambert_analytic"]
[options]
time = "1s"
threads = 1
set = ["{SMALL}"]
[[vary]]
path = "scene.cycles.seed"
values = [1, 2]
"""
# The words of each command; its results go to the folder of its name, those of the batch to the plan's.
COMMANDS = {
    "compare": ["compare", "lambert_analytic", "--time=2s", "--threads=1", f"--set={SMALL}", "--out=compare"],
    "audit": ["audit", "lambert_analytic", "--time=2s", "--threads=1", f"--set={SMALL}", "--out=audit", "--all"],
    "cost": ["cost", "lambert_analytic", "--time=2s", "--threads=1", f"--set={SMALL}", "--out=cost", "--ways=mis"],
    "batch": ["batch", "plan.toml"],
}


@pytest.mark.parametrize(
    "kills", [pytest.param(4, marks=pytest.mark.slow), pytest.param(50, marks=pytest.mark.benchmark)]
)
def test_kills_lose_nothing_and_leave_nothing(tmp_path, rng, kills):
    place = Place(tmp_path, PLAN)
    folders = {name: name for name in COMMANDS} | {"batch": "sweep"}
    seconds = {name: place.finish(words) for name, words in COMMANDS.items()}
    assert place.left() == []
    names = {name: set(place.results(folder)) for name, folder in folders.items()}
    counted = Counter()
    for number in range(kills):
        name = list(COMMANDS)[number % len(COMMANDS)]
        how = (signal.SIGTERM, signal.SIGKILL)[(number + number // len(COMMANDS)) % 2]
        if name == "batch" and place.is_done(2):  # begin again, with other settings
            place.plan(PLAN.replace("[1, 2]", str([2 * number + k for k in (3, 4)])))
        before, finished, left = place.results(folders[name]), place.finished(), place.left()
        process = place.start(COMMANDS[name])
        try:
            process.wait(rng.uniform(0.0, 1.1 * seconds[name]))
        except subprocess.TimeoutExpired:
            process.send_signal(how)
        _, errors = process.communicate(timeout=PATIENCE)
        assert "Traceback" not in errors
        assert process.returncode in ENDS | {-signal.SIGKILL}, errors
        assert place.all_end(), (name, how)
        after = place.results(folders[name])
        if name != "batch":
            same = {file for file in before if after.get(file) == before[file]}
            assert not same or after == before, (name, how)
        assert finished <= place.finished()
        counted[f"{name} {how.name} ended with {process.returncode}"] += 1
        if how == signal.SIGTERM:
            assert set(place.left()) <= set(left)
    place.plan(PLAN)
    for name in COMMANDS:
        place.finish(COMMANDS[name])
        assert set(place.results(folders[name])) == names[name]
    assert place.processes() == []
    assert place.left() == []
    lines = [f"{count} x {what}" for what, count in sorted(counted.items())]
    sys.stdout.write("\n".join([f"{kills} kills", *lines, ""]))
