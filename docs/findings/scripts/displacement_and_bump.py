# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement and Bump: wrong normals on scaled objects, and by coordinates that displacement moves.

A plane is displaced by a height that grows evenly along its x axis. So it tilts, and a bump on the plane as it was has the
normal of the tilted plane, which shows N.L under a sun. Displacement Only shows it, too.
"""

import numpy as np

import probe

SLOPE = 0.75
TURN = np.radians(30.0)
NORMAL = np.array([-SLOPE * np.cos(TURN), -SLOPE * np.sin(TURN), 1.0]) / np.hypot(SLOPE, 1.0)
SUN = np.array([0.0, -0.6, 0.8])
CASES = (
    ("UV", 1.0, False),
    ("Generated", 1.0, False),
    ("Object", 1.0, False),
    ("UV", 0.25, False),
    ("UV", 0.5, False),
    ("UV", 2.0, False),
    ("UV", 4.0, False),
    ("UV", 1.0, True),
)


def link_height(material, coordinates):
    """Link a displacement that tilts a plane, which lies from -2 to 2 in its object, by SLOPE."""
    tree = probe.node_tree(material)
    (out,) = (one for one in tree.nodes if one.bl_idname == "ShaderNodeOutputMaterial")
    source = tree.nodes.new("ShaderNodeTexCoord")
    parts, node = tree.nodes.new("ShaderNodeVectorMath"), tree.nodes.new("ShaderNodeDisplacement")
    parts.operation = "DOT_PRODUCT"
    # On the plane as it was, z is 0.
    parts.inputs[1].default_value = (1.0, 0.0, 1.0) if coordinates == "Object" else (1.0, 0.0, 0.0)
    tree.links.new(source.outputs[coordinates], parts.inputs[0])
    tree.links.new(parts.outputs["Value"], node.inputs["Height"])
    grows, middle = (1.0, 0.0) if coordinates == "Object" else (0.25, 0.5)
    node.inputs["Midlevel"].default_value, node.inputs["Scale"].default_value = middle, SLOPE / grows
    tree.links.new(node.outputs[0], out.inputs["Displacement"])


def seen(method, coordinates, scale, is_smooth):
    """What the plane shows from above."""
    scene = probe.start()
    scene.cycles.max_bounces = 0
    material = probe.add_material("BsdfDiffuse", Color=(1.0, 1.0, 1.0, 1.0))
    material.displacement_method = method
    link_height(material, coordinates)
    plane = probe.add_plane(scene, material)
    layer = plane.data.uv_layers.new(name="UVMap")
    for loop in plane.data.loops:
        x, y, _ = plane.data.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (0.5 + 0.25 * x, 0.5 + 0.25 * y)
    if is_smooth:
        plane.data.shade_smooth()
    plane.scale, plane.rotation_euler.z = (scale, scale, scale), TURN
    probe.add_sun(scene, SUN, np.pi)
    probe.look_from(scene, (0.0, 0.0, 1.0), 0.1)
    return probe.render(scene).mean()


rows = []
for coordinates, scale, is_smooth in CASES:
    shading = "smooth" if is_smooth else "flat"
    for method in ("DISPLACEMENT", "BOTH"):
        found = seen(method, coordinates, scale, is_smooth)
        rows.append((method, coordinates, scale, shading, NORMAL @ SUN, found, 0.0))
probe.show("a plane that displacement tilts", ("method", "coordinates", "scale", "shading"), rows)
