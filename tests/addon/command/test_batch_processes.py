# SPDX-License-Identifier: GPL-3.0-or-later
"""A process that runs several comparisons, or is forked, gives what a new process gives, bit for bit."""

import json
import subprocess
import sys
from functools import cache

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


# The command `etalon`, whose batches fork no process.
WITHOUT_FORKS = """
from etalon.addon.command.supervised import main
from etalon.lib.batch import run
run.can_fork = lambda: False
main()
"""


@pytest.fixture(scope="module")
def run_batch(tmp_path_factory):
    """Runs the plan with so many turns, with forks or without; returns the folder and the rows of its table."""
    folder = tmp_path_factory.mktemp("batch")
    subprocess.run([sys.executable, "-c", REFUSED], cwd=folder, check=True, stdout=subprocess.DEVNULL, timeout=120)

    @cache
    def run(turns, has_forks):
        out = f"turns{turns}{has_forks}"
        (folder / "plan.toml").write_text(PLAN.format(out=out, turns=turns))
        program = ["-m", "etalon"] if has_forks else ["-c", WITHOUT_FORKS]
        call = [sys.executable, *program, "batch", "plan.toml", "--jobs=1", "--quiet"]
        done = subprocess.run(call, cwd=folder, capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 2, done.stderr
        return folder / out, json.loads((folder / out / "batch.json").read_text())["comparisons"]

    return run


@pytest.mark.slow
@pytest.mark.parametrize(("turns", "has_forks"), [(20, False), (1, True), (20, True)])
def test_processes_with_many_turns_and_forked_ones_give_what_new_processes_give(run_batch, turns, has_forks):
    there, new = run_batch(1, False)
    here, rows = run_batch(turns, has_forks)
    assert [row["status"] for row in new] == ["finished"] * 4 + ["refused"] * 2
    for one, other in zip(new, rows, strict=True):
        assert {key: value for key, value in one.items() if key != "seconds"} == {
            key: value for key, value in other.items() if key != "seconds"
        }
        if one["status"] == "finished":
            assert_equal_images(there / one["folder"], here / other["folder"])


def assert_equal_images(first, second):
    """Check that the images of two comparisons have the same bits."""
    for name in ("reference.exr", "cycles.exr"):
        one, other = read_exr(first / name), read_exr(second / name)
        assert one.keys() == other.keys()
        for channel, values in one.items():
            assert values.tobytes() == other[channel].tobytes(), (first.name, name, channel)
