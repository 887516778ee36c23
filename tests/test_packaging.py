# SPDX-License-Identifier: GPL-3.0-or-later
"""One tree, two packages: what pip and Blender are told fits the tree, and each other."""

import contextlib
import hashlib
import importlib.util
import re
import subprocess
import tomllib
import zipfile
from pathlib import Path

import etalon
import pytest
from etalon.lib.blender_versions import NEWEST_CHECKED, OLDEST
from etalon.lib.version import VERSION

ROOT = Path(__file__).resolve().parents[1]
PACKAGED = ("addon", "lib", "reference_scenes")


def manifest():
    """The extension's manifest."""
    return tomllib.loads((ROOT / "blender_manifest.toml").read_text())


def project():
    """pip's view."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text())


def test_every_package_is_listed_for_pip():
    folders = {path.parent for top in PACKAGED for path in (ROOT / top).rglob("*.py")}
    expected = {"etalon"} | {"etalon." + ".".join(folder.relative_to(ROOT).parts) for folder in folders}
    assert set(project()["tool"]["setuptools"]["packages"]) == expected
    assert all((folder / "__init__.py").exists() for folder in folders)


def test_every_data_file_is_packed_by_pip():
    data = project()["tool"]["setuptools"]["package-data"]
    packed = {
        path
        for package, patterns in data.items()
        for pattern in patterns
        for path in (ROOT / Path(*package.split(".")[1:])).glob(pattern)
    }
    present = {
        path
        for top in PACKAGED
        for path in (ROOT / top).rglob("*")
        if path.is_file() and path.suffix not in {".py", ".pyc"}
    }
    assert packed == present | {ROOT / "py.typed"}


def test_the_manifest_says_what_the_package_says():
    assert manifest()["version"] == etalon.__version__
    assert manifest()["license"] == ["SPDX:" + project()["project"]["license"]]
    assert "wheels" not in manifest(), "wheels are fetched by build_extension.py, never committed"


def test_importing_the_root_imports_no_blender():
    import subprocess
    import sys

    code = "import sys, etalon; sys.exit('bpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 0


def test_pip_installs_no_newer_blender_than_the_newest_checked():
    major, minor = NEWEST_CHECKED
    (newest,) = (d for d in project()["project"]["dependencies"] if d.startswith("bpy") and ">= '3.13'" in d)
    assert f"<{major}.{minor + 1};" in newest


def test_the_extension_asks_for_the_oldest_release():
    assert manifest()["blender_version_min"] == "{}.{}.0".format(*OLDEST)


@pytest.fixture
def build():
    """The script that builds the extension."""
    spec = importlib.util.spec_from_file_location("build_extension", ROOT / "build_extension.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_wheel_of_the_extension_has_a_version_and_a_hash(build):
    pinned = {path.name for path in build.PINNED.iterdir()}
    assert pinned == {build.pins(platform, python).name for platform in build.PLATFORMS for python in build.NUMPY}
    asked = {re.split("[<>=~ ;]", requirement)[0].lower() for requirement in build.requirements()}
    for path in build.PINNED.iterdir():
        lines = path.read_text().splitlines()
        found = {line.partition("==")[0].lower() for line in lines}
        assert asked <= found, path.name
        assert not found & set(build.NOT_BUNDLED)
        assert all(re.fullmatch(r"[\w.-]+==[\w.]+ --hash=sha256:[0-9a-f]{64}", line) for line in lines), path.name


@pytest.mark.slow
def test_pip_refuses_a_wheel_with_another_hash(build, tmp_path):
    wheel = tmp_path / "changed-1.0-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as file:
        file.writestr("changed-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: changed\nVersion: 1.0\n")
        file.writestr("changed-1.0.dist-info/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        file.writestr("changed-1.0.dist-info/RECORD", "")
    good = hashlib.sha256(wheel.read_bytes()).hexdigest()
    listed = tmp_path / "pins.txt"
    build.pins = lambda platform, python: listed
    for digest, right in ((good, True), ("0" * 64, False)):
        listed.write_text(f"--no-index\n--find-links {tmp_path}\nchanged==1.0 --hash=sha256:{digest}\n")
        got = tmp_path / f"got-{right}"
        with contextlib.nullcontext() if right else pytest.raises(subprocess.CalledProcessError):
            build.gather("linux-x64", "3.13", got)
        assert len(list(got.glob("*.whl"))) == right


def test_the_extension_has_every_file_of_the_root_package(build):
    # What only pip or a developer runs stays out.
    shipped = {path.name for path in ROOT.glob("*.py")} - {"__main__.py", "build_extension.py"} | {"py.typed"}
    assert shipped <= set(build.FILES)
    patterns = manifest()["build"]["paths_exclude_pattern"]
    assert {f"!/{name}" for name in shipped} <= set(patterns)


def test_the_version_is_read_from_one_place():
    assert project()["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "etalon.lib.version.VERSION"}
    assert etalon.__version__ == VERSION
