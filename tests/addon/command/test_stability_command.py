# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon stability`: a line a case, both files, and an exit code.

The exit code says whether a bound was broken.
"""

import json
import subprocess
import sys

import pytest
from etalon.addon.command import cli
from etalon.lib.stability import atlas
from etalon.lib.stability.case import Case

HELD = Case("closed form", "held", 0.5, 8.0, "ulp", "somewhere")
BROKEN = Case("closed form", "broken", 9.0, 8.0, "ulp", "elsewhere")


@pytest.mark.parametrize(("cases", "code"), [([HELD], 0), ([HELD, BROKEN], 1)])
def test_exit_code_and_files(cases, code, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(atlas, "equations", lambda points: iter(cases))
    assert cli.main(["stability", "--no-scenes", "--out", str(tmp_path / "out")]) == code
    shown = capsys.readouterr().out.splitlines()
    assert shown[: len(cases)] == [atlas.line(case) for case in cases]
    assert shown[-1].startswith(f"1 of {len(cases)} held")
    document = json.loads((tmp_path / "out" / "stability.json").read_text())
    assert document["passed"] is (code == 0)
    assert (tmp_path / "out" / "stability.html").exists()


def test_a_folder_that_cannot_be_made(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(atlas, "equations", lambda points: iter([HELD]))
    (tmp_path / "file").write_text("")
    assert cli.main(["stability", "--no-scenes", "--out", str(tmp_path / "file")]) == 2
    assert "is a file, not a folder" in capsys.readouterr().err


@pytest.mark.parametrize("points", ["0", "-3", "many"])
def test_points_are_a_count(points, capsys):
    assert cli.main(["stability", "--points", points]) == 2
    assert "--points" in capsys.readouterr().err


def test_equations_need_no_blender(tmp_path):
    code = (
        "import sys; from etalon.addon.command import cli; from etalon.lib.stability import atlas, case;"
        "atlas.equations = lambda points: iter([case.Case('f', 'n', 0.0, 1.0, 'u', 'w')]);"
        f"code = cli.main(['stability', '--no-scenes', '--out', {str(tmp_path)!r}]); sys.exit(code or 'bpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], timeout=120).returncode == 0
