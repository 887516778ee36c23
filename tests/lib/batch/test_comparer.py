# SPDX-License-Identifier: GPL-3.0-or-later
"""What a process that compares says, and how its end is known."""

import sys

import pytest
from etalon.lib.batch.comparer import Comparer

LONG = 60.0


@pytest.fixture
def comparer():
    """Starts Python with a code; all are ended."""
    started = []

    def begin(code, ahead=True):
        started.append(Comparer([sys.executable, "-c", code], ahead=ahead))
        return started[-1]

    yield begin
    for one in started:
        one.end()


def test_the_end_of_a_process_is_the_end_of_its_comparison(comparer):
    process = comparer("import sys; print('etalon: no camera', file=sys.stderr); sys.exit(2)", ahead=False)
    assert process.wait(LONG) == (2, "etalon: no camera\n")
    assert not process.is_free


def test_an_answer_ends_a_comparison_even_within_a_line(comparer):
    process = comparer(
        """
import os, sys
for line in sys.stdin:
    sys.stderr.write(line + "no end of line" + os.environ["ETALON_ANSWER"] + "4\\n")
    sys.stderr.flush()
"""
    )
    for turn in (1, 2):
        assert process.give([str(turn)])
        assert process.wait(LONG) == (4, f'["{turn}"]\nno end of line')
        assert (process.is_free, process.turns) == (True, turn)


def test_a_scene_cannot_say_that_a_comparison_has_ended(comparer):
    """What names of a scene print to standard error is no answer: they do not know its word."""
    code = "import sys; sys.stdin.readline(); print('ETALON_ANSWER0', '0' * 32 + '0', sep='\\n', file=sys.stderr)"
    process = comparer(f"{code}; sys.exit(1)")
    process.give([])
    assert process.wait(LONG)[0] == 1
    assert not process.is_free


def test_the_words_of_the_answers_differ(comparer):
    codes = [comparer("import os, sys; sys.stderr.write(os.environ['ETALON_ANSWER'][:-1])") for _ in range(2)]
    first, second = (process.wait(LONG)[1] for process in codes)
    assert len(first) == len(second) == 31
    assert first != second


def test_nothing_has_ended_before_it_does(comparer):
    process = comparer("import sys; sys.stdin.read()")
    assert process.wait(0.01) is None
    process.dismiss()
    assert process.process.returncode == 0


def test_one_that_is_ended_is_over(comparer):
    process = comparer("import sys\nwhile True: pass")
    process.end()
    assert process.wait(LONG) == (-9, "")
