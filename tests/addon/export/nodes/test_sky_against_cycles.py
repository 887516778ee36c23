# SPDX-License-Identifier: GPL-3.0-or-later
"""A matt and a glossy plate under a sky and its sun, judged by the comparison itself."""

import bpy
import pytest
from etalon.addon.job import compare_here
from etalon.lib.settings.comparison import Settings
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.addon.export.nodes.node_cells import glowing, node, prepare, quad
from etalon.tests.addon.export.nodes.test_sky import world_of

pytestmark = pytest.mark.compares_with_cycles

NEWEST = "MULTIPLE_SCATTERING" if bpy.app.version >= (5, 0) else "NISHITA"
PLATES = (("BsdfDiffuse", {"Color": (0.7, 0.6, 0.5, 1.0)}), ("BsdfGlossy", {"Roughness": 0.7}))


@pytest.mark.slow
def test_plates_under_a_sky_agree(tmp_path):
    scene = prepare("ORTHO", 16, 8)
    scene.camera.location, scene.camera.data.ortho_scale = (0.0, 0.0, 5.0), 2.0
    for x, (kind, inputs) in zip((-0.5, 0.5), PLATES, strict=True):
        material = glowing(kind, lambda tree, kind=kind, inputs=inputs: node(tree, kind, inputs))
        quad(kind, (x, 0.0, 0.0), 0.0, False).materials.append(material)
    sky = world_of(scene, sky_type=NEWEST, sun_elevation=0.9, sun_rotation=2.0)
    sky.id_data.nodes["Background"].inputs["Strength"].default_value = 0.2
    scene.world.cycles.sampling_method = "AUTOMATIC"
    settings = Settings(time=15.0, tolerance=0.01, threads=2)
    assert compare_here(scene, settings, tmp_path / "report").verdict.outcome is Outcome.EQUIVALENT
