# SPDX-License-Identifier: GPL-3.0-or-later
"""The probes in Blender: node trees, facets, and what the Cycles at hand shows of them."""

import bpy
import numpy as np
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.tests.probes.definitions import FURNACES, IRRADIANCE, NOISY, SUNS, tilts
from mathutils import Vector

SAMPLES = 4096  # of noisy lights; whole nets: their error falls faster than that of random samples
# Replicates of noisy lights, and pixels of a facet's side, less a rim of one pixel. Few large images: each render takes time to start.
REPLICATES = {"front prism": 1, "back prism": 1, "furnace": 1, "grazing furnace": 2}
PIXELS = {"front prism": 8, "back prism": 8, "furnace": 10, "grazing furnace": 20}
FEW_PIXELS = 6  # where there is no noise


def node_tree(probe):
    """A material whose surface is the probe's node."""
    made = bpy.data.materials.new(probe.key)
    if bpy.app.version < (5, 0):
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNode" + probe.node)
    if probe.distribution:
        setattr(shader, "component" if probe.node == "BsdfToon" else "distribution", probe.distribution)
    if probe.fresnel:
        shader.fresnel_type = probe.fresnel
    sockets = {socket.identifier: socket for socket in shader.inputs}
    for name, value in probe.inputs.items():
        sockets[name].default_value = value
    if probe.is_stretched:
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type, tangent.uv_map = "UV_MAP", "UVMap"
        tree.links.new(tangent.outputs[0], sockets["Tangent"])
    if probe.normal:
        turned = tree.nodes.new("ShaderNodeNormalMap")
        turned.inputs["Color"].default_value, turned.inputs["Strength"].default_value = probe.normal
        tree.links.new(turned.outputs[0], sockets["Normal"])
    tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return made


def prepare(width, height):
    """An empty scene for Cycles, with light after one scattering only."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    made = bpy.context.scene
    made.render.engine = "CYCLES"
    made.render.resolution_x, made.render.resolution_y, made.render.resolution_percentage = width, height, 100
    made.cycles.max_bounces = 0
    return made


def link(made, name, data):
    """A new object of the scene."""
    thing = bpy.data.objects.new(name, data)
    made.collection.objects.link(thing)
    return thing


def facet(made, probe, row, column):
    """A facet one metre square as the camera sees it; only the camera does."""
    tilt = tilts(probe.light)[column]
    half = 0.5 / np.cos(tilt)
    mesh = bpy.data.meshes.new(probe.key)
    mesh.from_pydata([(-0.5, -half, 0), (0.5, -half, 0), (0.5, half, 0), (-0.5, half, 0)], [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new(name="UVMap")
    for loop in mesh.loops:
        layer.data[loop.index].uv = [(0, 0), (1, 0), (1, 1), (0, 1)][loop.vertex_index]
    thing = link(made, probe.key, mesh)
    thing.location, thing.rotation_euler[0] = (column + 0.5, row + 0.5, 0.0), tilt
    for ray in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(thing, f"visible_{ray}", False)
    return mesh


def pixels_of(light):
    """The pixels of a facet's side."""
    return PIXELS.get(light, FEW_PIXELS)


def build(probes):
    """The scene of probes under one light; rows are probes from below, columns are tilts."""
    (light,) = {probe.light for probe in probes}
    columns = len(tilts(light))
    side = pixels_of(light)
    made = prepare(side * columns, side * len(probes))
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", max(len(probes), columns)
    made.camera = link(made, "camera", camera)
    made.camera.location = (columns / 2, len(probes) / 2, 20.0)
    for row, probe in enumerate(probes):
        tree = node_tree(probe)
        for column in range(columns):
            facet(made, probe, row, column).materials.append(tree)
    if light in FURNACES:
        made.world = bpy.data.worlds.new("white")
        if bpy.app.version < (5, 0):
            made.world.use_nodes = True
        (background,) = (n for n in made.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
        background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        background.inputs["Strength"].default_value = 1.0
    else:
        sun = bpy.data.lights.new("sun", "SUN")
        sun.energy, sun.angle = IRRADIANCE, 0.0
        link(made, "sun", sun).rotation_euler = Vector(SUNS[light]).to_track_quat("Z", "Y").to_euler()
    return made


def shown(probes, seed=0):
    """What Cycles shows of probes under one light, (probes, tilts, 3)."""
    light = probes[0].light
    columns, side = len(tilts(light)), pixels_of(light)
    renderer = CyclesRenderer(build(probes), seed=seed, threads=2)
    count, samples = (REPLICATES[light], SAMPLES) if light in NOISY else (1, 1)
    total = np.zeros((len(probes), columns, 3))
    for replicate in range(count):
        image = renderer.render(replicate, samples).radiance[::-1]
        cells = image.reshape(len(probes), side, columns, side, 3)[:, 1:-1, :, 1:-1]
        total += cells.mean(axis=(1, 3)) / count
    return total
