# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line as a user meets it: help, arguments, bad input."""

import json
import signal
import subprocess
import sys

import bpy
import numpy as np
import pytest
from etalon.addon.command import cli
from etalon.addon.command.console import interruptible
from etalon.addon.command.table import COMMANDS
from etalon.lib.scene import archive
from etalon.lib.settings.common import REFERENCE_SCENES
from etalon.lib.settings.units import Seconds, Share


@pytest.fixture
def blend(tmp_path):
    """A small .blend with a glossy cube, saved from a fresh Blender state."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    material = bpy.data.materials["Material"]
    tree = material.node_tree
    gloss = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    gloss.distribution = "GGX"
    tree.links.new(gloss.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 32, 24
    path = tmp_path / "cube.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def run(capfd, *words):
    """Exit code, standard output and the lines on standard error, without progress."""
    capfd.readouterr()
    code = cli.main([str(word) for word in (*words, "--quiet")])
    out, err = capfd.readouterr()
    return code, out, err.splitlines()


HELPED = (
    "",
    "compare",
    "render",
    "scenes",
    "plan",
    "batch",
    "audit",
    "cost",
    "probe",
    "stability",
    "doctor",
    "completion",
)


@pytest.fixture(scope="module")
def helped():
    """What one process said of each command's help: exit code, output, and which slow packages it had imported."""
    script = """
import contextlib, io, json, sys
from etalon.addon.command.cli import main
said = {}
for name in json.loads(sys.argv[1]):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        code = main([*name.split(), "--help"])
    said[name] = [code, out.getvalue(), sorted({"bpy", "scipy", "matplotlib"} & sys.modules.keys())]
print(json.dumps(said))
"""
    done = subprocess.run(
        [sys.executable, "-c", script, json.dumps(HELPED)], capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


@pytest.mark.parametrize("name", HELPED)
def test_help_needs_no_blender(helped, name):
    code, out, slow = helped[name]
    assert (code, slow) == (0, [])
    assert out.startswith(f"usage: etalon {name}".rstrip())


# What few scenes or commands need, and what takes 0.03 to 0.3 s to import.
RARE = {
    "distributed",
    "matplotlib",
    "mpmath",
    "scipy.interpolate",
    "scipy.ndimage",
    "scipy.optimize",
    "scipy.spatial",
    "scipy.stats",
}


@pytest.mark.parametrize("name", ["compare", "render"])
def test_commands_begin_without_what_few_scenes_need(name):
    script = f"import sys; import bpy, etalon.addon.command.{name}, etalon.addon.job; print(sorted({RARE} & sys.modules.keys()))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_python_m_etalon_is_the_command():
    done = subprocess.run([sys.executable, "-m", "etalon", "--version"], capture_output=True, text=True, timeout=60)
    assert done.stdout.startswith("etalon ")


@pytest.mark.parametrize(
    "words",
    [
        ["stare"],
        ["compare", "--tolerance=2"],
        ["compare", "--tolerance=nan"],
        ["compare", "--confidence=0%"],
        ["compare", "--time=0"],
        ["compare", "--samples=1.5"],
        ["compare", "--threads=0"],
        ["compare", "--masking=none"],
        ["render", "furnace"],
        ["scenes", "--save", "furnace"],
        ["batch"],
    ],
)
def test_wrong_arguments_are_one_line_and_code_2(capfd, words):
    code, out, lines = run(capfd, *words)
    assert (code, out, len(lines)) == (2, "", 1), lines
    assert "--help" in lines[0]


def test_etalon_alone_prints_help(capfd):
    assert cli.main([]) == 2
    out, err = capfd.readouterr()
    assert out.startswith("usage: etalon COMMAND")
    assert "etalon compare glossy_spheres" in out
    assert err == ""


@pytest.mark.parametrize("command", ["compare", "plan", "cost", "audit"])
def test_without_a_scene_a_command_says_which_there_are(capfd, command):
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    code, out, lines = run(capfd, command)
    assert (code, out, len(lines)) == (2, "", 1)
    for name in ("FILE.blend", *REFERENCE_SCENES):
        assert name in lines[0]


def test_without_a_scene_the_file_that_is_open_is_taken(capfd, blend):
    assert run(capfd, "plan")[0] == 0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["compare", "cube.blend", "--tolerence=1%"], "unknown option '--tolerence'; did you mean '--tolerance'?"),
        (["compare", "cube.blend", "--tol", "1%"], "unknown option '--tol'; did you mean '--tolerance'?"),
        (["audit", "cube.blend", "-time", "2m"], "unknown option '-time'; did you mean '--time'?"),
        (["compare", "cube"], "did you mean the file 'cube.blend'?"),
        (["compare", "cubes.blend"], "cubes.blend: no such file; did you mean 'cube.blend'?"),
        (["compare", "cube.blend", "more.blend"], "unexpected 'more.blend'"),
        (["rendre", "cube.blend"], "unknown command 'rendre'; did you mean 'render'?"),
    ],
)
def test_what_is_misspelt_suggests_the_nearest(capfd, blend, monkeypatch, words, told):
    monkeypatch.chdir(blend.parent)
    code, out, lines = run(capfd, *words)
    assert (code, out, len(lines)) == (2, "", 1)
    assert told in lines[0]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_times_and_shares_are_read_as_a_person_writes_them(command):
    for kind in command.settings:
        for declared in kind.options():
            if isinstance(declared.unit, Seconds):
                assert declared.check("2m") == declared.check(120) == 120.0
            if isinstance(declared.unit, Share):
                assert declared.check("60%") == 0.6


