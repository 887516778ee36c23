# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon versions` with the Blender at hand as every version, in processes of their own."""

import json
import os
import sys
from pathlib import Path

import bpy
import etalon.lib.versions as package
import pytest
from etalon.addon.command import cli, versions
from etalon.addon.versions import SceneResult
from etalon.lib.errors import Cancelled
from etalon.lib.exit_codes import ExitCode
from etalon.lib.versions.document import scene_figures
from etalon.reference_scenes import building
from jsonschema import Draft202012Validator

PYTHON = """#!/bin/sh
exec {python} "$@"
"""


@pytest.fixture
def pythons(tmp_path):
    """Two programs that are this Python, at paths of their own."""
    paths = [tmp_path / name for name in ("first", "second")]
    for path in paths:
        path.write_text(PYTHON.format(python=sys.executable))
        path.chmod(0o755)
    return [f"--blender={path}" for path in paths]


@pytest.fixture
def floor(tmp_path):
    """A file with a bright floor under a lamp, and one with what no reader knows."""
    scene = building.start("floor", 24, 16, 0)
    paper = building.diffuse("Paper", (0.8, 0.8, 0.8))
    building.rectangle("Floor", paper, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    building.sphere_light("Lamp", (0.1, 0.1, 1.5), 0.3, (10.0, 10.0, 10.0))
    building.camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), ortho_scale=1.0)
    path = tmp_path / "floor.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    tree = paper.node_tree
    out = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(tree.nodes.new("ShaderNodeBsdfHair").outputs[0], out.inputs["Surface"])
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "hair.blend"), copy=True)
    assert scene.name == "floor"
    return path


def run(*words):
    return cli.main(["versions", *map(str, words), "--quiet", "--threads=1", "--samples=2", "--replicates=3"])


REFUSING = """#!{python}
import json, sys
if "--version" in sys.argv:
    print("Python 3.11.0")
    sys.exit(0)
request = json.loads(sys.argv[-1])
if "words" in request:
    print("etalon: Floor: Hair BSDF is not simulated; replace it", file=sys.stderr)
    sys.exit(2)
print("etalon: " + json.dumps({{"version": [{version}], "shown": "x", "build": "b", "python": "3.11", "missing": []}}))
"""


@pytest.mark.skipif(
    os.name == "nt", reason="the stand-ins for Blender are scripts with a first line that Windows ignores"
)
def test_what_every_version_refuses_is_told_with_its_reason(tmp_path, capsys):
    words = []
    for version in ("4, 5, 0", "5, 2, 0"):
        path = tmp_path / f"python{version[0]}"
        path.write_text(REFUSING.format(python=sys.executable, version=version).replace('"x"', f'"{version}"'))
        path.chmod(0o755)
        words.append(f"--blender={path}")
    assert run("furnace", *words, f"--out={tmp_path / 'out'}") == ExitCode.BAD_INPUT
    said = capsys.readouterr().out
    assert "5, 2, 0 against the reference: refused: Floor: Hair BSDF is not simulated; replace it" in said
    assert "fewer than two versions can render it" in said
    assert "Nothing was compared." in said
    assert "Hair BSDF" in (tmp_path / "out" / "versions.html").read_text(encoding="utf-8")


def test_what_is_cancelled_is_told_and_what_was_done_before_is_kept(tmp_path, capsys, monkeypatch):
    done = SceneResult(scene_figures("furnace", [], None, "no camera"), {})

    def compare(name, *rest):
        if name == "furnace":
            return done
        raise Cancelled("cancelled")

    monkeypatch.setattr(versions, "compare_versions", compare)
    monkeypatch.setattr(versions, "find_blenders", lambda *rest: ())
    asked = ["furnace", "grazing_plane", "--blender=4.5", "--blender=5.2"]
    assert run(*asked, f"--out={tmp_path / 'out'}") == ExitCode.BAD_INPUT
    scenes = json.loads((tmp_path / "out" / "versions.json").read_text(encoding="utf-8"))["scenes"]
    assert [one["error"] for one in scenes] == ["no camera", "it was cancelled before"]
    assert "grazing_plane: Not compared: it was cancelled before" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="the stand-in for a second Blender is a shell script")
def test_one_blender_twice_renders_the_same_bit_for_bit_and_what_it_refuses_is_a_row(pythons, floor, tmp_path, capsys):
    out = tmp_path / "out"
    hair = tmp_path / "hair.blend"
    assert run(floor, hair, *pythons, "--tolerance=0.5", f"--out={out}") == ExitCode.BAD_INPUT
    figures = json.loads((out / "versions.json").read_text(encoding="utf-8"))
    schema = Path(package.__file__).parent / "versions.schema.json"
    Draft202012Validator(json.loads(schema.read_text(encoding="utf-8"))).validate(figures)
    same, refused = figures["scenes"]
    assert same["changes"][0]["is_same"]
    assert same["is_same_scene"]
    assert same["settings"] == {}
    assert (same["rounds"], same["samples"]) == (3, 2)
    assert all((out / one["report"]).is_file() for one in same["versions"])
    assert [one["status"] for one in refused["versions"]] == ["refused", "refused"]
    assert "Hair" in refused["versions"][0]["message"]
    said = capsys.readouterr().out
    assert "Both render the same image, bit for bit." in said
    assert "1 scene could not be compared" in said


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["nowhere.blend", "--blender=4.5", "--blender=5.2"], "nowhere.blend: no such file"),
        (["glossy_sphere", "--blender=4.5", "--blender=5.2"], "did you mean 'glossy_spheres'?"),
        (["furnace", "--blender=5.2"], "name at least two Blenders"),
        (["furnace", "--blender=/nowhere", "--blender=5.2"], "--blender /nowhere: no such program"),
        (["furnace", "furnace", "--blender=4.5", "--blender=5.2"], "furnace: two scenes have this name"),
        (["furnace"], "the following arguments are required: --blender"),
        (["--blender=4.5", "--blender=5.2"], "the following arguments are required: FILE"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_bad_input_is_one_line(words, says, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["versions", *words, "--quiet"]) == ExitCode.BAD_INPUT
    errors = capsys.readouterr().err.strip()
    assert says in errors
    assert len(errors.splitlines()) == 1
