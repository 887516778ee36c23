# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that `etalon microsurface --mesh` writes, read by Blender and rendered.

It reflects what the traced field reflects.
"""

import math

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.job import export
from etalon.lib.microsurface.measure import write_field
from etalon.lib.microsurface.traced import TracedField
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.reference_scenes import building

ALPHA, CORRELATION, CELLS, DEGREES, SEED = 0.6, 4, 128, 60.0, 5


@pytest.fixture(scope="module")
def mirrors(tmp_path_factory):
    """The field as a white mirror under a white sky.

    A camera that frames one period sees it along one direction.
    """
    path = tmp_path_factory.mktemp("mesh") / "field.ply"
    write_field(path, ALPHA, CORRELATION, SEED, CELLS)
    scene = building.start("field", 64, 32, 0)
    building.world((1.0, 1.0, 1.0))
    bpy.ops.wm.ply_import(filepath=str(path))
    (field,) = [item for item in scene.objects if item.type == "MESH"]
    field.data.materials.clear()
    field.data.materials.append(building.glossy("Mirror", "GGX", 0.0, (1.0, 1.0, 1.0)))
    angle = math.radians(DEGREES)
    middle, away = 0.5 * CELLS, 2.0 * CELLS
    place = (middle + away * math.sin(angle), middle, away * math.cos(angle))
    building.camera(place, (middle, middle, 0.0), ortho_scale=CELLS).data.clip_end = 10.0 * CELLS
    return scene


@pytest.fixture(scope="module")
def traced():
    """The share of light that leaves after one reflection, and its standard error."""
    (first,) = np.random.SeedSequence(SEED).spawn(1)
    field, rays = TracedField(np.random.default_rng(first), CELLS, CORRELATION, ALPHA), 400_000
    angle = np.radians(DEGREES)
    once, _ = field.reflected(np.array([np.sin(angle), 0.0, np.cos(angle)]), rays)
    return once, np.sqrt(once * (1.0 - once) / rays)


def expect_traced(images, traced):
    """The mean of independent images is the traced share, within 4.5 standard errors.

    Half a period, 16 lengths of correlation, lies about the field. With 4 of them one ray in 300 gets out by the ends.
    """
    means = np.array([image.mean() for image in images])
    error = np.hypot(means.std(ddof=1) / np.sqrt(means.size), traced[1])
    assert means.mean() == pytest.approx(traced[0], abs=4.5 * error)


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_cycles_and_the_reference_see_the_light_that_the_traced_field_reflects_once(mirrors, traced):
    assert 0.8 < traced[0] < 0.95  # one reflection is not all
    reference = ReferenceRenderer(export(mirrors), Options(seed=1, threads=1))
    expect_traced([reference.render(k, 8).radiance for k in range(8)], traced)
    with neutral(mirrors, threads=1):
        cycles = CyclesRenderer(mirrors, seed=1, threads=1)
        expect_traced([cycles.render(k, 8).radiance for k in range(8)], traced)
