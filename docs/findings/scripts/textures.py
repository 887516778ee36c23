# SPDX-License-Identifier: GPL-3.0-or-later
"""8-bit sRGB images: the order of decoding, of interpolation and of multiplying by alpha.

One point, no noise.
"""

import os
import tempfile

import bpy
import numpy as np

import probe


def decode(code):
    """sRGB to linear, IEC 61966-2-1."""
    return code / 12.92 if code <= 0.04045 else ((code + 0.055) / 1.055) ** 2.4


def shown(texels, u, folder, alpha=1.0):
    """Emission of an image of one row of 8-bit codes at the texture coordinate u."""
    scene = probe.start()
    image = bpy.data.images.new("image", len(texels), 1, alpha=True)
    image.pixels.foreach_set(np.array([[t, t, t, alpha] for t in texels], np.float32).ravel())
    image.filepath_raw, image.file_format = os.path.join(folder, "image.png"), "PNG"
    image.save()
    material = probe.add_material("Emission", Strength=1.0)
    tree = probe.node_tree(material)
    glow = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
    texture, place = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeCombineXYZ")
    texture.image = bpy.data.images.load(image.filepath_raw)
    place.inputs["X"].default_value, place.inputs["Y"].default_value = u, 0.5
    tree.links.new(place.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], glow.inputs["Color"])
    probe.add_plane(scene, material)
    probe.look_from(scene, (0.0, 0.0, 1.0))
    return probe.render(scene).mean()


with tempfile.TemporaryDirectory() as folder:
    rows = []
    for low, high in ((0, 255), (51, 204), (102, 153)):
        low, high = low / 255, high / 255
        codes = decode(0.5 * (low + high))
        rows.append(
            (low, high, f"{codes:.6f}", 0.5 * (decode(low) + decode(high)), shown([low, high], 0.5, folder), 0.0)
        )
    probe.show("midway between two texels", ("code", "code", "codes mixed"), rows)
    rows = []
    for code, alpha in ((153, 128), (230, 128), (153, 51)):
        c, a = code / 255, alpha / 255
        rows.append((c, a, f"{decode(c * a):.6f}", decode(c) * a, shown([c, c], 0.5, folder, a), 0.0))
    probe.show("straight alpha, Alpha output not linked", ("code", "alpha", "code x alpha"), rows)
