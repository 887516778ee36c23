# SPDX-License-Identifier: GPL-3.0-or-later
"""Refusals that say what `--set` takes: with it set, the scene is exported."""

import bpy
import pytest
from etalon.addon.command.assignments import assign
from etalon.addon.job import export
from etalon.lib.errors import Refused


def test_what_a_refusal_says_to_set_makes_the_scene_pass(studio):
    studio.quad("floor")
    studio.quad('ho"ld')
    fur = bpy.data.hair_curves.new("fur")
    fur.add_curves([2])
    studio.add("fur", fur)
    studio.scene.render.use_simplify = True
    with pytest.raises(Refused) as caught:
        studio.export()
    refusals = caught.value.refusals
    assert {refusal.what for refusal in refusals} == {"hair curves", "Simplify"}
    for refusal in refusals:
        assign(refusal.assignment)
    assert studio.export().mesh.triangle_count == 4


def test_what_a_refusal_of_the_shutter_says_to_set_makes_the_scene_pass(studio):
    studio.quad("floor")
    studio.scene.render.use_motion_blur = True
    studio.scene.render.motion_blur_position, studio.scene.cycles.rolling_shutter_type = "START", "TOP"
    with pytest.raises(Refused) as caught:
        export(studio.scene, motion_blur=True)
    for refusal in caught.value.refusals:
        assign(refusal.assignment)
    assert export(studio.scene, motion_blur=True).motion is None
    assert not caught.value.allows_partial
