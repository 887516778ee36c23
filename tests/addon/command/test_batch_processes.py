# SPDX-License-Identifier: GPL-3.0-or-later
"""A process that runs several comparisons gives what a new process gives, bit for bit."""

import json
import subprocess
import sys

import pytest
from etalon.lib.film.exr import read_exr

# Scenes and maskings follow one another in one process: nothing of one may stay for the next. The last scene is refused.
PLAN = """
out = "{out}"
per_process = {turns}
scenes = ["lambert_analytic", "cornell_glossy", "nothing.blend"]
[options]
samples = 4
replicates = 2
threads = 1
set = ["scene.render.resolution_x=16", "scene.render.resolution_y=16", "scene.render.resolution_percentage=100"]
masking = ["correlated", "separable"]
"""
# Saves a scene with a node that is refused.
REFUSED = """
import bpy
bpy.ops.wm.read_factory_settings(use_empty=False)
material = bpy.data.objects["Cube"].active_material
nodes = material.node_tree.nodes
velvet = nodes.new("ShaderNodeBsdfHair")
material.node_tree.links.new(velvet.outputs[0], nodes["Material Output"].inputs["Surface"])
bpy.ops.wm.save_as_mainfile(filepath="nothing.blend")
"""


@pytest.mark.slow
def test_a_process_with_many_turns_gives_what_new_processes_give(tmp_path):
    subprocess.run([sys.executable, "-c", REFUSED], cwd=tmp_path, check=True, stdout=subprocess.DEVNULL, timeout=120)
    for out, turns in (("new", 1), ("many", 20)):
        (tmp_path / "plan.toml").write_text(PLAN.format(out=out, turns=turns))
        call = [sys.executable, "-m", "etalon", "batch", "plan.toml", "--jobs=1", "--quiet"]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 2, done.stderr
    new, many = (json.loads((tmp_path / out / "batch.json").read_text())["comparisons"] for out in ("new", "many"))
    assert [row["status"] for row in new] == ["finished"] * 4 + ["refused"] * 2
    for one, other in zip(new, many, strict=True):
        assert {key: value for key, value in one.items() if key != "seconds"} == {
            key: value for key, value in other.items() if key != "seconds"
        }
        if one["status"] == "finished":
            assert_equal_images(tmp_path / "new" / one["folder"], tmp_path / "many" / other["folder"])


def assert_equal_images(first, second):
    """Check that the images of two comparisons have the same bits."""
    for name in ("reference.exr", "cycles.exr"):
        one, other = read_exr(first / name), read_exr(second / name)
        assert one.keys() == other.keys()
        for channel, values in one.items():
            assert values.tobytes() == other[channel].tobytes(), (first.name, name, channel)
