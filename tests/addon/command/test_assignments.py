# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties by data path: set as meant, or refused by name; never evaluated."""

import bpy
import pytest
from etalon.addon.command.assignments import assign
from etalon.lib.errors import EtalonError

NAME = 'A = "b".c[1]'
NODE = r'materials["A = \"b\".c[1]"].node_tree.nodes["Glossy BSDF"]'


@pytest.fixture
def node():
    """A Glossy node in a material whose name holds all that a path is made of."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    material = bpy.data.materials["Material"]
    material.name = NAME
    return material.node_tree.nodes.new("ShaderNodeBsdfAnisotropic")


def test_numbers_vectors_choices_and_the_open_scene(node):
    assign(f'{NODE}.inputs["Roughness"].default_value=0.3')
    assign(f"{NODE}.distribution=BECKMANN")
    assign(f'{NODE}.distribution = "GGX"')
    assign('objects["Cube"].location=[1, 2, 3]')
    assign('objects["Cube"].location[1] = 2.5')
    assign("scene.cycles.max_bounces=7")
    assign("scene.name=renamed=scene")
    assert node.inputs["Roughness"].default_value == pytest.approx(0.3)
    assert node.distribution == "GGX"
    assert list(bpy.data.objects["Cube"].location) == [1, 2.5, 3]
    assert bpy.context.scene.cycles.max_bounces == 7
    assert bpy.context.scene.name == "renamed=scene"


@pytest.mark.parametrize(
    ("assignment", "complaint"),
    [
        ("scene.cycles.max_bounces", "is not PATH=VALUE"),
        ("=3", "is not PATH=VALUE"),
        ("scene.cycles.max_bounce=7", "no such property"),
        ("scene.__class__=7", "no such property"),
        ('objects["Cub"].location=[1, 2, 3]', "no such property"),
        ('objects["Cube"].location=[1, 2]', "cannot be set"),
        ('objects["Cube"].location[3]=1', "cannot be set"),
        (f"{NODE}.distribution=PHONG", "cannot be set"),
        (f"{NODE}.distribution=3", "cannot be set"),
        ("scene.cycles.max_bounces=-1", r"turns -1 into 0"),
        ("is_dirty=true", "cannot be set"),
        ('__import__("os").sep="x"', "no such property"),
    ],
)
def test_what_cannot_be_set_is_named(node, assignment, complaint):
    with pytest.raises(EtalonError, match=complaint):
        assign(assignment)
