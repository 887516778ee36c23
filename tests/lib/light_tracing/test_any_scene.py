# SPDX-License-Identifier: GPL-3.0-or-later
"""Any scene that keeps its rules gives a finite film by light tracing.

It can be scouted, or is refused by name.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.light_tracing.scouting import scout_caustics
from etalon.lib.scene.camera import PANORAMAS
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.wavefront.test_any_scene import KEPT, scenes
from hypothesis import given, settings


def assert_lit(scene):
    if scene.camera.kind in PANORAMAS:  # most are, and refused
        scene = replace(scene, camera=replace(scene.camera, kind="PERSPECTIVE"))
    found = scout_caustics(ReferenceRenderer(scene, Options(threads=1)).kernel, 256, 2)
    assert np.isfinite(found.value).all()
    assert (found.value >= 0.0).all()
    try:
        renderer = LightTracingRenderer(scene, Options(threads=1))
    except Refused:
        return
    rendering = renderer.render(0, 16)
    assert np.isfinite(rendering.radiance).all()
    assert (rendering.radiance >= 0.0).all()
    assert not rendering.nonfinite.any()


@settings(max_examples=30, **KEPT)
@given(scenes())
def test_any_valid_scene_gives_a_finite_film(scene):
    assert_lit(scene)


@pytest.mark.slow
@settings(max_examples=250, **KEPT)
@given(scenes())
def test_any_of_many_valid_scenes_gives_a_finite_film(scene):
    assert_lit(scene)
