# SPDX-License-Identifier: GPL-3.0-or-later
"""Small Cycles renders that show what a node does.

There is one quad per case and one sample per pixel, without noise.
"""

from contextlib import contextmanager
from dataclasses import replace

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.departures.scene import tabulated_curves
from etalon.lib.scene.converters import Curves
from etalon.lib.scene.materials import Emission
from etalon.lib.textures import color_spaces
from etalon.lib.textures.evaluate import Evaluator
from etalon.lib.textures.fold import inputs
from etalon.lib.textures.images import ImageSet
from etalon.lib.textures.linearize import linearize

CELL = 16
FACING, TILTED, BEHIND = (0.0, False), (1.0, False), (1.2, True)
"""How a quad stands: its tilt about x in radians, and whether it shows its back."""


def node(tree, kind, inputs=None, output=None, **properties):
    """Add a node; return the output of that identifier or name, else the first.

    `inputs` by identifier are values or sockets.
    """
    added = tree.nodes.new("ShaderNode" + kind)
    for name, value in properties.items():
        setattr(added, name, value)
    sockets = {s.identifier: s for s in added.inputs}
    for name, value in (inputs or {}).items():
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, sockets[name])
        else:
            sockets[name].default_value = value
    if output is None:
        return added.outputs[0]
    return next(s for s in added.outputs if output in (s.identifier, s.name))


def stored_image(folder, name, suffix, space, mode, opaque, numbers):
    """An image of 5 x 4 random texels, saved, and loaded as Blender loads a user's file."""
    cache = {}

    def get():
        if name not in cache:
            height, width = 4, 5
            texels = numbers.random((height, width, 4))
            if opaque:
                texels[..., 3] = 1.0
            if suffix == "exr":
                texels[..., :3] *= texels[..., 3:]
            kind = {"png": OpenImageIO.UINT8, "16.png": OpenImageIO.UINT16, "exr": OpenImageIO.FLOAT}[suffix]
            buffer = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(width, height, 4, kind))
            buffer.specmod().attribute("oiio:UnassociatedAlpha", int(suffix != "exr"))
            buffer.set_pixels(OpenImageIO.ROI(), texels.astype(np.float32))
            path = folder / f"{name}.{suffix}"
            assert buffer.write(str(path))
            image = bpy.data.images.load(str(path))
            image.colorspace_settings.name = space
            image.alpha_mode = mode
            cache[name] = image
        return cache[name]

    return get


def quad(name, place, tilt, flipped):
    mesh = bpy.data.meshes.new(name)
    y = 0.5 / np.cos(tilt)
    face = (3, 2, 1, 0) if flipped else (0, 1, 2, 3)
    mesh.from_pydata([(-0.5, -y, 0), (0.5, -y, 0), (0.5, y, 0), (-0.5, y, 0)], [], [face])
    layer = mesh.uv_layers.new(name="UVMap")
    for loop in mesh.loops:
        layer.data[loop.index].uv = [(0, 0), (1, 0), (1, 1), (0, 1)][loop.vertex_index]
    thing = bpy.data.objects.new(name, mesh)
    thing.location, thing.rotation_euler[0] = place, tilt
    bpy.context.scene.collection.objects.link(thing)
    return mesh


def glowing(name, build):
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    socket = build(tree)
    tree.links.new(socket, tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def through_emission(build):
    return lambda tree: node(tree, "Emission", {"Color": build(tree)})


def prepare(kind, width, height):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    data = bpy.data.cameras.new("camera")
    data.type = kind
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.threads_mode, render.threads = "FIXED", 2
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.pixel_filter_type = 1, 0, "BOX"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    return scene


def rendered(scene, folder):
    """Pixels (3, height, width), row 0 at the bottom."""
    path = folder / "cells.exr"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return (
        OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT)[::-1, :, :3].transpose(2, 0, 1).astype(np.float64)
    )


@contextmanager
def cycles_luminance():
    """Let the reference weigh colours as Cycles before Blender 5.0 does.

    Its weights have a white point of fewer digits.
    """
    with pytest.MonkeyPatch.context() as patch:
        if bpy.app.version < (5, 0, 0):
            patch.setattr(color_spaces, "LUMINANCE_REC709", (0.2126729, 0.7151522, 0.0721750))
        yield


class Points:
    def __init__(self, coordinates, side=FACING):
        self._coordinates = coordinates
        self.size = next(iter(coordinates.values())).shape[1]
        self.cos_wo = np.full(self.size, np.cos(side[0]))
        self.backfacing = np.full(self.size, side[1])

    def coordinates(self, kind, uv_map):
        return self._coordinates[kind]

    def edge_distance(self):
        """In a quad of one metre that faces the camera, whose diagonal runs from (0, 0) to (1, 1)."""
        u, v = self._coordinates["UV"][:2]
        return np.minimum(np.where(u > v, np.minimum(v, 1.0 - u), np.minimum(u, 1.0 - v)), np.abs(u - v) * np.sqrt(0.5))


def tabulated(expression):
    """The expression with the tables that Cycles has of curves."""
    changed = replace(expression, **{name: tabulated(value) for name, value in inputs(expression).items()})
    return tabulated_curves(changed) if isinstance(changed, Curves) else changed


def read_tabulated(material, images, refusals):
    """As read_material, with the tables that Cycles has of curves."""
    read = read_material(material, images, refusals)
    return replace(
        read,
        lobes=tuple(replace(x, closure=replace(x.closure, color=tabulated(x.closure.color))) for x in read.lobes),
    )


def linearize_in_half_precision(pixels, space, config):
    """As linearize; of bytes Cycles keeps the codes and their decoded values in half precision."""
    return half(linearize(half(pixels), space, config))


def half(values):
    return np.clip(values, -65504.0, 65504.0).astype(np.float16).astype(np.float32)


def predicted(material, points, read=read_material, frame=1):
    images, refusals = ImageTable(frame), []
    lobes = read(material, images, refusals).lobes
    assert not refusals
    evaluate = Evaluator(points, ImageSet(images.images, decode_first=False, alpha_in_codes=True))
    total = np.zeros((3, points.size))
    for lobe in lobes:
        assert isinstance(lobe.closure, Emission)
        total += evaluate(lobe.weight) * evaluate(lobe.closure.strength) * evaluate(lobe.closure.color)
    return total


def assert_same(got, shown, tolerance=2e-5):
    assert np.ptp(shown) > 0 or shown.any()
    error = np.abs(got - shown) / (0.05 + np.abs(shown))
    assert error.max() < tolerance
