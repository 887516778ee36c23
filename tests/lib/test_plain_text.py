# SPDX-License-Identifier: GPL-3.0-or-later
"""Names from untrusted files: on a terminal, as a folder, in a spreadsheet."""

from pathlib import PurePosixPath, PureWindowsPath

import pytest
from etalon.lib.plain_text import folder_name, one_line, spreadsheet_cell

NAMES = [
    "..",
    ".",
    "",
    "...blend",
    "/etc",
    "a/../../b",
    "C:\\x",
    "con",
    "NUL.txt",
    "a\x00b",
    "x. ",
    "\u202e",
    300 * "é",
    "~",
    "a:b",
]


@pytest.mark.parametrize("name", NAMES)
def test_a_folder_name_is_one_part_of_a_path_on_every_system(name):
    made = folder_name(name)
    for path in (PurePosixPath(made), PureWindowsPath(made)):
        assert path.parts == (made,)
    assert made not in {".", "..", ""}
    assert made.isprintable()
    assert made == made.rstrip(". ")
    assert len(made.encode()) <= 110
    assert made.partition(".")[0].lower() not in {"con", "nul"}


def test_ordinary_names_stay_as_they_are():
    for name in ("kitchen", "Küche 2", "scene.v3", "台所"):
        assert folder_name(name) == one_line(name) == name


def test_a_line_stays_one():
    assert one_line("a\nb\rc\u2028d\x1b[2J\x85\u202e\ud800") == "a\\nb\\rc\\u2028d\\x1b[2J\\x85\\u202e\\ud800"


@pytest.mark.parametrize("text", ["=1+1", "+x", "-x", "@SUM(A1)", "\t=1", "\r=1", " =1", "-1+1", "=cmd|' /C calc'!A0"])
def test_a_formula_becomes_a_text(text):
    assert spreadsheet_cell(text) == f"'{text}"


@pytest.mark.parametrize("value", [-1, -0.5, "-0.5", "+1e-3", None, True, "kitchen", "a=b", ""])
def test_numbers_and_plain_texts_stay(value):
    assert spreadsheet_cell(value) is value
