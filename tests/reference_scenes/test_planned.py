# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference scenes as exported: what their plans leave out changes no bit."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.addon.command.opening import open_target
from etalon.addon.job import export
from etalon.lib.effects.plan import make_plan
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.reference_scenes import SCENES

# Another way of finding the same light, with noise of its own.
OTHER_ESTIMATORS = ("environment table", "mesh lights")


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_planned_and_forced_images_are_the_same(name, seed):
    import bpy

    open_target(name)
    bpy.context.scene.render.resolution_percentage = 20
    scene = export(bpy.context.scene)
    scene = replace(scene, world=replace(scene.world, table_resolution=(64, 32)))
    plan = make_plan(scene)
    forced = plan.forcing(*(d.effect for d in plan.decisions if d.effect not in OTHER_ESTIMATORS))
    options = Options(threads=1, seed=seed)
    images = [ReferenceRenderer(scene, options, one).render(0, 4).radiance for one in (plan, forced)]
    assert images[0].any()
    np.testing.assert_array_equal(*images)
