# SPDX-License-Identifier: GPL-3.0-or-later
"""A process of Étalon's own ends with the one that started it.

It removes its temporary files.
"""

import os
import signal
import subprocess
import sys

import pytest
from etalon.lib.batch.process import ANSWER, LEASH, send, start
from etalon.lib.exit_codes import ExitCode

CHILD = """
from etalon.addon.host.own_process import watch_leash
watch_leash()
print("watching", flush=True)
while True:
    pass
"""
ORDERS = """
import sys
from etalon.addon.host.own_process import Orders
orders = Orders()
for code in (0, 3):
    print(orders.receive(), flush=True)
    orders.answer(code)
if "busy" in sys.argv:
    orders.receive()
    while True:
        pass
orders.receive()
"""
PARENT = """
import os, sys
from etalon.lib.batch.process import start
child = start([sys.executable, "-c", sys.argv[1]], leash=True)
sys.stdin.readline()
os.abort()
"""
ORDERED = """
import os, signal, tempfile
from etalon.addon.command.console import ended_by_interrupt
from etalon.addon.host.own_process import gather_temporary_files
gather_temporary_files()
open(os.path.join(tempfile.gettempdir(), "left"), "w").close()
with ended_by_interrupt():
    os.kill(os.getpid(), signal.SIGTERM)
    while True:
        pass
"""


def test_a_child_ends_when_its_leash_is_let_go():
    child = start([sys.executable, "-c", CHILD], leash=True, stdout=subprocess.PIPE)
    assert child.stdout.readline() == "watching\n"
    child.stdin.close()
    assert child.wait(timeout=60) == ExitCode.INTERRUPTED
    child.stdout.close()


def test_a_child_ends_when_its_parent_is_killed():
    call = [sys.executable, "-c", PARENT, CHILD]
    parent = subprocess.Popen(call, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert parent.stdout.readline() == "watching\n"  # the child writes to the same pipe
    parent.stdin.write("end\n")
    parent.stdin.close()
    assert parent.wait(timeout=60) != 0
    assert parent.stdout.read() == ""  # closed: the child is gone
    parent.stdout.close()


def test_a_process_without_a_leash_does_not_look_at_its_input():
    script = CHILD.replace("while True:\n    pass", "import threading; print(threading.active_count())")
    environment = {key: value for key, value in os.environ.items() if key != LEASH}
    done = subprocess.run(
        [sys.executable, "-c", script],
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.stdout == "watching\n1\n"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows ends a process without asking it")
def test_an_order_to_end_while_blender_loads_leaves_no_temporary_file(tmp_path):
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", ORDERED], env=environment, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (ExitCode.INTERRUPTED, "")
    assert list(tmp_path.iterdir()) == []
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


@pytest.mark.parametrize("busy", [[], ["busy"]])
def test_a_process_gets_its_words_line_by_line_and_ends_with_its_input(busy):
    child = start(
        [sys.executable, "-c", ORDERS, *busy],
        ahead=True,
        leash=True,
        variables={ANSWER: "word"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    # Two lines at once, and one in two pieces.
    send(child, '["b.blend", "--set=é"]\n["second"]\n["th')
    assert child.stdout.readline() == "['b.blend', '--set=é']\n"
    assert child.stdout.readline() == "['second']\n"
    assert (child.stderr.readline(), child.stderr.readline()) == ("word0\n", "word3\n")
    send(child, 'ird"]\n' if busy else "")
    child.stdin.close()
    assert child.wait(timeout=60) == ExitCode.INTERRUPTED
    for pipe in (child.stdout, child.stderr):
        pipe.close()
