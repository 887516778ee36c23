# SPDX-License-Identifier: GPL-3.0-or-later
"""The content of node groups' sockets, against Cycles.

It covers each type of content, through each type of socket, to each use.
"""

from itertools import product

import bpy
import numpy as np
import pytest
from etalon.tests.addon.export.nodes.node_cases import COORDINATES, first_color, linear, uv
from etalon.tests.addon.export.nodes.node_cells import (
    CELL,
    FACING,
    Points,
    assert_same,
    cycles_luminance,
    glowing,
    node,
    predicted,
    prepare,
    quad,
    rendered,
    through_emission,
)

pytestmark = pytest.mark.compares_with_cycles

CONTENT = {
    "Float": lambda tree: linear(tree, 0.7, 0.1),
    "Vector": uv,
    "Color": lambda tree: node(tree, "Gamma", {"Color": first_color(tree), "Gamma": 1.0}),
}
USE = {
    "Float": lambda tree, socket: node(tree, "Math", {"Value": socket, "Value_001": 0.0}),
    "Vector": lambda tree, socket: node(tree, "VectorMath", {"Vector": socket, "Vector_001": (0.0, 0.0, 0.0)}),
    "Color": lambda tree, socket: node(tree, "Gamma", {"Color": socket, "Gamma": 1.0}),
}
DEFAULT = {"Float": 0.3, "Vector": (0.1, 0.5, 0.9), "Color": (0.2, 0.4, 0.9, 1.0)}


def group(kind_in, kind_out, fill):
    """A group with one input and one output socket of those kinds.

    `fill(tree, input)` returns what its output shows.
    """
    tree = bpy.data.node_groups.new("group", "ShaderNodeTree")
    tree.interface.new_socket("In", in_out="INPUT", socket_type=f"NodeSocket{kind_in}")
    tree.interface.new_socket("Out", in_out="OUTPUT", socket_type=f"NodeSocket{kind_out}")
    first, last = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(fill(tree, first.outputs[0]), last.inputs[0])
    return tree


def placed(tree, inner, content=None, default=None):
    made = tree.nodes.new("ShaderNodeGroup")
    made.node_tree = inner
    if content is not None:
        tree.links.new(content, made.inputs[0])
    if default is not None:
        made.inputs[0].default_value = default
    return made.outputs[0]


def into(content, socket, use):
    """Content of one kind into an input of another, used inside as a third."""
    return lambda tree: placed(tree, group(socket, use, USE[use]), CONTENT[content](tree))


def out_of(content, socket, use):
    """Content made inside, out of an output of another kind, used outside as a third."""
    return lambda tree: USE[use](tree, placed(tree, group("Float", socket, lambda inner, _: CONTENT[content](inner))))


def unlinked(outer, socket, use):
    """The value of a group's unlinked input, into a group inside it, used there."""

    def build(tree):
        inner = group(socket, use, USE[use])
        return placed(
            tree, group(outer, use, lambda middle, value: placed(middle, inner, value)), default=DEFAULT[outer]
        )

    return build


def straight(content, first, second):
    """Content through a group that only leads its input to its output, to a colour."""
    return lambda tree: USE["Color"](tree, placed(tree, group(first, second, lambda _, x: x), CONTENT[content](tree)))


WAYS = {"into": into, "out of": out_of, "unlinked": unlinked, "straight": straight}
CASES = {
    f"{way} {' '.join(kinds)}": build(*kinds) for way, build in WAYS.items() for kinds in product(CONTENT, repeat=3)
}


@pytest.fixture(scope="module")
def cells(tmp_path_factory):
    """Case -> what Cycles shows, what we predict."""
    cases = COORDINATES | CASES
    side = int(np.ceil(np.sqrt(len(cases))))
    scene = prepare("ORTHO", side * CELL, side * CELL)
    scene.camera.data.ortho_scale = side
    scene.camera.location = (side / 2, side / 2, 10)
    materials = {}
    for index, (name, build) in enumerate(cases.items()):
        mesh = quad(name, (index % side + 0.5, index // side + 0.5, 0), *FACING)
        materials[name] = glowing(name, through_emission(build))
        mesh.materials.append(materials[name])
    picture = rendered(scene, tmp_path_factory.mktemp("groups"))
    shown = {}
    for index, name in enumerate(cases):
        row, column = index // side * CELL, index % side * CELL
        shown[name] = picture[:, row : row + CELL, column : column + CELL].reshape(3, -1)
    points = Points({kind: shown[kind] for kind in COORDINATES})
    with cycles_luminance():
        return {name: (shown[name], predicted(materials[name], points)) for name in CASES}


@pytest.mark.parametrize("name", CASES)
def test_sockets_of_groups_pass_on_what_cycles_shows(cells, name):
    shown, got = cells[name]
    # Blender converts what is the same everywhere itself, by weights of luminance of four digits.
    assert_same(got, shown, 5e-5 if name.startswith("unlinked") else 2e-5)
