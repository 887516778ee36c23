# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon doctor`, and the script that `etalon completion` prints."""

import json
import shutil
import subprocess

import bpy
import pytest
from etalon.addon.command import cli, doctor
from etalon.lib.errors import EtalonError
from etalon.lib.settings.commands import SHELLS


def test_the_doctor_names_blender_and_every_library(capsys):
    assert cli.main(["doctor", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["blender"]["version"] == bpy.app.version_string
    assert set(found["libraries"]) == set(doctor.PACKAGES)
    assert all(found["libraries"].values())
    assert found["processors"] >= 1
    assert found["missing"] == []


def test_the_doctor_says_what_is_missing(capsys, monkeypatch):
    def fail():
        raise EtalonError("Blender cannot start; on Debian or Ubuntu: apt-get install libxi6")

    monkeypatch.setattr(doctor, "load_blender", fail)
    monkeypatch.setattr(doctor, "missing_system_libraries", lambda: ["libXi.so.6"])
    monkeypatch.setattr(doctor, "PACKAGES", {"nothing": "no_such_module_at_all"})
    assert cli.main(["doctor"]) == 2
    shown = capsys.readouterr().out
    assert "apt-get install libxi6 (not found: libXi.so.6)" in shown
    assert "run: pip install nothing" in shown


@pytest.mark.parametrize("shell", SHELLS)
def test_a_completion_script_has_every_command(shell, capsys):
    assert cli.main(["completion", shell]) == 0
    script = capsys.readouterr().out
    for word in ("compare", "audit", "doctor"):
        assert word in script


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("compare --stra", ["--strategy"]),
        ("compare --strategy vis", ["visible"]),
        ("compare glossy", ["glossy_spheres"]),
        ("comp", ["compare", "completion"]),
    ],
)
def test_bash_completes_commands_options_values_and_scenes(words, offered, capsys, tmp_path):
    bash = shutil.which("bash")
    if bash is None:
        pytest.skip("this system has no bash")
    cli.main(["completion", "bash"])
    script = capsys.readouterr().out
    ask = f'COMP_WORDS=(etalon {words}); COMP_CWORD={len(words.split())}; _shtab_etalon; echo "${{COMPREPLY[@]}}"'
    done = subprocess.run([bash, "-c", f"{script}\n{ask}"], capture_output=True, text=True, timeout=60, cwd=tmp_path)
    assert sorted(done.stdout.split()) == offered, done.stderr
