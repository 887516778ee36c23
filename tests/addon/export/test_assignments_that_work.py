# SPDX-License-Identifier: GPL-3.0-or-later
"""Refusals that say what `--set` takes: with it set, the scene is exported."""

import bpy
import pytest
from etalon.addon.command.assignments import assign
from etalon.lib.errors import Refused


def test_what_a_refusal_says_to_set_makes_the_scene_pass(studio):
    studio.quad("floor")
    studio.quad('ho"ld')
    studio.quad("catcher", z=1.0).is_shadow_catcher = True
    fur = bpy.data.hair_curves.new("fur")
    fur.add_curves([2])
    studio.add("fur", fur)
    studio.scene.render.use_simplify = True
    with pytest.raises(Refused) as caught:
        studio.export()
    refusals = caught.value.refusals
    assert {refusal.what for refusal in refusals} == {"a shadow catcher", "hair curves", "Simplify"}
    for refusal in refusals:
        assign(refusal.assignment)
    assert studio.export().mesh.triangle_count == 6
