# SPDX-License-Identifier: GPL-3.0-or-later
"""Subsurface scattering as Cycles has it, method by method.

The scene is a body in a white world beside a lamp.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.job import export
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.subsurface import SHORT_WALKS
from etalon.reference_scenes import building
from etalon.tests.chi2 import sidak
from scipy.stats import t

pytestmark = pytest.mark.compares_with_cycles

SIZE, REPLICATES, SAMPLES = 8, 6, 128
NEW = bpy.app.version >= (5, 2)
METHODS = ["RANDOM_WALK", "RANDOM_WALK_SKIN", *(["RANDOM_WALK_LEGACY"] if NEW else [])]


def scattering(method, anisotropy=0.0, radius=(0.3, 0.15, 0.06), color=(0.8, 0.5, 0.3)):
    """A Subsurface Scattering node."""

    def build(tree):
        node = tree.nodes.new("ShaderNodeSubsurfaceScattering")
        node.falloff = method
        values = {"Color": (*color, 1.0), "Radius": radius, "Scale": 1.0, "Anisotropy": anisotropy, "Roughness": 0.6}
        return filled(node, values)

    return build


def principled(method, **values):
    """A Principled BSDF, whose surface reflects too."""

    def build(tree):
        node = tree.nodes.new("ShaderNodeBsdfPrincipled")
        node.subsurface_method = method
        more = {"Subsurface Radius": (1.0, 0.5, 0.2), "Subsurface Scale": 0.2, "Roughness": 0.4}
        return filled(node, {"Base Color": (0.8, 0.4, 0.2, 1.0), "Subsurface Weight": 0.6, **more, **values})

    return build


def filled(node, values):
    for socket in node.inputs:
        if socket.identifier in values:
            socket.default_value = values[socket.identifier]
    return node.outputs[0]


CASES = {
    **{f"node, {method}": scattering(method) for method in METHODS},
    **{f"node, {method}, forward": scattering(method, 0.5) for method in METHODS},
    "node, without a radius of red": scattering("RANDOM_WALK", radius=(0.0, 0.15, 0.06)),
    "node, dark": scattering("RANDOM_WALK", color=(0.03, 0.01, 0.5), radius=(0.5, 0.5, 0.5)),
    "node, bright": scattering("RANDOM_WALK", color=(0.99, 0.9, 0.95)),
    **{f"Principled, {method}": principled(method) for method in METHODS},
    "Principled, all below": principled("RANDOM_WALK", **{"Subsurface Weight": 1.0, "Specular IOR Level": 0.3}),
    **({"node, backward": scattering("RANDOM_WALK", -0.5)} if NEW else {}),
}


def body(build):
    """A box, seen from above, that nothing else lights or is lit by."""
    scene = building.start("body", SIZE, SIZE, 2)
    material = building.diffuse("wax", (0.5, 0.5, 0.5))
    tree = material.node_tree
    out = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(build(tree), out.inputs["Surface"])
    building.box("Body", material, (0.0, 0.0, 0.0), (1.6, 1.2, 0.8))
    building.world((1.0, 1.0, 1.0))
    building.area_light("Lamp", (1.5, -1.0, 2.0), (0.0, 0.0, 0.0), (1.0, 1.0), (5.0, 4.0, 3.0))
    building.camera((0.3, -0.8, 3.0), (0.0, 0.0, 0.0), ortho_scale=1.0)
    return scene


@pytest.mark.slow
@pytest.mark.parametrize("name", list(CASES))
def test_the_reference_shows_what_cycles_shows(name, seed):
    """The mean of the image, each channel by a t test of all three together.

    Errors are below 1.2 % of the light.
    """
    scene = body(CASES[name])
    reference = ReferenceRenderer(export(scene), Options(seed=seed, threads=1, departures=frozenset({SHORT_WALKS})))
    cycles = CyclesRenderer(scene, seed=seed, threads=1)
    mine = np.array([reference.render(k, SAMPLES).radiance.mean(axis=(0, 1)) for k in range(REPLICATES)])
    with neutral(scene, threads=1):
        theirs = np.array([cycles.render(k, SAMPLES).radiance.mean(axis=(0, 1)) for k in range(REPLICATES)])
    gap = np.abs(mine.mean(axis=0) - theirs.mean(axis=0))
    error = np.sqrt((mine.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / REPLICATES)
    assert (gap < t.ppf(1.0 - 0.5 * sidak(1e-3, 3), REPLICATES) * error).all()
    assert (error < 0.012 * mine.mean()).all()
