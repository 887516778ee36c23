# SPDX-License-Identifier: GPL-3.0-or-later
"""A script inside Blender that saves a file to its last argument.

The file has much of what users' files hold.
"""

import sys

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.render.resolution_x, scene.render.resolution_y = 64, 32
scene.cycles.max_bounces = 1

camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.data.type, camera.data.panorama_type = "PANO", "EQUIRECTANGULAR"
camera.location, camera.rotation_euler = (0.0, -5.0, 1.5), (1.5, 0.0, 0.0)
scene.collection.objects.link(camera)
scene.camera = camera

colors = bpy.data.materials.new("colors")
colors.use_nodes = True
tree = colors.node_tree
tree.nodes.clear()
info, surface, out = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("ObjectInfo", "BsdfDiffuse", "OutputMaterial"))
tree.links.new(info.outputs["Random"], surface.inputs["Color"])
tree.links.new(surface.outputs[0], out.inputs["Surface"])

bpy.ops.mesh.primitive_plane_add(size=20.0)
bpy.ops.mesh.primitive_cube_add(size=0.6)
cube = bpy.context.object
cube.data.materials.append(colors)
for k in range(6):
    copy = cube.copy()
    copy.location = (k - 3.0, 1.0, 0.5)
    scene.collection.objects.link(copy)
bpy.ops.object.text_add(location=(-1.0, -1.0, 0.1))
bpy.context.object.data.extrude = 0.05
bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, -1.0, 3.0))
bpy.context.object.visible_camera = False

hidden = bpy.data.collections.new("hidden")
scene.collection.children.link(hidden)
bpy.ops.mesh.primitive_cube_add(size=1.0, location=(2.0, -2.0, 0.5))
aside = bpy.context.object
for collection in aside.users_collection:
    collection.objects.unlink(aside)
hidden.objects.link(aside)
scene.view_layers[0].layer_collection.children["hidden"].exclude = True
scene.view_layers.new("second")

lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA"))
lamp.data.energy, lamp.data.size, lamp.location = 500.0, 2.0, (2.0, -2.0, 5.0)
scene.collection.objects.link(lamp)
scene.world = bpy.data.worlds.new("sky")
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
