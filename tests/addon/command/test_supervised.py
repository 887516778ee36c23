# SPDX-License-Identifier: GPL-3.0-or-later
"""A child that crashes is one line and exit code 2; what else it does passes through."""

import subprocess
import sys

import pytest
from etalon.addon.command.supervised import supervise

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="on Windows commands run where they stand")

SUPERVISOR = "import sys; from etalon.addon.command.supervised import supervise; sys.exit(supervise(sys.argv[1:]))"
WAITS = """
import signal, sys
signal.signal(signal.SIGTERM, lambda *_: sys.exit(130))
print("ready", flush=True)
signal.pause()
"""
LEASHED = """
import os, threading
threading.Thread(target=lambda: (os.read(0, 1), os._exit(0)), daemon=True).start()
print(os.getpid(), flush=True)
threading.Event().wait()
"""


def python(code):
    return [sys.executable, "-c", code]


@pytest.mark.parametrize("code", [0, 1, 3, 4, 70])
def test_exit_codes_pass_through(code):
    assert supervise(python(f"raise SystemExit({code})")) == code


@pytest.mark.parametrize("name", ["SIGSEGV", "SIGABRT", "SIGFPE"])
def test_a_crash_is_one_line(name, capfd):
    crash = f"import os, resource, signal; resource.setrlimit(resource.RLIMIT_CORE, (0, 0)); os.kill(os.getpid(), signal.{name})"
    assert supervise(python(crash)) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith(f"etalon: Blender or Cycles crashed ({name}); ")


def test_a_kill_names_memory_as_a_likely_cause(capfd):
    assert supervise(python("import os, signal; os.kill(os.getpid(), signal.SIGKILL)")) == 2
    assert "was killed (SIGKILL), as systems do when memory runs out" in capfd.readouterr().err


@pytest.fixture
def supervised():
    """Starts a supervisor of a child that runs some code; both are gone at the end."""
    started = []

    def begin(code):
        started.append(subprocess.Popen([*python(SUPERVISOR), *python(code)], stdout=subprocess.PIPE, text=True))
        return started[0]

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def test_an_order_to_end_reaches_the_child(supervised):
    process = supervised(WAITS)
    assert process.stdout.readline() == "ready\n"
    process.terminate()
    assert process.wait(60) == 130


def test_a_child_ends_with_a_supervisor_that_is_killed(supervised):
    process = supervised(LEASHED)
    assert int(process.stdout.readline()) > 0
    process.kill()
    # The child holds the other end of the pipe, which is at its end once the child is gone.
    assert process.stdout.read() == ""
