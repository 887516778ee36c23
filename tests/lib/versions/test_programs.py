# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding the Blenders that --blender names.

Scripts stand in for Blender, Python, pip and uv.
"""

import sys
from pathlib import Path

import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.versions import environments, programs
from etalon.lib.versions.environments import install_packages, python_of_release, requirements
from etalon.lib.versions.programs import find_blenders

MODULES = {"scipy": "scipy"}
# Stands in for Blender: its version, and what its script would answer.
PROGRAM = """#!{python}
import json, sys
if "--version" in sys.argv:
    print("{kind} {version}")
    sys.exit(0)
request = json.loads(sys.argv[-1])
missing = [] if "packages" in request or not {lacks} else request["probe"]
version = [int(n) for n in "{version}".split(".")]
answer = {{"version": version, "shown": "{version} LTS", "build": "abc", "python": "3.11", "missing": missing}}
print("etalon: " + json.dumps(answer) if {answers} else "Segmentation fault")
"""


def program(path, version="5.2.1", kind="Blender", lacks=False, answers=True):
    path.write_text(PROGRAM.format(python=sys.executable, version=version, kind=kind, lacks=lacks, answers=answers))
    path.chmod(0o755)
    return str(path)


@pytest.fixture(autouse=True)
def nothing_installed(monkeypatch, tmp_path):
    """No Blender on this machine and no Blender in this Python.

    The cache folder is the test's own.
    """
    monkeypatch.setattr(programs, "_installed", list)
    monkeypatch.setattr(programs, "_has_module", lambda release: False)
    monkeypatch.setattr(environments, "cache_folder", lambda: tmp_path / "cache")


def find(*asked):
    return find_blenders(asked, Path("worker.py"), MODULES, [].append)


def test_programs_and_pythons_are_told_apart_and_started_each_in_its_way(tmp_path):
    blender, python = find(program(tmp_path / "blender"), program(tmp_path / "python", "5.3.0", "Python"))
    assert (blender.label, blender.release, python.label) == ("5.2.1", (5, 2), "5.3.0")
    assert blender.command[1:] == (
        "--background",
        "--factory-startup",
        "--disable-autoexec",
        "--python",
        "worker.py",
        "--",
    )
    assert python.command[1:] == ("worker.py", "--")


def test_two_of_one_version_are_told_apart_by_their_paths(tmp_path):
    paths = [program(tmp_path / "one"), program(tmp_path / "two")]
    assert [one.label for one in find(*paths)] == [f"5.2.1 ({path})" for path in paths]


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda folder: str(folder / "nowhere"), "no such program; give a path, or a release such as 5.2"),
        (lambda folder: str(folder), "no such program; give a path"),
        (
            lambda folder: program(folder / "old", "4.1.0"),
            "is Blender 4.1.0 LTS, which is too old; Étalon needs 4.2 or newer",
        ),
        (
            lambda folder: program(folder / "bad", answers=False),
            r"does not start \(Segmentation fault\); run it by hand",
        ),
        (lambda folder: program(folder / "vim", kind="VIM"), "is neither Blender nor a Python with the module bpy"),
        (lambda folder: "4.1", "is too old; Étalon needs Blender 4.2 or newer"),
    ],
    ids=["missing", "folder", "too old", "crashes", "another program", "an old release"],
)
def test_a_blender_that_cannot_serve_is_one_line(tmp_path, make, says):
    good = program(tmp_path / "good")
    with pytest.raises(EtalonError, match=says) as caught:
        find(make(tmp_path), good)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith("--blender ")


def test_a_file_that_is_not_executable_is_one_line(tmp_path):
    path = tmp_path / "blender"
    path.write_text("")
    with pytest.raises(EtalonError, match="is not a program that can be run"):
        find(str(path), str(path))


def test_one_blender_twice_is_refused(tmp_path):
    path = program(tmp_path / "blender")
    with pytest.raises(EtalonError, match="twice; remove one"):
        find(path, path)


def test_packages_that_a_blender_lacks_are_installed_and_passed_on(tmp_path, monkeypatch):
    monkeypatch.setattr(programs, "install_packages", lambda asked, python, tell: f"/packages-{python}")
    lacking, other = find(program(tmp_path / "lacking", lacks=True), program(tmp_path / "other", "5.3.0"))
    assert (lacking.packages, other.packages) == ("/packages-3.11", None)


@pytest.fixture
def commands(monkeypatch, tmp_path):
    """The commands that would install something; the last one fails if the test says so."""
    ran = []

    def run(command, what):
        ran.append(list(command))
        if command[-1] == "fail":
            raise EtalonError("fail")

    monkeypatch.setattr(environments, "_run", run)
    monkeypatch.setattr(environments.shutil, "which", lambda name: "/usr/bin/uv" if name == "uv" else None)
    return ran


@pytest.mark.parametrize(
    ("release", "python", "wanted"),
    [("4.5", "3.11", "bpy==4.5.*"), ("5.0.1", "3.11", "bpy==5.0.1"), ("5.3", "3.13", "bpy==5.3.*")],
)
def test_an_environment_gets_its_own_python_and_is_made_once(commands, tmp_path, release, python, wanted):
    found = python_of_release(release, [].append)
    assert Path(found).is_relative_to(tmp_path / "cache" / f"blender-{release}")
    made, installed = commands
    assert made[:4] == ["/usr/bin/uv", "venv", "--python", python]
    assert wanted in installed
    assert not any(one.startswith("bpy") for one in requirements())
    assert python_of_release(release, [].append) == found
    assert len(commands) == 2


def test_an_environment_whose_installation_failed_is_made_again(commands, tmp_path, monkeypatch):
    folder = tmp_path / "cache" / "packages-3.11"

    def fail(command, what):
        folder.mkdir(parents=True)
        raise EtalonError("no network")

    with monkeypatch.context() as broken:
        broken.setattr(environments, "_run", fail)
        with pytest.raises(EtalonError, match="no network"):
            install_packages("blender", "3.11", [].append)
    assert not folder.exists()

    def make(command, what):
        folder.mkdir(parents=True)
        commands.append(command)

    monkeypatch.setattr(environments, "_run", make)
    for _ in range(2):
        assert install_packages("blender", "3.11", [].append) == str(folder)
    assert len(commands) == 1


def test_a_release_without_its_python_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setattr(environments.shutil, "which", lambda name: None)
    monkeypatch.setattr(environments, "_find_python", lambda version: None)
    with pytest.raises(
        EtalonError, match=r"--blender 4.5: needs Python 3.11, which is not installed; install it or uv"
    ):
        python_of_release("4.5", [].append)
