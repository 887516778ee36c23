# SPDX-License-Identifier: GPL-3.0-or-later
"""The small scene of a difference that nothing explains.

It has one object and one light of many and is still different; the user's own scene is untouched.
"""

import math

import bpy
import numpy as np
import pytest
from etalon.addon import job
from etalon.addon.export import minimal
from etalon.addon.host.quiet import quiet
from etalon.lib.comparison.departures import Alternatives
from etalon.lib.report.words import unexplained
from etalon.lib.settings.comparison import Settings
from etalon.lib.verdict.outcome import Outcome
from etalon.reference_scenes import building
from etalon.tests.planted import plant_bright_rough_diffuse

CORNERS = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
FACE = np.array([[0, 1, 2, 3]])


@pytest.fixture
def two_floors(monkeypatch):
    """A plain floor and a rough one, two suns, and an odd size of image.

    The reference shows the rough floor too bright for no reason in the catalogue.
    """
    plant_bright_rough_diffuse(monkeypatch.setattr)
    building.start("floors", 36, 20, 0)
    rough = building.diffuse("rough", (1.0, 1.0, 1.0))  # white: no release departs
    rough.node_tree.nodes["Diffuse BSDF"].inputs["Roughness"].default_value = 1.0
    building.mesh("plain", CORNERS, FACE, [building.diffuse("plain", (0.5, 0.5, 0.5))], (-1.0, 0.0, 0.0))
    building.mesh("rough", CORNERS, FACE, [rough], (1.0, 0.0, 0.0))
    for name, angle in (("low", 1.0), ("high", 0.2)):
        sun = bpy.data.objects.new(name, bpy.data.lights.new(name, "SUN"))
        sun.data.energy, sun.data.angle = math.pi, 0.0
        sun.rotation_euler = (0.0, angle, 0.0)
        bpy.context.scene.collection.objects.link(sun)
    building.camera((0.013, 0.007, 5.0), (0.013, 0.007, 0.0), ortho_scale=3.0)
    monkeypatch.setattr(job, "alternatives", lambda reference: Alternatives((), lambda names: reference))
    return bpy.context.scene


def state(scene):
    """What of the user's scene a smaller one might have changed."""
    return sorted(scene.objects.keys()), scene.render.use_border, scene.world, len(bpy.data.scenes)


@pytest.mark.compares_with_cycles
def test_one_object_and_one_light_are_left(two_floors, tmp_path):
    before = state(two_floors)
    settings = Settings(tolerance=0.01, time=None, samples=8, replicates=8, threads=2)
    with quiet():
        comparison = job.compare_here(two_floors, settings, tmp_path)
    assert comparison.verdict.outcome is Outcome.DIFFERENT
    assert state(two_floors) == before
    box = minimal.where(comparison)

    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / job.MINIMAL))
    left = bpy.context.scene
    assert sorted(item.type for item in left.objects) == ["CAMERA", "LIGHT", "MESH"]
    assert "rough" in left.objects
    with quiet():
        again = job.compare_here(left, settings, tmp_path / "again")
    assert again.regions.shape == (box[3] - box[1] + 1, box[2] - box[0] + 1)
    assert unexplained(again)


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_there_is_none_where_all_agrees(two_floors, tmp_path):
    (tmp_path / job.MINIMAL).write_bytes(b"of another comparison")
    bpy.data.materials["rough"].node_tree.nodes["Diffuse BSDF"].inputs["Roughness"].default_value = 0.0
    settings = Settings(tolerance=0.01, time=None, samples=256, replicates=8, threads=2)
    with quiet():
        comparison = job.compare_here(two_floors, settings, tmp_path)
    assert comparison.verdict.outcome is Outcome.EQUIVALENT
    assert not (tmp_path / job.MINIMAL).exists()
