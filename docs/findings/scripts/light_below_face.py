# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth shading: light from below the face, by light sampling and by BSDF sampling.

A white diffuse plane whose normals lean by `tilt` from the face. The part of the hemisphere of the normal that lies
above the face holds (1 + cos tilt) / 2 of the diffuse lobe. A bump by displacement (Bump Only) makes the normal of a flat
face lean, too.
"""

import numpy as np

import probe


def scene_of(tilt, size=1, samples=1):
    scene = probe.start(size, samples)
    body = probe.add_plane(scene, probe.add_material("BsdfDiffuse", Color=(1.0, 1.0, 1.0, 1.0)))
    body.data.polygons[0].use_smooth = True
    body.data.normals_split_custom_set([tuple(probe.tilted(tilt))] * 4)
    body.shadow_terminator_geometry_offset = 0.0
    probe.look_from(scene, (0.0, 0.0, 1.0))
    return scene


def light_textured_world(scene):
    """World of radiance 1 that Cycles takes for textured and samples as a light, with MIS."""
    probe.light_world(scene)
    tree = probe.node_tree(scene.world)
    where, line = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
    line.operation = "MULTIPLY_ADD"
    line.inputs[1].default_value, line.inputs[2].default_value = (1e-12,) * 3, (1.0,) * 3
    tree.links.new(where.outputs["Generated"], line.inputs[0])
    tree.links.new(line.outputs[0], tree.nodes["Background"].inputs["Color"])


def bumped_scene(slope):
    """A flat plane that Bump Only tilts by a height that grows evenly along -x."""
    scene = probe.start()
    material = probe.add_material("BsdfDiffuse", Color=(1.0, 1.0, 1.0, 1.0))
    material.displacement_method = "BUMP"
    tree = probe.node_tree(material)
    (out,) = (one for one in tree.nodes if one.bl_idname == "ShaderNodeOutputMaterial")
    where, parts = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSeparateXYZ")
    height = tree.nodes.new("ShaderNodeDisplacement")
    # Generated coordinates grow by 1 over the plane's 4 metres.
    height.inputs["Midlevel"].default_value, height.inputs["Scale"].default_value = 0.0, -4.0 * slope
    tree.links.new(where.outputs["Generated"], parts.inputs[0])
    tree.links.new(parts.outputs[0], height.inputs["Height"])
    tree.links.new(height.outputs[0], out.inputs["Displacement"])
    probe.add_plane(scene, material)
    probe.look_from(scene, (0.0, 0.0, 1.0), 0.1)
    return scene


rows = []
for tilt in (10.0, 30.0, 45.0):
    book = 0.5 * (1 + np.cos(np.radians(tilt)))
    for name, light in (("uniform", probe.light_world), ("textured", light_textured_world)):
        scene = scene_of(tilt, 64, 32)
        light(scene)
        rows.append((tilt, name, book, *probe.mean(probe.render(scene))))
probe.show("white plane, world of radiance 1", ("tilt", "world"), rows)
rows = []
for tilt, angle in ((30.0, 80.0), (30.0, 100.0), (45.0, 120.0)):
    scene = scene_of(tilt)
    probe.add_sun(scene, probe.tilted(angle), np.pi)
    book = np.cos(np.radians(angle - tilt))
    rows.append((tilt, angle, f"{book:.6f}", book if angle < 90 else 0.0, probe.render(scene).mean(), 0.0))
probe.show("white plane, one sun; beyond 90 degrees it shines on the back", ("tilt", "sun", "N.L"), rows)
rows = []
for tilt, angle in ((36.87, 60.0), (36.87, 85.0), (36.87, 95.0), (36.87, 120.0)):
    scene = bumped_scene(np.tan(np.radians(tilt)))
    probe.add_sun(scene, probe.tilted(angle), np.pi)
    book = np.cos(np.radians(angle - tilt))
    rows.append((tilt, angle, f"{book:.6f}", book if angle < 90 else 0.0, probe.render(scene).mean(), 0.0))
probe.show("the same by Bump Only on a flat face", ("tilt", "sun", "N.L"), rows)
