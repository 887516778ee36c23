# SPDX-License-Identifier: GPL-3.0-or-later
"""A Lambert plane under an HDRI that is black except for one texel of 1e6, or all black.

The irradiance is the integral of the bilinear hat about the texel, u = 1/2 - phi / 2 pi, v = theta / pi, against the
cosine, by the product of Gauss-Legendre rules on its four quarters.
"""

from __future__ import annotations

import math

import bpy
import numpy as np

from .. import building
from .edge_case import EdgeCase, look, start

ALBEDO, TEXEL = 0.5, 1e6
WIDTH, HEIGHT, COLUMN, ROW = 64, 32, 20, 9


def _irradiance() -> float:
    """Integral of TEXEL (1 - |du|) (1 - |dv|) cos(theta) sin(theta).

    It covers one texel to each side; theta is from the zenith.
    """
    node, weight = np.polynomial.legendre.leggauss(32)
    middle = math.pi * (ROW + 0.5) / HEIGHT
    total = 0.0
    for side in (-1.0, 1.0):
        part = 0.5 * (node + 1.0)
        theta = middle + side * part * math.pi / HEIGHT
        total += (0.5 * weight * (1.0 - part) * np.cos(theta) * np.sin(theta)).sum() * math.pi / HEIGHT
    return TEXEL * total * 2.0 * math.pi / WIDTH


def _build(name: str, texel: float) -> None:
    start(name)
    image = bpy.data.images.new(name, WIDTH, HEIGHT, float_buffer=True, is_data=False)
    pixels = np.zeros((HEIGHT, WIDTH, 4), np.float32)
    pixels[..., 3] = 1.0
    pixels[HEIGHT - 1 - ROW, COLUMN, :3] = texel
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    tree = building.world((0.0, 0.0, 0.0)).node_tree
    background = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBackground")
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    building.rectangle(
        "Plane", building.diffuse("White", (ALBEDO,) * 3), (0.0, 0.0, 0.0), (9.0, 0.0, 0.0), (0.0, 9.0, 0.0)
    )
    look((0.0, 0.0, 0.0), (0.1, 0.2, 1.0), 4.0, 2.0)


CASES = (
    EdgeCase(
        "an HDRI with one texel of 1e6",
        lambda: _build("hot texel", TEXEL),
        ALBEDO / math.pi * _irradiance(),
        2e-3,
        256,
        "albedo / pi x irradiance by quadrature",
    ),
    EdgeCase("a black HDRI", lambda: _build("black", 0.0), 0.0, 0.0, 16, "no light"),
)
