# SPDX-License-Identifier: GPL-3.0-or-later
"""What `etalon plan` answers in a process of its own, however that process ends."""

import sys

import pytest
from etalon.lib.batch import asked
from etalon.lib.errors import Cancelled
from etalon.lib.progress import Progress

# Ends when its parent does, as another `etalon` would.
WAITS = "import sys; sys.stdin.read()"


@pytest.fixture
def started(monkeypatch):
    """Have a line of Python run in place of `etalon`; returns the processes that were started."""
    processes = []

    def start(command, **pipes):
        processes.append(asked_start(command, **pipes))
        return processes[-1]

    def run(code):
        monkeypatch.setattr(asked, "etalon_command", lambda: [sys.executable, "-c", code])
        return processes

    asked_start = asked.start
    monkeypatch.setattr(asked, "start", start)
    return run


def test_what_is_printed_is_the_answer(started):
    started("print('{\"triangles\": 12}')")
    assert asked.ask_plan("a.blend", ()) == asked.Answer(0, {"triangles": 12})


@pytest.mark.parametrize(
    ("code", "answer"),
    [
        (
            "import os; os.kill(os.getpid(), 11)",
            asked.Answer(-11, None, "Blender ended with code -11 while it read the file"),
        ),
        ("import sys; sys.exit(1)", asked.Answer(1, None, "Blender ended with code 1 while it read the file")),
        ("import sys; print('etalon: no camera', file=sys.stderr); sys.exit(2)", asked.Answer(2, None, "no camera")),
        (
            "import sys; print('Traceback\\nKeyError: 3\\netalon: this is an error\\nnot freed', file=sys.stderr); sys.exit(70)",
            asked.Answer(
                70,
                None,
                "an error in etalon itself (KeyError: 3); please report what `etalon plan` prints for this file alone",
            ),
        ),
        ("import sys; sys.exit(2)", asked.Answer(2, None, "refused without a word")),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signal 11")
def test_an_end_without_an_answer_is_told(started, code, answer):
    started(code)
    assert asked.ask_plan("a.blend", ()) == answer


def test_more_than_a_pipe_holds_is_read(started):
    started("import sys; print('x' * 300000, file=sys.stderr); print('[' + '1,' * 300000 + '1]')")
    assert len(asked.ask_plan("a.blend", ()).found) == 300001


def test_a_file_that_takes_too_long_is_given_up(started):
    processes = started(WAITS)
    answer = asked.ask_plan("a.blend", (), patience=0.0)
    assert answer.error == "took longer than 0 s"
    assert processes[0].returncode is not None


def test_a_wish_to_end_is_heard_while_a_file_is_read(started):
    processes = started(WAITS)
    wishes = iter([False, False])
    with pytest.raises(Cancelled):
        asked.ask_plan("a.blend", (), Progress(is_cancelled=lambda: next(wishes, True)))
    assert processes[0].returncode is not None
