# SPDX-License-Identifier: GPL-3.0-or-later
"""Many files at once: which can be compared, and what stops the others."""

import csv
import io
import json
import threading
from dataclasses import replace

import bpy
import pytest
from etalon.addon.command import cli, survey
from etalon.addon.command.survey import FAILED, PASSES, REFUSED, Surveyed, as_csv, as_text, count_reasons, find_files
from etalon.lib.batch.asked import Answer
from etalon.lib.errors import EtalonError, Refusal, Refused
from etalon.lib.progress import Progress
from etalon.lib.refusals import describe_refusals, group_refusals, is_for_command_line

SKINS = [
    Refusal(f"material 'Skin {k}'", f"node 'N{k}' (Principled BSDF), socket 'Subsurface', ", "set it to 0")
    for k in (0, 0)
]
SIMPLIFY = Refusal("scene 'Scene'", "Simplify", "switch it off")
SETTABLE = replace(SIMPLIFY, assignment="scene.render.use_simplify=false")
FUR = Refusal("object 'Fur'", "hair curves", "do not render it", 'objects["Fur"].hide_render=true')


def test_the_same_reason_stands_once_with_its_owners_and_the_most_frequent_first():
    many = [Refusal(f"material 'M{k}'", "Toon", "remove it") for k in range(6)]
    reasons = group_refusals([SIMPLIFY, *many, many[0]])
    assert [str(reason) for reason in reasons] == [
        "6 materials ('M0', 'M1', 'M2', 'M3' and 2 more): Toon is not simulated; remove it",
        "scene 'Scene': Simplify is not simulated; switch it off",
    ]
    assert str(group_refusals([Refusal("the file", "colorspace", "reset it")])[0]).startswith("the file: colorspace is")


@pytest.mark.parametrize(
    ("refusals", "last"),
    [
        (SKINS, "--partial compares the rest"),
        ([*SKINS, SIMPLIFY], "without 'Simplify', --partial compares the rest"),
        ([SIMPLIFY], "scene 'Scene': Simplify is not simulated; switch it off"),
        ([SETTABLE], "--set scene.render.use_simplify=false compares the rest"),
        ([*SKINS, SETTABLE], "--partial --set scene.render.use_simplify=false compare the rest"),
        ([FUR, SIMPLIFY], """without 'Simplify', --set 'objects["Fur"].hide_render=true' compares the rest"""),
        (
            [replace(FUR, owner=f"object 'Fur {k}'") for k in range(9)],
            str(group_refusals([replace(FUR, owner=f"object 'Fur {k}'") for k in range(9)])[0]),
        ),
    ],
)
def test_a_refusal_ends_with_what_would_work(refusals, last):
    lines = describe_refusals(Refused(refusals))
    assert lines[-1] == last
    assert [line for line in lines if is_for_command_line(line)] == [line for line in lines if "--" in line]


def test_partial_is_not_advised_where_it_is_not_allowed():
    """As beside --motion-blur: materials stand in the way like everything else."""
    assert describe_refusals(Refused(SKINS, allows_partial=False)) == [str(one) for one in group_refusals(SKINS)]
    *_, last = describe_refusals(Refused([*SKINS, SETTABLE], allows_partial=False))
    assert last.endswith(", --set scene.render.use_simplify=false compares the rest")
    assert "--partial" not in last


def test_reasons_are_counted_over_files_whatever_their_names():
    other = Refusal("material 'Ear'", "node 'Other' (Principled BSDF), socket 'Subsurface', ", "set it to 0")
    files = [
        Surveyed("a.blend", PASSES, 12, 1),
        Surveyed("b.blend", REFUSED, refused=(SKINS[0],)),
        Surveyed("c.blend", REFUSED, refused=(other, SIMPLIFY)),
        Surveyed("d.blend", FAILED, error="Blender ended with code -11 while it read the file"),
    ]
    assert count_reasons(files) == [
        ("material: Principled BSDF, socket 'Subsurface'", 2, 1),
        ("scene: Simplify", 1, 0),
        ("Blender ended with code -11 while it read the file", 1, 1),
    ]
    assert "1 of 4 files can be compared." in as_text(files, 4)
    rows = list(csv.reader(io.StringIO(as_csv(files))))
    assert [row[1] for row in rows[1:]] == [PASSES, REFUSED, REFUSED, FAILED]
    assert len(rows[3][4].splitlines()) == 2


def test_a_folder_without_files_is_told(tmp_path):
    with pytest.raises(EtalonError, match=r"no \.blend file in it"):
        find_files(tmp_path)


def test_files_are_read_one_by_one_and_a_damaged_one_is_a_row(capfd, tmp_path):
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    (tmp_path / "below").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "good.blend"))
    bpy.context.scene.render.use_simplify = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "below" / "simple.blend"))
    (tmp_path / "damaged.blend").write_bytes(b"BLENDER-v500" + bytes(100))
    capfd.readouterr()
    assert cli.main(["plan", str(tmp_path), "--json", "--csv", str(tmp_path / "files.csv")]) == 0
    found = json.loads(capfd.readouterr().out)
    states = {row["file"].replace("\\", "/"): row["state"] for row in found["files"]}
    assert states == {"below/simple.blend": REFUSED, "damaged.blend": REFUSED, "good.blend": PASSES}
    assert found["files"][2]["triangles"] == 12
    assert {row["reason"] for row in found["reasons"]} >= {"scene: Simplify"}
    assert len((tmp_path / "files.csv").read_text().splitlines()) == 4
    assert found["found"] == 3


def test_what_was_read_before_an_interruption_is_kept(monkeypatch, tmp_path):
    """The second file is still being read when Ctrl-C comes, and the third waits."""
    stopped = threading.Event()

    def answer(path, options, progress):
        if not path.endswith("a.blend"):
            stopped.wait()
        progress.check()
        return Answer(0, {"triangles": 12, "lights": 1})

    monkeypatch.setattr(survey, "ask_plan", answer)
    paths = [tmp_path / f"{name}.blend" for name in "abc"]
    progress = Progress(lambda share: stopped.set(), stopped.is_set)
    files = list(survey.survey(paths, tmp_path, (), progress))
    assert [one.file for one in files] == ["a.blend"]
    *_, last = as_text(files, 3).splitlines()
    assert last == "Interrupted: 2 of 3 files were not read."
    assert "0 of 0 files can be compared." in as_text([], 3)
