# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres of sigma = 0.01, 0.1, 0.3 and 0.5, Beckmann above, GGX below.

It is the illustration of the lecture on importance sampling. Eight spheres are lit by one of the HDRIs that Blender
ships. sigma is alpha; the node's roughness is its square root. No closed form: the expectation is Cycles' own,
measured.
"""

from __future__ import annotations

from pathlib import Path

import bpy

from ..lib.errors import EtalonError
from . import building
from .expectation import Expectation

WIDTH, HEIGHT = 512, 256
MAX_BOUNCES = 4
SIGMAS = (0.01, 0.1, 0.3, 0.5)
HDRI = "courtyard.exr"

EXPECTATIONS: tuple[Expectation, ...] = ()


def build() -> None:
    """Make this the open scene; raises EtalonError where this Blender has no HDRIs."""
    building.start("sigma_sweep", WIDTH, HEIGHT, MAX_BOUNCES)
    folder = bpy.utils.system_resource("DATAFILES", path="studiolights/world")
    path = Path(folder) / HDRI
    if not path.is_file():
        raise EtalonError(f"{HDRI}: this Blender comes without its HDRIs; use one from blender.org")
    tree = building.world((1.0, 1.0, 1.0)).node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(str(path))
    texture.location = (-350, 0)
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    for z, distribution in ((1.1, "BECKMANN"), (-1.1, "GGX")):
        for column, sigma in enumerate(SIGMAS):
            material = building.glossy(f"{distribution} {sigma}", distribution, sigma, (0.9, 0.9, 0.9))
            x = 2.2 * (column - 1.5)
            building.sphere(material.name, material, (x, 0.0, z), 1.0, 256, 129)
    building.camera((0.0, -21.0, 0.0), (0.0, 0.0, 0.0), lens=84.0)
