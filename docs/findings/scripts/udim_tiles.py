# SPDX-License-Identifier: GPL-3.0-or-later
"""A face whose texture coordinates reach over three tiles of an image.

It is seen in the middle of each.
"""

import os
import tempfile

import bpy
import numpy as np

import probe

TILES = {1001: 0.2, 1011: 0.4, 1021: 0.6}


def write_tiles(folder):
    """Write a grey image of 4 x 4 pixels for each tile.

    Returns the path with its mark for the number.
    """
    for number, grey in TILES.items():
        image = bpy.data.images.new(f"{number}", 4, 4, float_buffer=True, is_data=True)
        image.pixels.foreach_set(np.tile(np.array([grey, grey, grey, 1.0], np.float32), 16))
        image.file_format, image.filepath_raw = "OPEN_EXR", os.path.join(folder, f"tile.{number}.exr")
        image.save()
    return os.path.join(folder, "tile.<UDIM>.exr")


def seen(row, cut, folder):
    """What Cycles shows in the middle of tile `row`.

    The face is one, or is cut at the tiles' borders.
    """
    scene = probe.start()
    path = write_tiles(folder)
    image = bpy.data.images.load(path.replace("<UDIM>", "1001"))
    image.source, image.filepath = "TILED", path
    for number in list(TILES)[1:]:
        image.tiles.new(number)
    image.colorspace_settings.name = "Non-Color"
    material = probe.add_material("Emission", Strength=1.0)
    tree = probe.node_tree(material)
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    tree.links.new(node.outputs["Color"], next(n for n in tree.nodes if n.type == "EMISSION").inputs["Color"])
    edges = [0.2, 1.0, 2.0, 2.8] if cut else [0.2, 2.8]
    vertices = [(x, v, 0.0) for v in edges for x in (0.2, 0.8)]
    faces = [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(len(edges) - 1)]
    body = probe.add_mesh(scene, vertices, faces, material)
    layer = body.data.uv_layers.new(name="UVMap")
    for corner, place in zip(body.data.loops, layer.data, strict=True):
        place.uv = vertices[corner.vertex_index][:2]
    probe.look_from(scene, (0.0, 0.0, 1.0))
    scene.camera.location.x, scene.camera.location.y = 0.47, row + 0.53
    return probe.render(scene).mean(axis=(0, 1))


with tempfile.TemporaryDirectory() as folder:
    print(f"\nBlender {bpy.app.version_string}: red, green, blue in the middle of each tile")
    print(f"{'tile':>6}  {'face':>18}  {'expected':>20}  {'Cycles':>20}")
    for row, (number, grey) in enumerate(TILES.items()):
        for cut in (False, True):
            shown = "  ".join(f"{value:.3f}" for value in seen(row, cut, folder))
            print(
                f"{number:>6}  {'cut at the borders' if cut else 'whole':>18}  {'  '.join([f'{grey:.3f}'] * 3):>20}  {shown:>20}"
            )
