# SPDX-License-Identifier: GPL-3.0-or-later
"""A script in the real program imports Étalon by the name that it has outside."""

import pytest

pytestmark = pytest.mark.blender

SCRIPT = """
import etalon
import bpy

target = etalon.Target("lambert_analytic", assignments=("scene.render.resolution_percentage=25",))
found = etalon.compare(target, etalon.Settings(samples=4, replicates=2, out="scripted"))
assert found.verdict.outcome in etalon.Outcome
assert bpy.context.scene.name == "lambert_analytic"
film = etalon.render(None, etalon.RenderOptions(samples=1, replicates=2))
print("SHAPE", film.shape, etalon.__name__, etalon.__version__)
"""


def test_the_script_of_the_readme_runs_in_blender(debian, extension):
    (debian.outside / "script.py").write_text(SCRIPT)
    done = debian.run("blender", "--background", "--python-exit-code", "1", "--python", "script.py")
    assert done.returncode == 0, done.stdout
    assert "SHAPE" in done.stdout
    assert (debian.outside / "scripted" / "verdict.json").is_file()
