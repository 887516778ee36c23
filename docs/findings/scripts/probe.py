# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the scripts in this folder: a flat plane, lit in several ways.

An orthographic camera sees it. The scripts need bpy and numpy (some need scipy) and nothing else. Run one with a Python
that has the bpy module:

    python coat_albedo.py

Every script prints one table with the columns expected, Cycles and difference. Directions are in the frame of the
plane, whose normal is +Z. All settings that are known to bias an image (filter, clamping, adaptive sampling,
denoising, bounce limits, the first sample of a pixel) are off, so that the tables show one cause each.
"""

import os
import sys
import tempfile
from contextlib import contextmanager

import bpy
import numpy as np

AIM = (0.0171, 0.0293, 0.0)
"""Point that the camera looks at: off the edge between the two triangles of the plane."""


def start(size=1, samples=1):
    """Empty the file and return a scene with unbiased Cycles settings.

    It has `size` x `size` pixels.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0.0
    cycles.pixel_filter_type = "BOX"
    cycles.samples = samples
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 8
    world = bpy.data.worlds.new("World")
    node_tree(world).nodes["Background"].inputs["Strength"].default_value = 0.0
    scene.world = world
    return scene


def node_tree(owner):
    """Node tree of a material, world or light. From Blender 5.0 on they always have one."""
    if owner.node_tree is None or not owner.use_nodes:
        owner.use_nodes = True
    return owner.node_tree


def look_from(scene, direction, width=1e-3):
    """Add an orthographic camera that looks at the point AIM from `direction`.

    It sees `width` metres.
    """
    from mathutils import Vector

    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", width
    direction = Vector(direction).normalized()
    camera.location = direction * 5.0 + Vector(AIM)
    camera.rotation_euler = direction.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera


def tilted(degrees, turn=0.0):
    """Unit vector at an angle from +Z, turned about it; both in degrees."""
    theta, phi = np.radians(degrees), np.radians(turn)
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def add_mesh(scene, vertices, faces, material, name="Mesh"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(map(float, v)) for v in vertices], [], faces)
    mesh.materials.append(material)
    body = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(body)
    return body


def add_plane(scene, material, half=2.0, height=0.0, name="Plane"):
    corners = [(-half, -half, height), (half, -half, height), (half, half, height), (-half, half, height)]
    return add_mesh(scene, corners, [(0, 1, 2, 3)], material, name)


def add_material(kind, name="Material", **inputs):
    """Material of one shader node, for example add_material("BsdfGlossy", Roughness=0.5).

    Underscores stand for blanks in names of sockets. Names in lower case are properties of the node.
    """
    material = bpy.data.materials.new(name)
    tree = node_tree(material)
    tree.nodes.clear()
    node = tree.nodes.new("ShaderNode" + kind)
    for key, value in inputs.items():
        if key[0].islower():
            setattr(node, key, value)
        else:
            node.inputs[key.replace("_", " ")].default_value = value
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def add_sun(scene, direction, strength=1.0, angle=0.0):
    """Sun that shines from `direction`: irradiance `strength` on a plane that faces it."""
    from mathutils import Vector

    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = strength, angle
    body = bpy.data.objects.new("Sun", light)
    body.rotation_euler = Vector(direction).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(body)
    return body


def add_area_light(scene, size, height, up=False):
    """Add a square area light of radiance 1 at `height` above the plane, and return it.

    It faces down, or up.
    """
    light = bpy.data.lights.new("Area", "AREA")
    light.shape, light.size = "SQUARE", size
    light.energy = np.pi * size * size
    body = bpy.data.objects.new("Area", light)
    body.location.z = height
    body.rotation_euler.x = np.pi if up else 0.0
    scene.collection.objects.link(body)
    return light


def light_world(scene, radiance=1.0):
    """Uniform world. Cycles does not sample it as a light, so it shows BSDF sampling alone."""
    node_tree(scene.world).nodes["Background"].inputs["Color"].default_value = (radiance, radiance, radiance, 1.0)
    node_tree(scene.world).nodes["Background"].inputs["Strength"].default_value = 1.0


@contextmanager
def _quiet():
    """Send what Blender writes to the terminal to nowhere."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def render(scene, seed=0):
    """Render and return the image as (height, width, 3), float64, row 0 at the bottom."""
    scene.cycles.seed = seed
    with tempfile.TemporaryDirectory() as folder, _quiet():
        scene.render.filepath = os.path.join(folder, "image.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"
        width, height = image.size
        pixels = np.empty(width * height * 4, np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[..., :3].astype(float)


def mean(image):
    """Mean of a grey image and its standard error over the pixels."""
    grey = image.mean(axis=2).ravel()
    return grey.mean(), grey.std() / np.sqrt(max(grey.size - 1, 1))


def show(title, head, rows):
    """Print a table.

    Its columns are those of `head`, then expected, Cycles, difference and, where given, the noise of Cycles.
    """
    print(f"\nBlender {bpy.app.version_string}: {title}")
    print("  ".join(f"{name:>12}" for name in (*head, "expected", "Cycles", "difference", "noise (1 sd)")))
    for *labels, expected, seen, noise in rows:
        if expected:
            change = f"{100 * (seen / expected - 1):+.3f} %"
        else:
            change = f"{seen:+.5f}"
        texts = [x if isinstance(x, str) else f"{x:g}" for x in labels]
        texts += [f"{expected:.6f}", f"{seen:.6f}", change, f"{noise:.6f}" if noise else "none"]
        print("  ".join(f"{text:>12}" for text in texts))


def sphere_grid(cos_nodes=400, turns=400, low=0.0, high=1.0):
    """Directions (3, n) and weights (n,) of a quadrature over low <= cos <= high.

    Gauss in the cosine, equal steps in the turn.
    """
    x, w = np.polynomial.legendre.leggauss(cos_nodes)
    mu, w = 0.5 * (low + high) + 0.5 * (high - low) * x, 0.5 * (high - low) * w
    phi = (np.arange(turns) + 0.5) * 2 * np.pi / turns
    sin = np.sqrt(1 - mu * mu)
    directions = np.stack([np.outer(sin, np.cos(phi)), np.outer(sin, np.sin(phi)), np.outer(mu, np.ones(turns))])
    return directions.reshape(3, -1), np.outer(w, np.full(turns, 2 * np.pi / turns)).ravel()
