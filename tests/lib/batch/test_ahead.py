# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that are started before their turn: one comparison each, and none left."""

import os
import sys

import pytest
from etalon.addon.host import own_process
from etalon.lib.batch.ahead import Ahead

# Says which process it is, and what it was told.
TOLD = "import os, sys; words = sys.stdin.readline(); print(os.getpid(), words.strip()) if words else None"


@pytest.fixture
def starting():
    """Starts processes with the code of each comparison, one ahead.

    It collects all that it started.
    """
    made = []

    def begin(*codes):
        made.append(
            Ahead("compare", [lambda words, code=code: [sys.executable, "-c", code, *words] for code in codes], 1)
        )
        return made[0]

    yield begin
    for ahead in made:
        ahead.close()


def test_each_comparison_has_a_process_of_its_own_that_is_told_its_words(starting):
    ahead = starting(TOLD, TOLD, TOLD)
    said = [ahead.begin(number, [f"scene{number}"]).communicate()[0].split(maxsplit=1) for number in range(3)]
    assert [words for _, words in said] == [f'["scene{number}"]\n' for number in range(3)]
    assert len({process for process, _ in said}) == 3


def test_one_that_died_while_it_waited_is_replaced(starting, tmp_path):
    dies_once = (
        f"import os, sys\ntry: os.mkdir({str(tmp_path / 'died')!r})\nexcept OSError: print(sys.stdin.readline())\n"
    )
    ahead = starting(TOLD, dies_once)
    ahead.begin(0, []).communicate()
    ahead._waiting[1].wait()
    assert ahead.begin(1, ["scene"]).communicate()[0].strip() == '["scene"]'


def test_those_that_wait_end_and_nothing_is_started_after_the_last(starting):
    ahead = starting(TOLD, TOLD)
    ahead.begin(0, []).communicate()
    waiting = ahead._waiting[1]
    ahead.close()
    assert waiting.returncode == 0
    ahead.begin(1, []).communicate()
    assert not ahead._waiting


def test_the_words_of_a_process_that_waits_end_with_their_line(monkeypatch):
    reader, writer = os.pipe()
    os.write(writer, '["b.blend", "--set=é"]\n'.encode() + b"left for the leash")
    read = os.read
    monkeypatch.setattr(own_process.os, "read", lambda _, count: read(reader, count))
    assert own_process.receive_words() == ["b.blend", "--set=é"]
    assert read(reader, 100) == b"left for the leash"
    os.close(reader)
    os.close(writer)


def test_a_comparison_that_begins_again_starts_nothing_for_one_that_has_begun(starting):
    ahead = starting(TOLD, TOLD, TOLD)
    for number in (0, 1, 0):
        ahead.begin(number, []).communicate()
    assert set(ahead._waiting) == {2}


def test_one_that_cannot_be_started_ahead_fails_in_its_own_turn():
    def missing(words):
        return ["no-such-program", *words]

    ahead = Ahead("compare", [lambda words: [sys.executable, "-c", TOLD, *words], missing], 1)
    ahead.begin(0, []).communicate()
    with pytest.raises(OSError, match="no-such-program"):
        ahead.begin(1, [])
    ahead.close()
