# SPDX-License-Identifier: GPL-3.0-or-later
"""Object Info against Cycles: things glow with what they are.

They are objects, and instances of collections, of faces' children and of geometry nodes.
"""

import bpy
import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from mathutils import Matrix

OUTPUTS = ["Location", "Color", "Alpha", "Object Index", "Material Index", "Random"]


def instances_on_points(thing):
    """Geometry nodes that put `thing` on the corners of what they are given."""
    tree = bpy.data.node_groups.new("scatter", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    source, out = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    scatter, info = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = thing
    info.inputs["As Instance"].default_value = True
    tree.links.new(source.outputs[0], scatter.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], scatter.inputs["Instance"])
    tree.links.new(scatter.outputs[0], out.inputs[0])
    return tree


def crowd(studio, material):
    """A row each of four kinds of objects.

    They are objects, a collection's instances, vertex instances, and geometry nodes' instances.
    """
    studio.plain = material

    def square(name, x, y, **values):
        thing = studio.add(name, studio.mesh(name, *SQUARE), Matrix.Translation((x, y, 0.5)))
        for key, value in values.items():
            setattr(thing, key, value)
        return thing

    for k in range(3):
        square(f"thing é{k}", k + 0.5, 0.5, color=(0.2 * k, 0.3, 0.9, 0.25 + 0.2 * k), pass_index=7 * k)
    inside = bpy.data.collections.new("inside")
    member = square("member", 0.0, 0.0, color=(0.1, 0.6, 0.2, 0.5), pass_index=3)
    studio.scene.collection.objects.unlink(member)
    inside.objects.link(member)
    for k in range(3):
        empty = studio.add(f"empty {k}", None, Matrix.Translation((k + 0.5, 1.5, 0.25)))
        empty.instance_type, empty.instance_collection, empty.color = "COLLECTION", inside, (0.9, 0.1, 0.1, 1.0)
        empty.pass_index = 11
    points = [(k + 0.5, 2.5, 1.0) for k in range(3)]
    carrier = studio.add("carrier", studio.mesh("carrier", points, []))
    carrier.instance_type = "VERTS"
    square("child", 0.0, 0.0, color=(0.3, 0.3, 0.1, 0.75)).parent = carrier
    scattered = square("scattered", -50.0, 0.0, color=(0.4, 0.2, 0.3, 0.5), pass_index=2)
    ground = studio.add("ground", studio.mesh("ground", [(k + 0.5, 3.5, 1.0) for k in range(3)], []))
    ground.color, ground.pass_index = (0.7, 0.8, 0.9, 0.1), 5
    ground.modifiers.new("scatter", "NODES").node_group = instances_on_points(scattered)


SQUARE = [(-0.4, -0.4, 0), (0.4, -0.4, 0), (0.4, 0.4, 0), (-0.4, 0.4, 0)], [(0, 1, 2, 3)]


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("output", OUTPUTS)
def test_what_cycles_knows_of_objects(studio, output):
    material = studio.probe_material("ShaderNodeObjectInfo", output)
    material.pass_index = 4
    crowd(studio, material)
    studio.look_down(4.0)
    studio.camera.location = (2.0, 2.0, 10.0)
    shown = studio.cycles()
    found = ReferenceRenderer(studio.export(), Options()).render(0, 1).radiance
    inside = (slice(4, None, 8), slice(4, 24, 8))  # the middles of the squares; the fourth column is empty
    np.testing.assert_allclose(found[inside], shown[inside], rtol=1e-6, atol=1e-7)
    assert shown[inside].any(axis=2).sum() >= 8
    if output == "Random":
        assert len(np.unique(shown[inside][..., 0])) == 12


def test_a_world_has_no_object(studio):
    studio.quad()
    world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    studio.scene.world = world
    tree = world.node_tree
    info = tree.nodes.new("ShaderNodeObjectInfo")
    tree.links.new(info.outputs["Random"], tree.nodes["Background"].inputs["Strength"])
    with pytest.raises(Refused, match=r"Object Info.* in a world"):
        studio.export()
