# SPDX-License-Identifier: GPL-3.0-or-later
"""Film: pixel filter, first sample of a pixel, and sums in single precision.

The filter is tested for its offset. Emission only.
"""

import numpy as np

import probe

WIDTH = 1.0


def scene_of(size, samples, operations=(), first=1):
    """Plane that emits a function of x in pixels, from the left edge of the image.

    Each operation is (name, operand).
    """
    scene = probe.start(size, samples + first)
    if first:
        scene.cycles.use_sample_subset, scene.cycles.sample_offset = True, first
        scene.cycles.sample_subset_length = samples
    material = probe.add_material("Emission", Strength=1.0)
    tree = probe.node_tree(material)
    glow = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
    position, parts = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(position.outputs["Position"], parts.inputs[0])
    socket = parts.outputs["X"]
    shift = WIDTH / 2 - probe.AIM[0]
    for name, operand in (("ADD", shift), ("MULTIPLY", size / WIDTH), *operations):
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = name
        node.inputs[1].default_value = operand
        tree.links.new(socket, node.inputs[0])
        socket = node.outputs[0]
    tree.links.new(socket, glow.inputs["Color"])
    probe.add_plane(scene, material)
    probe.look_from(scene, (0.0, 0.0, 1.0), WIDTH)
    return scene


def offsets(scene):
    """Mean offset of each pixel's samples to the right.

    Seen from above with Y down, X runs to the left.
    """
    image = probe.render(scene).mean(axis=2)
    return image.shape[1] - image - (np.arange(image.shape[1]) + 0.5)


rows = []
for kind in ("BOX", "BLACKMAN_HARRIS", "GAUSSIAN"):
    scene = scene_of(32, 512)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = kind, 1.5
    found = offsets(scene)[:, 4:-4]
    rows.append((kind[:12], 0.0, found.mean(), found.std() / np.sqrt(found.size)))
probe.show("mean offset of the samples to the right, pixels", ("filter",), rows)

spread = offsets(scene_of(64, 1, first=0)).std()
rest = offsets(scene_of(64, 1)).std()
probe.show(
    "spread of the offset over 4096 pixels at 1 sample, pixels; uniform is 1 / sqrt 12",
    ("sample",),
    [("first", 1 / np.sqrt(12), spread, 0.0), ("second", 1 / np.sqrt(12), rest, 0.0)],
)
rows = []
for samples in (4, 16, 64):
    scene = scene_of(64, samples, [("FRACT", 0.0), ("GREATER_THAN", 0.75)], first=0)
    seen, noise = probe.mean(probe.render(scene))
    rows.append((samples, f"{0.25 * (1 - 1 / samples):.6f}", 0.25, seen, noise))
probe.show("a quarter of each pixel glows, its centre does not", ("samples", "predicted"), rows)

rows = []
for samples in (1024, 4096, 16384):
    scene = scene_of(2, samples, [("MULTIPLY", 0.0), ("ADD", 0.7)])
    rows.append((samples, float(np.float32(0.7)), probe.render(scene).mean(), 0.0))
probe.show("constant emission 0.7", ("samples",), rows)
