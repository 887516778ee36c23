# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the Blender extension.

Run `python build_extension.py [--platform linux-x64] [--python 3.13]`. The tree is copied to `build/extension`, the
wheels that Blender lacks are fetched beside it by pip, their list is written into the copy's manifest, and Blender's
own packager (of the `bpy` wheel, or of the `blender` on the path) validates the copy and writes one archive per
platform to `dist`, and beside them `index.json`: a static repository, whose address is all that an artist needs. NumPy
and OpenImageIO ship inside Blender and are never bundled.

Each wheel has its version and its SHA-256 in `pinned_wheels/`, and pip takes no other. `--update` writes these files
anew: the newest versions that pyproject.toml and Blender's NumPy allow.
"""

from __future__ import annotations

import argparse
import importlib.util
import itertools
import json
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent
STAGE = ROOT / "build" / "extension"
PINNED = ROOT / "pinned_wheels"
PACKAGED = ("addon", "lib", "reference_scenes")
FILES = ("__init__.py", "api.py", "public_name.py", "py.typed", "LICENSE", "blender_manifest.toml")

# Brought by Blender (4.2's and Debian 13's NumPy are the oldest with that Python): wheels must fit it, not replace it.
NUMPY = {"3.11": "1.24.3", "3.13": "2.2.4"}
# shtab serves shells, which the inside of Blender has none of.
NOT_BUNDLED = ("numpy", "openimageio", "bpy", "shtab")

# pip's names of each of Blender's platforms: the oldest system that Blender and embreex run on, and those before it.
PLATFORMS = {
    "linux-x64": ("manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux_2_17_x86_64", "manylinux2014_x86_64"),
    "macos-arm64": ("macosx_13_0_arm64",),
    "macos-x64": ("macosx_13_0_x86_64",),
    "windows-x64": ("win_amd64",),
}


def requirements() -> list[str]:
    """What pyproject.toml asks for, less what Blender brings."""
    dependencies = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    return [d for d in dependencies if not d.lower().startswith(NOT_BUNDLED)]


def pins(platform: str, python: str) -> Path:
    """The file with version and hash of every wheel, as pip reads it.

    There is one for each platform and Python version.
    """
    return PINNED / f"{platform}-{python}.txt"


def pip(platform: str, python: str, *words: str) -> str:
    """Run a command of pip for another platform, wheels only; returns what it prints."""
    tags = [argument for tag in PLATFORMS[platform] for argument in ("--platform", tag)]
    command = [sys.executable, "-m", "pip", *words, "--quiet", "--only-binary=:all:", "--python-version", python, *tags]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def update(platform: str, python: str) -> None:
    """Write `pins` anew, from what the package index says of each wheel."""
    asked = ["--dry-run", "--ignore-installed", "--target", str(STAGE), "--report", "-"]
    report = json.loads(pip(platform, python, "install", *asked, *requirements(), f"numpy=={NUMPY[python]}"))
    lines = [
        f"{wheel['metadata']['name']}=={wheel['metadata']['version']} "
        f"--hash=sha256:{wheel['download_info']['archive_info']['hashes']['sha256']}\n"
        for wheel in report["install"]
        if wheel["metadata"]["name"].lower() not in NOT_BUNDLED
    ]
    PINNED.mkdir(exist_ok=True)
    pins(platform, python).write_text("".join(sorted(lines, key=str.lower)), encoding="utf-8")


def gather(platform: str, python: str, folder: Path) -> None:
    """Fetch the wheels of one platform and Python version into `folder`.

    pip ends with an error where a hash differs.
    """
    pip(
        platform,
        python,
        "download",
        "--no-deps",
        "--require-hashes",
        "--dest",
        str(folder),
        "-r",
        str(pins(platform, python)),
    )


def stage(platforms: list[str], pythons: list[str]) -> None:
    """Make the build copy: tree, wheels, and a manifest that lists them."""
    shutil.rmtree(STAGE, ignore_errors=True)
    STAGE.mkdir(parents=True)
    for name in PACKAGED:
        shutil.copytree(ROOT / name, STAGE / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in FILES:
        shutil.copy2(ROOT / name, STAGE / name)
    for platform in platforms:
        for python in pythons:
            print(f"wheels for {platform}, Python {python}", flush=True)
            gather(platform, python, STAGE / "wheels")
    wheels = sorted(f"./wheels/{wheel.name}" for wheel in (STAGE / "wheels").iterdir())
    listing = "".join(f'  "{wheel}",\n' for wheel in wheels)
    manifest = (STAGE / "blender_manifest.toml").read_text()
    declared = next(line for line in manifest.splitlines() if line.startswith("platforms = "))
    built = "platforms = [{}]".format(", ".join(f'"{platform}"' for platform in platforms))
    manifest = manifest.replace(declared, f"{built}\nwheels = [\n{listing}]")
    (STAGE / "blender_manifest.toml").write_text(manifest)


def packager() -> list[str]:
    """The command of Blender's own extension tool.

    It is a script that comes with bpy and needs no Blender to run, or Blender itself.
    """
    spec = importlib.util.find_spec("bpy")
    if spec is not None and spec.origin is not None:
        script = next(Path(spec.origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
        return [sys.executable, str(script)]
    blender = shutil.which("blender")
    if blender is None:
        raise SystemExit("Blender's extension packager was not found: put `blender` on the path, or pip install bpy")
    return [blender, "--factory-startup", "--command", "extension"]


def main() -> None:
    """Stage, validate, build."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--platform", action="append", choices=PLATFORMS, help="Blender's name of a platform; all four")
    parser.add_argument("--python", action="append", choices=NUMPY, help="a Python that Blender brings; both")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder for the archives (dist)")
    parser.add_argument(
        "--update", action="store_true", help="write version and hash of every wheel anew, and build nothing"
    )
    arguments = parser.parse_args()
    platforms, pythons = arguments.platform or list(PLATFORMS), arguments.python or list(NUMPY)
    if arguments.update:
        for platform, python in itertools.product(platforms, pythons):
            print(f"versions and hashes for {platform}, Python {python}", flush=True)
            update(platform, python)
        return
    stage(platforms, pythons)
    arguments.out.mkdir(parents=True, exist_ok=True)
    tool, out = packager(), str(arguments.out.resolve())
    subprocess.run([*tool, "validate", str(STAGE)], check=True)
    build = ["build", "--split-platforms", "--source-dir", str(STAGE), "--output-dir", out]
    subprocess.run([*tool, *build], check=True)
    subprocess.run([*tool, "server-generate", "--repo-dir", out], check=True)


if __name__ == "__main__":
    main()
