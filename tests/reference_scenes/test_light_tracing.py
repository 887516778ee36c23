# SPDX-License-Identifier: GPL-3.0-or-later
"""Light tracing and path tracing of the reference scenes agree.

Not among them: `veach_plates` and `grazing_plane`, whose narrow lobes the camera sees itself. Light tracing meets them so seldom that the
standard errors of few replicates mean nothing; tests/lib/light_tracing holds their lights and lobes one by one.
"""

import bpy
import pytest
from etalon.addon.job import export
from etalon.reference_scenes import build
from etalon.tests.lib.light_tracing.traced import light_traced
from etalon.tests.replicates import assert_same, blocks, replicates

SIZE = 32
SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("name", "samples"),
    [
        ("lambert_analytic", 64),
        pytest.param("furnace", 64, marks=SLOW),
        pytest.param("glossy_spheres", 256, marks=SLOW),
        pytest.param("cornell_glossy", 32, marks=SLOW),
        pytest.param("far_from_origin", 320, marks=SLOW),
    ],
)
def test_both_give_the_same_image(name, samples, seed):
    """Four blocks of 16 x 16 pixels, ten replicates each.

    Most of the noise is light tracing's: of path tracing few samples are enough.
    """
    build(name)
    render = bpy.context.scene.render
    render.resolution_x = render.resolution_y = SIZE
    render.resolution_percentage = 100
    scene = export(bpy.context.scene)
    traced = blocks(replicates(scene, 10, 16, seed=seed), SIZE // 2)
    assert_same(traced, blocks(light_traced(scene, 10, samples, seed=seed + 1), SIZE // 2), 0.05)
