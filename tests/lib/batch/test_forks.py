# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that a server forks: what they get, how their end is known, and that none outlives whoever asked for it."""

import os
import select
import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest
from etalon.lib.batch import forks
from etalon.lib.batch.ahead import Ahead
from etalon.lib.batch.forks import ForkServer, can_fork
from etalon.lib.batch.process import end, send

pytestmark = pytest.mark.skipif(not can_fork(), reason="a fork server needs Linux 5.3")

LONG = 60.0
# Each process that is forked runs the code after the colon; nothing is loaded before.
SERVER = "from etalon.addon.host import fork_server; fork_server.load = lambda: None; fork_server.fork_as_asked()"
ECHO = (
    "import os, sys; line = sys.stdin.readline(); print(os.environ['WORD'], line.strip(), file=sys.stderr); sys.exit(5)"
)
WAITS = "import sys; print('ready', file=sys.stderr, flush=True); sys.stdin.read()"
# The child of a process that waits: it has the standard error of that, and ends only if it is ended.
WAITS_WITH_CHILD = "import subprocess; subprocess.Popen(['sleep', '1000']); " + WAITS
PARENT = """
import os, sys
from etalon.lib.batch.forks import ForkServer
server = ForkServer([sys.executable, "-c", sys.argv[1]])
process = server.fork({})
print(process.stderr.readline().strip(), process.pid, server._process.pid, flush=True)
sys.stdin.readline()
os.abort()
"""


@pytest.fixture
def serving():
    """Starts a server whose processes run some code; it is closed at the end."""
    servers = []

    def begin(code, before=""):
        servers.append(ForkServer([sys.executable, "-c", f"{before}\n{SERVER}\n{code}"]))
        return servers[0]

    yield begin
    for server in servers:
        server.close()


def close(process):
    """Let go of a process, and wait for its end; returns its exit code and what it still said."""
    process.stdin.close()
    with process.stderr:
        return process.wait(LONG), process.stderr.read()


def test_a_forked_process_has_its_variables_its_input_and_its_exit_code(serving):
    server = serving(ECHO)
    for number in range(3):
        process = server.fork({"WORD": f"word{number}"})
        send(process, "line é\n")
        assert close(process) == (5, f"word{number} line é\n")


def test_a_process_runs_until_it_ends(serving):
    process = serving(WAITS).fork({})
    assert process.poll() is None
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(0.01)
    assert close(process) == (0, "ready\n")
    assert process.poll() == 0


def test_the_signal_that_ends_a_process_is_known(serving):
    process = serving(WAITS).fork({})
    os.kill(process.pid, signal.SIGTERM)
    assert close(process)[0] == -signal.SIGTERM


def test_the_children_of_a_process_end_with_it(serving):
    process = serving(WAITS_WITH_CHILD).fork({})
    assert process.stderr.readline() == "ready\n"
    end(process)
    assert close(process) == (-signal.SIGKILL, "")


def test_children_that_start_before_the_server_goes_on_end_too(serving):
    """As if the server came so late to the group of the process that it is not there before."""
    late = "import os; real = os.setpgid; os.setpgid = lambda number, group: number or real(number, group)"
    process = serving(WAITS_WITH_CHILD, late).fork({})
    assert process.stderr.readline() == "ready\n"
    end(process)
    assert close(process) == (-signal.SIGKILL, "")


def test_a_process_can_be_ended_as_soon_as_it_is_there(serving):
    server = serving(WAITS)
    for _ in range(20):
        process = server.fork({})
        end(process)
        assert close(process)[0] == -signal.SIGKILL


def test_processes_do_not_hold_the_pipes_of_others(serving):
    server = serving(WAITS)
    first, second, third = (server.fork({}) for _ in range(3))
    for process in (second, first, third):
        assert close(process) == (0, "ready\n")


def test_where_the_server_is_gone_there_is_an_error(serving):
    server = serving("")
    server._process.kill()
    server._process.wait()
    for _ in range(2):
        with pytest.raises(ConnectionError, match="ended"):
            server.fork({})


def test_a_batch_does_without_a_server_that_is_gone(serving):
    server = serving("")
    server._process.kill()
    code = "import os, sys; sys.stdin.readline(); sys.exit(4)"
    ahead = Ahead("compare", [lambda words: [sys.executable, "-c", code, *words]], [""], 1, 1, {"": server})
    process = ahead.begin(0, [])
    assert process.wait(LONG) == (4, "")
    process.end()


def test_a_batch_forks_its_processes(serving):
    code = """
import os, sys
print(os.getppid(), sys.stdin.readline().strip(), file=sys.stderr)
print(os.environ["ETALON_ANSWER"] + "3", file=sys.stderr, flush=True)
"""
    server = serving(code)
    ahead = Ahead("compare", [lambda words: ["no-such-program", *words]] * 2, [""] * 2, 1, 1, {"": server})
    for number in range(2):
        process = ahead.begin(number, ["scene"])
        assert process.wait(LONG) == (3, f'{server._process.pid} ["scene"]\n')
        ahead.release(number, process)
    ahead.close()


def test_server_and_processes_end_when_the_one_that_asked_is_killed():
    call = [sys.executable, "-c", PARENT, f"{SERVER}\n{WAITS}"]
    parent = subprocess.Popen(call, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    said, *numbers = parent.stdout.readline().split()
    watched = [os.pidfd_open(int(number)) for number in numbers]
    parent.communicate("end\n", timeout=LONG)
    assert (said, len(watched)) == ("ready", 2)
    for one in watched:
        # It is ready to be read once its process has ended.
        assert select.select([one], [], [], LONG)[0] == [one]
        os.close(one)


def test_the_blender_program_does_not_fork(monkeypatch, tmp_path):
    program = tmp_path / "blender"
    program.touch()
    monkeypatch.setitem(sys.modules, "bpy", SimpleNamespace(app=SimpleNamespace(binary_path=str(program))))
    assert not can_fork()


@pytest.mark.parametrize("system", ["win32", "darwin"])
def test_other_systems_do_not_fork(monkeypatch, system):
    monkeypatch.setattr(forks.sys, "platform", system)
    assert not can_fork()


def test_a_kernel_that_cannot_watch_processes_does_not_fork(monkeypatch):
    def refuse(number):
        raise OSError(38, "Function not implemented")

    monkeypatch.setattr(forks.os, "pidfd_open", refuse)
    assert not can_fork()
