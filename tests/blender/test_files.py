# SPDX-License-Identifier: GPL-3.0-or-later
"""Files as users have them, in the real program.

They are Blender's own templates, and one that holds much at once.
"""

import json
import shutil
from pathlib import Path

import pytest

pytestmark = pytest.mark.blender

TEMPLATES = "usr/share/blender/scripts/startup/bl_app_templates_system"


def test_templates_end_in_a_plan_or_in_a_message(debian, extension):
    paths = sorted((debian.root / TEMPLATES).glob("*/startup.blend"))
    assert len(paths) >= 4
    for path in paths:
        inside = Path("/", path.relative_to(debian.root))
        done = debian.run("blender", inside, "--background", "--command", "etalon", "plan")
        assert done.returncode in (0, 2), done.stdout
        assert "Traceback" not in done.stdout
        assert "needed" in done.stdout or "etalon: " in done.stdout


def test_a_crowded_file_agrees(debian, extension):
    shutil.copy(Path(__file__).with_name("crowd.py"), debian.outside / "crowd.py")
    blend = debian.home / "crowd.blend"
    made = debian.run("blender", "--background", "--python-exit-code", "1", "--python", "crowd.py", "--", blend)
    assert made.returncode == 0, made.stdout
    words = ["--time=15", "--tolerance=3%", "--out=crowd"]
    done = debian.run("blender", blend, "--background", "--command", "etalon", "compare", *words)
    figures = json.loads((debian.outside / "crowd" / "verdict.json").read_text())
    assert figures["verdict"] in ("EQUIVALENT", "UNDECIDED", "EXPLAINED"), done.stdout
    assert "Plane" in {region["name"] for region in figures["regions"]}
    assert abs(figures["image"]["difference"]) < 0.01
