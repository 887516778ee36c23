# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials made of a few nodes and read: what the tests of reading and of refusing share."""

import bpy
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.images import ImageTable
from etalon.tests.addon.export.nodes.node_cells import glowing, node


def lobes(build):
    refusals = []
    read = read_material(glowing("Gold", build), ImageTable(), refusals)
    assert [str(refusal) for refusal in refusals] == []
    return read.lobes


def refused(build, name="Gold"):
    refusals = []
    material = build if isinstance(build, bpy.types.Material) else glowing(name, build)
    read_material(material, ImageTable(), refusals)
    return [str(refusal) for refusal in refusals]


def bumped(tree, width):
    inputs = {"Height": node(tree, "TexGradient", output="Fac"), "Filter Width": width}
    return node(tree, "BsdfDiffuse", {"Normal": node(tree, "Bump", inputs)})


def colored(build):
    return lambda t: node(t, "BsdfDiffuse", {"Color": build(t)})


def textured(**settings):
    def build(tree):
        settings.setdefault("image", bpy.data.images.new("rug", 2, 2))
        return node(tree, "BsdfDiffuse", {"Color": node(tree, "TexImage", **settings)})

    return build


def principled(**inputs):
    return lambda t: node(t, "BsdfPrincipled", {name.replace("_", " "): value for name, value in inputs.items()})
