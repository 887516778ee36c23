# SPDX-License-Identifier: GPL-3.0-or-later
"""Shading normals level with the face: rounding decides whether light counts.

First a plane whose Diffuse BSDF has a normal that is level with it: it shows N.L. Then the upper face of a right-angled
edge with a Bevel node, near the edge, where all probes of a sample may meet the other face alone. Object, camera and sun
are turned as a whole, which must not matter. The turns of the edge are small, since a Bevel node with few samples
depends on the axes of its probes, which follow the turn.
"""

import bpy
import numpy as np
from mathutils import Euler, Matrix

import probe

RADIUS, WINDOW, WIDTH = 0.1, 0.02, 0.01
"""Of the Bevel node; where the camera looks, in metres from the edge; and how much it sees."""
SUN = (0.9, 0.0, np.sqrt(1.0 - 0.81))


def turns(count, most=np.pi):
    """Turns (3, 3): none, then random ones by three angles between -`most` and `most`, in radians."""
    rng = np.random.default_rng(1)
    return [np.eye(3)] + [np.array(Euler(rng.uniform(-most, most, 3)).to_matrix()) for _ in range(count)]


def scene_of(turn, corners, faces, material, samples, size, look=0.0):
    """A mesh from above, under a sun of irradiance pi, all turned."""
    if hasattr(material.cycles, "use_bump_map_correction"):
        material.cycles.use_bump_map_correction = False
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.max_bounces = samples, 0
    scene.render.resolution_x = scene.render.resolution_y = size
    matrix = Matrix(turn.tolist()).to_4x4()
    body = probe.add_mesh(scene, corners, faces, material)
    body.matrix_world = matrix
    probe.add_sun(scene, SUN, np.pi)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", WIDTH
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.matrix_world = matrix @ Matrix.Translation((look, 0.013, 5.0))
    sun = bpy.data.objects["Sun"]
    sun.matrix_world = matrix @ sun.rotation_euler.to_matrix().to_4x4()
    return scene


def link_normal(material, node, output):
    tree = probe.node_tree(material)
    shader = next(one for one in tree.nodes if "Normal" in one.inputs and one != node)
    tree.links.new(node.outputs[output], shader.inputs["Normal"])


def level_normal(turn):
    """What a plane shows whose normal is its own X axis."""
    probe.start()
    material = probe.add_material("BsdfDiffuse", Color=(1.0, 1.0, 1.0, 1.0))
    node = probe.node_tree(material).nodes.new("ShaderNodeCombineXYZ")
    for socket, value in zip(node.inputs, turn[:, 0], strict=True):
        socket.default_value = value
    link_normal(material, node, "Vector")
    corners = [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)]
    return probe.render(scene_of(turn, corners, [(0, 1, 2, 3)], material, 1, 1)).mean()


def bevelled(turn, count, samples=256, size=32):
    """The mean over a window of the upper face of an edge, and its standard error."""
    probe.start()
    material = probe.add_material("BsdfDiffuse", Color=(1.0, 1.0, 1.0, 1.0))
    node = probe.node_tree(material).nodes.new("ShaderNodeBevel")
    node.samples, node.inputs["Radius"].default_value = count, RADIUS
    link_normal(material, node, "Normal")
    corners = [(-2, -2, 0), (0, -2, 0), (0, 2, 0), (-2, 2, 0), (0, -2, -2), (0, 2, -2)]
    scene = scene_of(turn, corners, [(0, 1, 2, 3), (1, 4, 5, 2)], material, samples, size, -WINDOW)
    return probe.mean(probe.render(scene))


rows = [(f"turn {k}", SUN[0], level_normal(turn), 0.0) for k, turn in enumerate(turns(7))]
probe.show("a normal level with the face", ("",), rows)
rows = []
for count in (2, 4, 8, 16):
    straight, noise = bevelled(np.eye(3), count)
    found = sorted(bevelled(lean, count) for lean in turns(8, 0.002)[1:])
    for name, (seen, other) in (("darkest", found[0]), ("brightest", found[-1])):
        rows.append((count, name, straight, seen, np.hypot(noise, other)))
probe.show("Bevel node near a right-angled edge, 8 turns by 0.2 degrees at most", ("samples", "of 8"), rows)
