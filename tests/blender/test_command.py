# SPDX-License-Identifier: GPL-3.0-or-later
"""`blender FILE.blend --background --command etalon ...` in the real program."""

import json

import pytest

pytestmark = pytest.mark.blender

FILES = {
    "verdict.json",
    "report.html",
    *(f"{name}.{kind}" for name in ("reference", "cycles", "difference") for kind in ("exr", "png")),
}


@pytest.fixture(scope="module")
def blend(debian, extension):
    """A reference scene saved as a .blend by the command itself."""
    path = debian.home / "lambert.blend"
    done = debian.run("blender", "--background", "--command", "etalon", "scenes", "--save", "lambert_analytic", path)
    assert done.returncode == 0, done.stdout
    return path


def test_compare_the_file_that_is_open(debian, blend):
    out = debian.home / "compared"
    words = ["--set=scene.render.resolution_percentage=50", "--time=15", f"--out={out}"]
    done = debian.run("blender", blend, "--background", "--command", "etalon", "compare", *words)
    folder = debian.outside / "compared"
    assert {p.name for p in folder.iterdir()} == FILES, done.stdout
    verdict = json.loads((folder / "verdict.json").read_text())
    assert done.returncode == {"EQUIVALENT": 0, "UNDECIDED": 3}[verdict["verdict"]], done.stdout
    assert verdict["verdict"] in done.stdout


def test_compare_a_reference_scene_by_name(debian, extension):
    words = [
        "lambert_analytic",
        "--set=scene.render.resolution_percentage=25",
        "--samples=4",
        "--replicates=2",
        "--out=by-name",
    ]
    done = debian.run("blender", "--background", "--command", "etalon", "compare", *words)
    assert done.returncode == 3, done.stdout
    assert {p.name for p in (debian.outside / "by-name").iterdir()} == FILES


def test_audit_the_file_that_is_open(debian, blend):
    words = ["--set=scene.render.resolution_percentage=25", "--samples=1", "--replicates=2", "--out=audited"]
    done = debian.run("blender", blend, "--background", "--command", "etalon", "audit", *words)
    assert done.returncode == 0, done.stdout
    figures = json.loads((debian.outside / "audited" / "audit.json").read_text())
    assert figures["rounds"] == 2
    assert "Pixel Filter" in done.stdout
    # Debian's Blender has no Open Image Denoise, which is said instead of measuring nothing.
    assert {entry["key"] for entry in figures["missing"]} == {"adaptive", "denoiser"}


@pytest.mark.parametrize("arguments", [["compare", "nowhere.blend"], ["compare", "--tolerance=x"], ["stare"]])
def test_bad_input_ends_with_code_2_and_one_line(debian, extension, arguments):
    done = debian.run("blender", "--background", "--command", "etalon", *arguments)
    assert done.returncode == 2, done.stdout
    assert sum(line.startswith("etalon") for line in done.stdout.splitlines()) == 1
    assert "Traceback" not in done.stdout
