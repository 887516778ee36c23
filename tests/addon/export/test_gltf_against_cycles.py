# SPDX-License-Identifier: GPL-3.0-or-later
"""A file as users have them, against Cycles.

It is a glTF with base colour, metal-rough and normal textures, through Blender's importer.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.job import export
from etalon.lib.scene.materials import Diffuse, Metallic, Specular
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.addon.export.nodes.node_cells import node
from mathutils import Vector

pytestmark = pytest.mark.compares_with_cycles

REPLICATES, SAMPLES, SIZE, BLOCK = 4, 64, 32, 8


def picture(folder, name, channels, space):
    """A saved 64 x 64 image of three functions of u and v."""
    v, u = np.mgrid[0:64, 0:64] / 64.0
    rows = [np.broadcast_to(channel, u.shape) for channel in (*channels(u, v), 1.0)]
    image = bpy.data.images.new(name, 64, 64)
    image.colorspace_settings.name = space
    image.pixels.foreach_set(np.stack(rows, axis=2).astype(np.float32).ravel())
    image.filepath_raw, image.file_format = str(folder / f"{name}.png"), "PNG"
    image.save()
    return image


def exported_sphere(folder):
    """The path of a glTF of one textured, smooth sphere."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    material = bpy.data.materials.new("metal")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    (shader,) = (n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    base = picture(folder, "base", lambda u, v: (0.3 + 0.6 * u, 0.2 + 0.5 * v, 0.5 + 0.3 * np.sin(9 * u)), "sRGB")
    rough = picture(folder, "rough", lambda u, v: (0.0, 0.25 + 0.6 * v, u > 0.5), "Non-Color")
    bumps = picture(
        folder, "bumps", lambda u, v: (0.5 + 0.2 * np.sin(12 * u), 0.5 + 0.2 * np.cos(10 * v), 0.95), "Non-Color"
    )
    tree.links.new(node(tree, "TexImage", image=base), shader.inputs["Base Color"])
    parts = node(tree, "SeparateColor", {"Color": node(tree, "TexImage", image=rough)}).node
    tree.links.new(parts.outputs["Green"], shader.inputs["Roughness"])
    tree.links.new(parts.outputs["Blue"], shader.inputs["Metallic"])
    tree.links.new(node(tree, "NormalMap", {"Color": node(tree, "TexImage", image=bumps)}), shader.inputs["Normal"])
    bpy.context.object.data.materials.append(material)
    path = folder / "sphere.glb"
    bpy.ops.export_scene.gltf(filepath=str(path))
    return path


def lit_and_seen(path):
    """The imported file under an area light and a sky."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    bpy.ops.import_scene.gltf(filepath=str(path))
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.camera.location, scene.camera.rotation_euler = (0.0, -4.0, 0.0), (np.pi / 2.0, 0.0, 0.0)
    light = bpy.data.lights.new("light", "AREA")
    light.energy, light.size = 300.0, 2.0
    lamp = bpy.data.objects.new("light", light)
    lamp.location = (2.0, -3.0, 3.0)
    lamp.rotation_euler = Vector(lamp.location).to_track_quat("Z", "Y").to_euler()
    for thing in (scene.camera, lamp):
        scene.collection.objects.link(thing)
    scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.4, 0.45, 0.5, 1.0)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.cycles.max_bounces = 3
    return scene


def test_a_gltf_with_textures_agrees(tmp_path):
    """The whole image agrees to 0.2 %, half of the blocks to noise.

    At silhouettes Cycles' smooth shading depends on its estimator.
    """
    scene = lit_and_seen(exported_sphere(tmp_path))
    exported = export(scene)
    assert {type(lobe.closure) for lobe in exported.materials[0].lobes} == {Metallic, Specular, Diffuse}
    reference, cycles = (
        np.array([side.render(k, SAMPLES).radiance for k in range(REPLICATES)])
        for side in (ReferenceRenderer(exported, Options()), CyclesRenderer(scene, threads=2))
    )
    assert reference.mean() == pytest.approx(cycles.mean(), rel=2e-3)
    parts = SIZE // BLOCK
    blocks = [a.reshape(REPLICATES, parts, BLOCK, parts, BLOCK, 3).mean(axis=(2, 4)) for a in (reference, cycles)]
    error = np.sqrt(sum(b.var(axis=0, ddof=1) for b in blocks) / REPLICATES)
    apart = np.abs(blocks[0].mean(axis=0) - blocks[1].mean(axis=0))
    assert np.median(apart / (error + 1e-4 * blocks[1].mean(axis=0))) < 2.0
    assert (apart / blocks[1].mean(axis=0)).max() < 0.03
