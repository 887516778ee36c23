# SPDX-License-Identifier: GPL-3.0-or-later
"""The processes of a batch: several comparisons each, replaced in time, and none left."""

import os
import sys

import pytest
from etalon.lib.batch.ahead import Ahead

# For each line of words, says which process it is and the words, and answers that it ended with code 3.
SERVES = """
import os, sys
for words in sys.stdin:
    print(os.getpid(), words.strip(), file=sys.stderr)
    print(os.environ["ETALON_ANSWER"] + "3", file=sys.stderr, flush=True)
"""
# The same for one line only: it then ends with code 5.
ONCE = f"{SERVES}    sys.exit(5)".replace(
    '    print(os.environ["ETALON_ANSWER"] + "3", file=sys.stderr, flush=True)\n', ""
)
LONG = 60.0


@pytest.fixture
def starting():
    """Starts processes with the code of each comparison, one side by side.

    All are closed at the end.
    """
    made = []

    def begin(*codes, kinds=None, turns=20):
        commands = [lambda words, code=code: [sys.executable, "-c", code, *words] for code in codes]
        made.append(Ahead("compare", commands, kinds or [""] * len(codes), 1, turns))
        return made[0]

    yield begin
    for ahead in made:
        ahead.close()


def run(ahead, number, words=()):
    """Run one comparison to its end; returns its exit code, the number of its process and what that was told."""
    process = ahead.begin(number, list(words))
    code, said = process.wait(LONG)
    ahead.release(number, process)
    process_number, told = said.split(maxsplit=1)
    return code, int(process_number), told.strip()


def test_one_process_runs_comparisons_one_after_the_other(starting):
    ahead = starting(SERVES, SERVES, SERVES)
    done = [run(ahead, number, [f"scene{number}"]) for number in range(3)]
    assert [(code, told) for code, _, told in done] == [(3, f'["scene{number}"]') for number in range(3)]
    assert len({process for _, process, _ in done}) == 1


def test_a_process_is_replaced_after_its_last_turn_by_one_that_was_started_before(starting):
    ahead = starting(*[SERVES] * 5, turns=2)
    process = ahead.begin(0, [])
    process.wait(LONG)
    assert not ahead._waiting[""]
    ahead.release(0, process)
    process = ahead.begin(1, [])
    assert len(ahead._waiting[""]) == 1
    process.wait(LONG)
    ahead.release(1, process)
    assert process.process.poll() == 0
    assert len({run(ahead, number)[1] for number in (2, 3, 4)}) == 2


def test_a_comparison_that_ends_its_process_ends_no_other(starting):
    ahead = starting(ONCE, SERVES, SERVES)
    (first, one, _), *rest = [run(ahead, number) for number in range(3)]
    assert first == 5
    assert [code for code, _, _ in rest] == [3, 3]
    assert one not in {process for _, process, _ in rest}


def test_a_comparison_that_begins_again_has_a_new_process(starting):
    ahead = starting(SERVES, SERVES)
    assert len({run(ahead, 0)[1] for _ in range(3)}) == 3


def test_each_blender_has_processes_of_its_own(starting):
    ahead = starting(*[SERVES] * 4, kinds=["4.5", "5.2", "4.5", "5.2"])
    processes = [run(ahead, number)[1] for number in range(4)]
    assert processes[:2] == processes[2:]
    assert processes[0] != processes[1]


def test_one_that_died_while_it_waited_is_replaced(starting):
    ahead = starting(SERVES, SERVES)
    process = ahead.begin(0, [])
    process.wait(LONG)
    ahead.release(0, process)
    os.kill(process.process.pid, 9)
    process.process.wait()
    assert run(ahead, 1, ["scene"])[::2] == (3, '["scene"]')


def test_one_that_has_taken_much_memory_is_replaced(starting, monkeypatch):
    monkeypatch.setattr("etalon.lib.batch.ahead.resident_memory", lambda _: 2e9)
    ahead = starting(SERVES, SERVES)
    assert run(ahead, 0)[1] != run(ahead, 1)[1]


def test_those_that_wait_end_and_nothing_is_started_after_the_last(starting):
    ahead = starting(SERVES, SERVES, turns=1)
    process = ahead.begin(0, [])
    process.wait(LONG)
    (waiting,) = ahead._waiting[""]
    ahead.release(0, process)
    ahead.close()
    assert waiting.process.returncode == 0
    run(ahead, 1)
    assert not any(ahead._waiting.values())


def test_one_that_cannot_be_started_ahead_fails_in_its_own_turn(starting):
    ahead = starting(SERVES, SERVES, turns=1)
    ahead._commands[1] = lambda words: ["no-such-program", *words]
    run(ahead, 0)
    with pytest.raises(OSError, match="no-such-program"):
        ahead.begin(1, [])
