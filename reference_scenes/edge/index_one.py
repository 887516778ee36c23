# SPDX-License-Identifier: GPL-3.0-or-later
"""A slab of glass whose index is 1, or nearly 1, before a white world.

Nothing is reflected, and nothing is lost.
"""

from __future__ import annotations

from .. import building
from .edge_case import EdgeCase, look, start


def _build(index: float) -> None:
    start("index one", max_bounces=8)
    building.world((1.0, 1.0, 1.0))
    material = building.diffuse("Glass", (1.0, 1.0, 1.0))
    tree = material.node_tree
    shader = tree.nodes.new("ShaderNodeBsdfGlass")
    shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    shader.inputs["IOR"].default_value = index
    shader.inputs["Roughness"].default_value = 0.0
    output = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    building.box("Slab", material, (0.0, 0.0, 0.0), (2.0, 2.0, 0.2))
    look((0.0, 0.0, 0.0), (0.3, 0.2, 1.0), 4.0, 1.0)


CASES = (
    EdgeCase("index of refraction 1", lambda: _build(1.0), 1.0, 1e-6, 64, "nothing is reflected, nothing is lost"),
    EdgeCase("index of refraction 1 + 1e-6", lambda: _build(1.0 + 1e-6), 1.0, 1e-6, 64, "no light is lost"),
)
