# SPDX-License-Identifier: GPL-3.0-or-later
"""What the process has loaded that a batch forks its comparisons from."""

import json
import subprocess
import sys

import pytest
from etalon.lib.batch.forks import can_fork

pytestmark = pytest.mark.skipif(not can_fork(), reason="a fork server needs Linux 5.3")

SCRIPT = """
import json, os, sys
from etalon.addon.command import cli
from etalon.addon.host.fork_server import load
load()
loaded, threads = set(sys.modules), len(os.listdir("/proc/self/task"))
import bpy
import etalon.addon.command.compare
from etalon.lib.pages import page
from etalon.lib.report import page as report
names = [name for name in sys.modules if name.startswith(("etalon.lib.", "scipy."))]
environment = page._environment(page.Path(report.__file__).parent)
print()
print(json.dumps([sorted(loaded), threads, sorted({*names} - loaded), len(environment.cache)]))
"""


@pytest.fixture(scope="module")
def told():
    """The modules that the server has loaded, its threads, what a comparison loads more, and how many templates are compiled."""
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True, timeout=120)
    return json.loads(done.stdout.splitlines()[-1])


def test_the_fork_server_has_not_loaded_blender(told):
    loaded, threads, _, _ = told
    assert "bpy" not in loaded
    assert threads == 1  # others would not be there in what is forked


def test_a_forked_comparison_loads_nothing_of_lib_or_scipy_again(told):
    assert told[2] == []


def test_the_fork_server_has_compiled_the_templates_of_reports(told):
    assert told[3] >= 9