def test_the_short_help_leaves_out_what_few_people_need(capfd):
    cli.main(["compare", "--help"])
    short = capfd.readouterr().out
    cli.main(["compare", "--help-all"])
    long = capfd.readouterr().out
    assert "--masking" in long
    assert "--masking" not in short
    assert "more options: etalon compare --help-all" in short


def test_percent_and_share_mean_the_same():
    read = cli.parser().parse_args
    assert read(["compare", "--tolerance=0.5%"]).tolerance == pytest.approx(0.005)
    assert read(["compare", "--confidence=0.9"]).confidence == 0.9


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["compare", "glossy_sphere"], "did you mean 'glossy_spheres'?"),
        (["compare", "no_such_thing"], "unknown reference scene 'no_such_thing'"),
        (["compare", "nowhere.blend"], "nowhere.blend: no such file"),
        (["compare", "text.blend"], "text.blend: is not a Blender file"),
        (["compare", "damaged.blend"], "damaged.blend: Blender cannot load it"),
        (["compare", "scene.npz"], "Cycles cannot render a saved scene"),
        (["compare", "cube.blend", "--camera=Cube"], "cameras there: Camera"),
        (["compare", "cube.blend", '--set=objects["Sphere"].location[0]=1'], "no such property"),
        (["compare", "cube.blend", "--out=text.blend"], "is a file, not a folder"),
        (["compare", "cube.blend", "--out=text.blend/below"], "cannot be written"),
        (["render", "cube.blend", "--out=text.blend/x.exr"], "is a file, not a folder"),
        (["render", "nowhere.npz", "--out=x.exr"], "nowhere.npz: cannot be read"),
        (["render", "text.npz", "--out=x.exr"], "no scene of Étalon's"),
        (["scenes", "--save", "no_such_thing", "x.blend"], "no reference scene of that name"),
        (["batch", "nowhere.toml"], "nowhere.toml: cannot be read"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing_behind(capfd, blend, monkeypatch, words, complaint):
    monkeypatch.chdir(blend.parent)
    for name in ("text.blend", "text.npz"):
        (blend.parent / name).write_text("a shopping list")
    (blend.parent / "damaged.blend").write_bytes(blend.read_bytes()[: blend.stat().st_size // 2])
    before = sorted(blend.parent.iterdir())
    code, out, lines = run(capfd, *words)
    assert (code, out, len(lines)) == (2, "", 1), lines
    assert lines[0].startswith("etalon: ")
    assert complaint in lines[0]
    assert sorted(blend.parent.iterdir()) == before


def test_a_scene_without_camera_is_told(capfd, blend, monkeypatch):
    monkeypatch.chdir(blend.parent)
    bpy.data.objects.remove(bpy.data.objects["Camera"])
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    code, _, lines = run(capfd, "compare", "cube.blend")
    assert (code, len(lines)) == (2, 1)
    assert "has no camera" in lines[0]


def test_a_missing_library_is_told(capfd, blend, monkeypatch):
    monkeypatch.chdir(blend.parent)
    library = blend.with_name("library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=str(library), copy=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.meshes = ["Cube"]
    bpy.data.objects["Cube"].data = next(m for m in bpy.data.meshes if m.library)
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    library.unlink()
    code, _, lines = run(capfd, "compare", "cube.blend")
    assert (code, len(lines)) == (2, 1)
    assert "object 'Cube': mesh 'Cube" in lines[0]
    assert f"of the library '{library}', which is not there," in lines[0]


def test_scripts_in_a_file_never_run(capfd, blend, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    trace = tmp_path / "trace"
    text = bpy.data.texts.new("startup.py")
    text.write(f"open({str(trace)!r}, 'w')")
    text.use_module = True
    driver = bpy.data.objects["Cube"].driver_add("location", 0).driver
    driver.expression = f"open({str(trace)!r}, 'w').close() or 0"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    trace.unlink(missing_ok=True)
    assert run(capfd, "plan", "cube.blend")[0] == 0
    assert not trace.exists()


def test_what_a_scene_refuses_is_named(capfd, blend, monkeypatch):
    monkeypatch.chdir(blend.parent)
    tree = bpy.data.materials["Material"].node_tree
    hair = tree.nodes.new("ShaderNodeBsdfHair")
    tree.links.new(hair.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    code, _, lines = run(capfd, "compare", "cube.blend")
    assert code == 2
    assert any("Material" in line and "Hair" in line for line in lines)
    assert not (blend.parent / "etalon-out").exists()


def test_plan_says_what_and_why(capfd, blend, monkeypatch):
    monkeypatch.chdir(blend.parent)
    code, out, lines = run(capfd, "plan", "cube.blend", "--json")
    assert (code, lines) == (0, [])
    assert {d["needed"] for d in json.loads(out)["decisions"]} == {True, False}
    code, out, _ = run(capfd, "plan", "cube.blend")
    assert code == 0
    assert "not needed" in out


def test_render_writes_radiance_error_and_count(capfd, blend, monkeypatch):
    from etalon.lib.film.exr import read_exr

    monkeypatch.chdir(blend.parent)
    code, out, lines = run(capfd, "render", "cube.blend", "--out=x.exr", "--samples=4", "--replicates=3", "--threads=1")
    assert (code, lines) == (0, [])
    assert out.startswith("x.exr: 3 replicates of 4 samples")
    channels = read_exr(blend.parent / "x.exr")
    assert {"R", "G", "B", "error.R", "error.G", "error.B", "samples"} <= channels.keys()
    assert np.all(channels["samples"] == 12)
    assert channels["R"].shape == (24, 32)


def test_a_saved_scene_renders_as_the_file_does(capfd, blend, monkeypatch):
    from etalon.lib.film.exr import read_exr

    monkeypatch.chdir(blend.parent)
    assert run(capfd, "plan", "cube.blend", "--save=cube.npz")[0] == 0
    assert archive.load(blend.parent / "cube.npz").mesh.triangle_count == 12
    for name in ("cube.blend", "cube.npz"):
        words = ["render", name, f"--out={name}.exr", "--samples=1", "--replicates=1", "--threads=1"]
        assert run(capfd, *words)[0] == 0
    np.testing.assert_array_equal(
        read_exr(blend.parent / "cube.blend.exr")["R"], read_exr(blend.parent / "cube.npz.exr")["R"]
    )


def test_compare_ends_with_a_verdict_and_a_folder(capfd, blend, monkeypatch):
    monkeypatch.chdir(blend.parent)
    words = ["--samples=2", "--replicates=2", "--threads=1", "--set=scene.render.resolution_percentage=50"]
    code, out, lines = run(capfd, "compare", "cube.blend", *words)
    folder = blend.parent / "etalon-out" / "cube"
    verdict = json.loads((folder / "verdict.json").read_text())
    assert lines == []
    assert code == verdict["exit_code"]
    assert verdict["size"] == {"width": 16, "height": 12, "divisor": 1}
    assert out.splitlines()[:3] == verdict["summary"]
    assert out.startswith(f"cube.blend: {verdict['verdict']}.")
    assert "\x1b" not in out
    assert "--replicates=2" in verdict["command"]
    names = {f"{name}.{kind}" for name in ("reference", "cycles", "difference") for kind in ("exr", "png")}
    assert {p.name for p in folder.iterdir()} == {"verdict.json", "report.html", *names}


def test_the_first_ctrl_c_is_a_wish_and_the_second_an_order():
    # A shell that starts the tests in the background has Ctrl-C ignored.
    found = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with interruptible() as interrupted:
            assert not interrupted()
            signal.raise_signal(signal.SIGINT)
            assert interrupted()
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, found)


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_an_order_to_end_is_a_wish_however_often_it_comes(name):
    """`timeout` sends it to the process and to its group."""
    if not hasattr(signal, name):
        pytest.skip("Windows has no such signal")
    number = getattr(signal, name)
    found = signal.signal(number, signal.SIG_DFL)  # under nohup, SIGHUP is ignored
    try:
        with interruptible() as interrupted:
            for _ in range(3):
                signal.raise_signal(number)
            assert interrupted()
        assert signal.getsignal(number) is signal.SIG_DFL
    finally:
        signal.signal(number, found)


def test_an_order_to_end_elsewhere_interrupts_once(capfd, monkeypatch):
    cleared = []

    def ordered(arguments):
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            signal.raise_signal(signal.SIGTERM)
            cleared.append(True)

    monkeypatch.setattr(cli, "_run", ordered)
    code, out, lines = run(capfd, "scenes")
    assert (code, out, lines, cleared) == (130, "", ["etalon: interrupted"], [True])


def test_no_name_of_a_scene_leads_out_of_the_folder_for_results(tmp_path):
    from pathlib import Path

    from etalon.addon.command.opening import open_target, results_folder

    path = tmp_path / "...blend"
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    assert results_folder(None, open_target(str(path))) == Path("etalon-out/scene")
    for name in ("/etc", "../../x", ".."):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        bpy.context.scene.name = name
        assert results_folder(None, open_target(None)).parent == Path("etalon-out")
    assert results_folder(Path("chosen"), "x") == Path("chosen")
