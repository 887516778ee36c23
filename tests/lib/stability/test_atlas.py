# SPDX-License-Identifier: GPL-3.0-or-later
"""The output of the atlas.

It is one line a case, JSON that any parser reads, and HTML that no name can break.
"""

import json
import math

import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.stability import atlas
from etalon.lib.stability.case import Case

HELD = Case("closed form", "a", 0.5, 8.0, "ulp", "x 1", printed=math.inf, cycles=2e6)
EXCUSED = Case("inversion", "<script>alert(1)</script>", 1e5, 32.0, "ulp", "u & v", judged=2.0, excuse="because <b>")
BROKEN = Case("identity", "c", 2.0, 1.0, "absolute", "everywhere")


def test_passing():
    assert HELD.passed
    assert EXCUSED.passed
    assert not BROKEN.passed
    assert not Case("f", "n", math.nan, 1.0, "u", "w").passed
    assert not Case("f", "n", math.inf, 1.0, "u", "w", judged=0.0).passed


def test_lines():
    assert atlas.line(HELD) == "ok   a: 0.5 (at most 8) ulp; printed not finite; Cycles 2.0e+06; x 1"
    assert atlas.line(EXCUSED).startswith("ok   <script>alert(1)</script>: 2 of 1.0e+05 (at most 32)")
    assert atlas.line(BROKEN).startswith("FAIL c: 2 (at most 1) absolute")


def test_files(tmp_path):
    atlas.write([HELD, EXCUSED, BROKEN], tmp_path / "new")
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == ["stability.html", "stability.json"]
    document = json.loads((tmp_path / "new" / "stability.json").read_text())
    assert document["passed"] is False
    assert [case["passed"] for case in document["cases"]] == [True, True, False]
    assert document["cases"][0]["printed"] == "inf"
    page = (tmp_path / "new" / "stability.html").read_text()
    assert "<script>" not in page
    assert "&lt;script&gt;" in page
    assert "1 BROKEN" in page


def test_a_place_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(EtalonError, match="is a file, not a folder"):
        atlas.write([HELD], tmp_path / "file")
