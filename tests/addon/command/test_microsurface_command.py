# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon microsurface`: a table for each question, and the same figures as JSON.

What it does not take is one line.
"""

import json

import pytest
from etalon.addon.command import cli
from etalon.lib.microsurface import measure


def test_tables_and_json_have_the_same_figures(monkeypatch, capsys):
    for name, value in (("CELLS", 48), ("PLACES", 4000), ("RAYS", 1000)):
        monkeypatch.setattr(measure, name, value)
    words = ["microsurface", "--alpha=0.5", "--angle=70", "--fields=2", "--correlation=4"]
    assert cli.main(words) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if line.strip().startswith("70°")]
    assert cli.main([*words, "--json"]) == 0
    (figures,) = json.loads(capsys.readouterr().out)["angles"]
    for row, name in zip(rows, ("visible", "mirror", "reflected_once"), strict=True):
        traced, *formulas = figures[name].values()
        shown = [float(word) for word in row[1:] if word != "±"]
        assert shown == pytest.approx([traced["mean"], traced["error"], *formulas], abs=6e-5)


@pytest.mark.parametrize(
    ("word", "told"), [("--angle=89", "give 0 to 88 degrees"), ("--correlation=40", "give 4 to 32 cells")]
)
def test_what_is_out_of_range_is_one_line(word, told, capsys):
    assert cli.main(["microsurface", word]) == 2
    assert told in capsys.readouterr().err
