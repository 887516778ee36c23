# SPDX-License-Identifier: GPL-3.0-or-later
"""How values are read from text, checked, and written back."""

import math
from pathlib import Path

import pytest
from etalon.lib.settings.units import (
    Choice,
    FilePath,
    Flag,
    Keys,
    Names,
    Pair,
    Seconds,
    Share,
    Texts,
    Whole,
    WholeOrPair,
)
from hypothesis import given
from hypothesis import strategies as st


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("90", 90),
        ("90s", 90),
        (" 2m ", 120),
        ("2 min", 120),
        ("1.5h", 5400),
        ("1h30m", 5400),
        ("1h 30m 5s", 5405),
        (".5", 0.5),
    ],
)
def test_times_are_read_with_and_without_unit(text, seconds):
    assert Seconds().read(text) == seconds


@pytest.mark.parametrize("text", ["", "m", "2x", "2m3", "3 2", "1 2m", "0", "-5", "inf", "nan", "1e999", "2mm", "1:30"])
def test_texts_that_are_no_time_are_refused_with_a_remedy(text):
    with pytest.raises(ValueError, match="2m"):
        Seconds().read(text)


@pytest.mark.parametrize(("text", "share"), [("0.01", 0.01), ("1%", 0.01), ("0.5 %", 0.005), ("1e-3", 1e-3)])
def test_shares_are_read_as_numbers_and_in_per_cent(text, share):
    assert Share().read(text) == pytest.approx(share, rel=1e-15)


@pytest.mark.parametrize("text", ["0", "1", "100%", "0%", "nan", "-1%", "two", "", "%"])
def test_texts_that_are_no_share_are_refused_with_a_remedy(text):
    with pytest.raises(ValueError, match="1%"):
        Share().read(text)


@pytest.mark.parametrize(("value", "fits"), [(0.5, True), (0.499, False), (1.0, False), (0.999, True)])
def test_a_lower_limit_of_a_share_is_included(value, fits):
    if fits:
        assert Share(low=0.5).check(value) == value
    else:
        with pytest.raises(ValueError, match=r"at least 0\.5"):
            Share(low=0.5).check(value)


@given(st.floats(1e-300, 1 - 1e-15))
def test_a_share_is_read_back_exactly(value):
    assert Share().read(Share().write(value)) == value


@given(st.floats(1e-3, 1e9).filter(lambda v: v >= 1e-3 and "e" not in repr(v)))
def test_a_time_is_read_back_exactly(value):
    assert Seconds().read(Seconds().write(value)) == value


@given(st.integers())
def test_a_whole_number_is_read_back_exactly(value):
    assert Whole().read(Whole().write(value)) == value


@pytest.mark.parametrize("text", ["1.5", "0", "-3", "many", "", "１", "1_0"])
def test_texts_that_are_no_count_are_refused(text):
    with pytest.raises(ValueError, match="at least 1"):
        Whole(least=1).read(text)


@pytest.mark.parametrize(
    ("unit", "value"),
    [
        (Share(), True),
        (Share(), None),
        (Seconds(), math.inf),
        (Whole(), 1.0),
        (Whole(), True),
        (WholeOrPair(least=1), (1, 2, 3)),
        (WholeOrPair(least=1), (1, 0)),
        (Flag(), "yes"),
        (Choice("NAME", "form", ("a", "b")), "c"),
        (Names(what="name", known=lambda: {"a"}), ["b"]),
        (Names(what="name", known=lambda: {"a"}), "a"),
        (Texts(), "one"),
        (Keys(), ["a", ""]),
        (FilePath(), ""),
        (FilePath(), 3),
        (Pair("A B"), ("a",)),
    ],
)
def test_values_of_another_kind_are_refused(unit, value):
    with pytest.raises(ValueError, match=r"\w"):
        unit.check(value)


@pytest.mark.parametrize(
    ("unit", "value"),
    [
        (WholeOrPair(least=1), (4, 32)),
        (Names(known=lambda: {"a", "b"}), frozenset({"b", "a"})),
        (Texts(), ("x=1", "y=2")),
        (Keys(), ("mis", "cycles")),
        (FilePath(), Path("a/b")),
        (Pair("A B"), ("a", "b")),
    ],
)
def test_plain_values_are_accepted_back(unit, value):
    assert unit.check(unit.plain(value)) == value
