# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes with one light are rendered without Cycles' light tree.

The setting comes back, the mean is the same, and other scenes keep what the file says.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.job import compare_here
from etalon.lib.settings.comparison import Settings
from etalon.reference_scenes import building
from etalon.tests.replicates import assert_same, blocks

TREE, THRESHOLD = "cycles.use_light_tree", "cycles.light_sampling_threshold"


def room(lamps=1):
    """A floor and a wall below lamps: noise in every pixel."""
    scene = building.start("room", 16, 16, 2)
    building.world((0.0, 0.0, 0.0))
    paper = building.diffuse("Paper", (0.8, 0.6, 0.4))
    building.rectangle("Floor", paper, (0.0, 0.0, 0.0), (9.0, 0.0, 0.0), (0.0, 9.0, 0.0))
    building.rectangle("Wall", paper, (0.0, 1.0, 0.0), (9.0, 0.0, 0.0), (0.0, 0.0, 9.0))
    for k in range(lamps):
        building.area_light(f"Lamp {k}", (0.2 + k, 0.1, 1.0), (0.2 + k, 0.3, 0.0), (1.0, 1.0), (0.05, 0.04, 0.03))
    building.camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), ortho_scale=2.0)
    return scene


def test_the_tree_is_off_meanwhile_and_comes_back():
    scene = room()
    scene.cycles.use_light_tree, scene.cycles.light_sampling_threshold = True, 0.25
    with neutral(scene, one_light=True) as changes:
        assert not scene.cycles.use_light_tree
        assert scene.cycles.light_sampling_threshold == 0.0
        assert changes.settings[TREE] is False
    assert scene.cycles.use_light_tree
    assert scene.cycles.light_sampling_threshold == 0.25


def test_other_scenes_keep_the_users_choice():
    for choice in (True, False):
        scene = room(2)
        scene.cycles.use_light_tree = choice
        with neutral(scene) as changes:
            assert scene.cycles.use_light_tree is choice
        assert TREE not in changes.settings


@pytest.mark.parametrize("lamps", [1, 2])
def test_a_comparison_says_what_was_switched_off(lamps):
    settings = Settings(time=None, samples=1, replicates=2, threads=1, passes="none")
    comparison = compare_here(room(lamps), settings)
    assert comparison.candidate.settings.get(TREE, True) is (lamps > 1)
    assert comparison.candidate.settings.get(THRESHOLD, 0.01) == (0.01 if lamps > 1 else 0.0)
    assert bpy.context.scene.cycles.use_light_tree


@pytest.mark.compares_with_cycles
def test_the_mean_is_the_same_without_the_tree(seed):
    scene = room()
    ways = []
    for one_light in (False, True):
        renderer = CyclesRenderer(scene, seed=seed + one_light, threads=1, one_light=one_light)
        with neutral(scene, threads=1, one_light=one_light):
            ways.append(np.array([renderer.render(k, 256).radiance for k in range(8)]))
    assert ways[0].std(axis=0).mean() > 1e-3 * ways[0].mean()
    assert_same(blocks(ways[0], 4), blocks(ways[1], 4), precision=0.003)
