# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's job: a second program on a copy of the file.

Here it is Blender as a module behind a script that takes its arguments.
"""

import math
import sys

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon import job
from etalon.addon.cycles import second_blender
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.cycles.second_blender import SecondBlender
from etalon.addon.cycles.view_transform_elsewhere import elsewhere
from etalon.addon.export.view_transform import export_view_transform
from etalon.addon.host.quiet import quiet
from etalon.lib.comparison.departures import Alternatives
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.view_transform import ViewTransform
from etalon.lib.film.windows import Windows
from etalon.lib.settings.comparison import Settings
from etalon.lib.verdict.outcome import Outcome
from etalon.reference_scenes import building
from etalon.tests.planted import plant_bright_rough_diffuse

PROGRAM = """#!{python}
import runpy, sys
import bpy
{plant}
script = sys.argv.index("--python") + 1
if script == 6:
    bpy.ops.wm.open_mainfile(filepath=sys.argv[4], use_scripts=False)
runpy.run_path(sys.argv[script], run_name="__main__")
"""


PLANT = "from etalon.tests.planted import plant_bright_rough_diffuse as plant; plant()"


def write_program(path, plant=""):
    """Write the program at `path`.

    It has an error planted in its reference where there is one to plant.
    """
    path.write_text(PROGRAM.format(python=sys.executable, plant=plant))
    path.chmod(0o755)


@pytest.fixture
def program(tmp_path, monkeypatch):
    path = tmp_path / "blender"
    write_program(path)
    for module in (second_blender, job):
        monkeypatch.setattr(module, "find_blender", lambda: str(path))
    return path


def floor():
    """A rough diffuse floor under a sun."""
    scene = building.start("floor", 36, 20, 0)
    rough = building.diffuse("rough", (1.0, 1.0, 1.0))  # white: no release departs
    rough.node_tree.nodes["Diffuse BSDF"].inputs["Roughness"].default_value = 1.0
    building.rectangle("floor", rough, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle = math.pi, 0.0
    sun.rotation_euler = (0.0, 1.0, 0.0)
    scene.collection.objects.link(sun)
    building.camera((0.013, 0.007, 5.0), (0.013, 0.007, 0.0), ortho_scale=3.0)
    return scene


@pytest.mark.compares_with_cycles
def test_it_renders_what_cycles_renders_here_whole_or_in_parts(program, tmp_path):
    scene = floor()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "copy.blend"), copy=True)
    second = SecondBlender(tmp_path / "copy.blend", scene.name, Settings(seed=3, threads=1))
    try:
        assert second.export().name == "floor"
        here = CyclesRenderer(scene, seed=3, threads=1)
        for windows in (None, Windows((20, 36), ((2, 3, 9, 11), (20, 0, 35, 19)))):
            there = second.render(5, 2, windows=windows)
            np.testing.assert_array_equal(there.radiance, here.render(5, 2, windows=windows).radiance)
            assert there.windows == windows
        asked = (LightPass.DIFFUSE_DIRECT, LightPass.ENVIRONMENT)
        there = second.with_passes(asked).render(5, 2).passes
        assert tuple(there) == asked
        for name, light in here.with_passes(asked).render(5, 2).passes.items():
            np.testing.assert_array_equal(there[name], light)
    finally:
        second.close()


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_what_nothing_explains_is_left_as_a_file(program, tmp_path, monkeypatch):
    """The reference of both processes shows the rough floor too bright.

    There is no reason for it in the catalogue.
    """
    monkeypatch.setattr(job, "alternatives", lambda reference: Alternatives((), lambda names: reference))
    plant_bright_rough_diffuse(monkeypatch.setattr)
    write_program(program, PLANT)
    scene = floor()
    settings = Settings(tolerance=0.01, time=60, samples=8, replicates=8, threads=1)
    with quiet():
        running = job.BackgroundJob(scene, settings, tmp_path / "out")
        running.wait()
    assert running.errors == ()
    assert running.comparison.verdict.outcome is Outcome.DIFFERENT
    with bpy.data.libraries.load(str(tmp_path / "out" / job.MINIMAL)) as (found, _):
        assert found.scenes == ["floor unexplained"]


@pytest.mark.slow
def test_materials_that_are_not_simulated_come_over_as_unknown(program, tmp_path):
    scene = floor()
    tree = bpy.data.materials["rough"].node_tree
    out = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(tree.nodes.new("ShaderNodeBsdfHair").outputs[0], out.inputs["Surface"])
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "copy.blend"), copy=True)
    second = SecondBlender(tmp_path / "copy.blend", scene.name, Settings(seed=3, threads=1, partial=True))
    try:
        assert "Hair" in second.export().materials[0].unknown
    finally:
        second.close()


def test_it_ends_amid_a_render_when_this_process_is_gone(program, tmp_path):
    scene = floor()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "copy.blend"), copy=True)
    second = SecondBlender(tmp_path / "copy.blend", scene.name, Settings(seed=3, threads=1))
    try:
        second.export()
        wanted = {"replicate": 0, "samples": 1 << 24, "windows": None, "size": None, "one_light": False, "passes": []}
        second._send(wanted)
        second._process.stdin.close()  # as the system does for a process that ends, however that happens
        assert second._process.wait(timeout=60) == 0
    finally:
        second.close()


@pytest.fixture
def job_without_work(program, tmp_path, monkeypatch):
    """A job of the panel that has ended before it began."""
    monkeypatch.setattr(job.BackgroundJob, "_run", lambda self: self._temporary.close())
    monkeypatch.setattr(job, "SecondBlender", lambda *_: None)
    with quiet():
        return job.BackgroundJob(floor(), Settings(), tmp_path / "out")


def test_the_view_transform_of_the_job_is_applied_outside_of_this_process(job_without_work, rng, monkeypatch):
    radiance = rng.random((4, 5, 3))
    radiance[1, 2] = np.nan
    expected = export_view_transform(bpy.context.scene).apply(radiance)

    def hold_the_lock(*_):
        raise AssertionError("OpenImageIO read a colour configuration in the window's process")

    monkeypatch.setattr(OpenImageIO.ImageBufAlgo, "ociodisplay", hold_the_lock)
    monkeypatch.setattr(OpenImageIO.ImageBufAlgo, "ociolook", hold_the_lock)
    np.testing.assert_array_equal(job_without_work._transform.apply(radiance), expected)


def test_a_view_transform_that_fails_outside_says_why(program, tmp_path):
    transform = elsewhere(ViewTransform(tmp_path / "nowhere.ocio", "AgX"), str(program))
    with pytest.raises(EtalonError, match=r"view transform 'AgX' cannot be applied \(.*nowhere.ocio"):
        transform.apply(np.zeros((1, 1, 3)))
    program.write_text("#!/bin/sh\n")
    with pytest.raises(EtalonError, match=r"view transform 'AgX' cannot be applied \(its process ended early\)"):
        transform.apply(np.zeros((1, 1, 3)))


def test_python_with_blender_as_a_module_has_no_second_blender(tmp_path):
    with pytest.raises(EtalonError, match="run the panel's comparison in Blender itself"):
        SecondBlender(tmp_path / "copy.blend", "Scene", Settings())
