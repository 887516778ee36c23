# SPDX-License-Identifier: GPL-3.0-or-later
"""The exporter writes each probe's node tree as the material of its definition.

Both give the same light under a sun, for all angles.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.images import ImageTable
from etalon.tests.probes import cycles, reference
from etalon.tests.probes.definitions import BLUE, RED, SUNS, Probe, probes_of

RELEASE = bpy.app.version[:2]


def read(material):
    """The material as the exporter reads it."""
    refusals = []
    found = read_material(material, ImageTable(), refusals)
    assert not refusals
    return found


def assert_same(light, read_materials, defined):
    got, expected = reference.shown(light, read_materials), reference.shown(light, defined)
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-15)


# Of the default run: every twelfth probe of each light.
@pytest.mark.parametrize("step", [12, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("light", sorted({probe.light for probe in probes_of(RELEASE)} & set(SUNS)))
def test_probes_are_exported_as_they_are_defined(light, step):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    probes = [probe for probe in probes_of(RELEASE) if probe.light == light][::step]
    assert_same(light, [read(cycles.node_tree(p)) for p in probes], [reference.material(p, RELEASE) for p in probes])


def test_a_mix_of_two_nodes_weighs_their_lobes():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    coated = Probe("", "coated", "front", "BsdfPrincipled",
                   {"Base Color": BLUE, "Coat Weight": 0.5, "Coat Tint": RED, "Coat Roughness": 0.3}, "GGX")  # fmt: skip
    material = cycles.node_tree(coated)
    tree = material.node_tree
    principled = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    mix, diffuse = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    mix.inputs[0].default_value, diffuse.inputs["Color"].default_value = 0.3, RED
    tree.links.new(principled.outputs[0], mix.inputs[1])
    tree.links.new(diffuse.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    plain = Probe("", "diffuse", "front", "BsdfDiffuse", {"Color": RED})
    parts = [reference.material(probe, RELEASE) for probe in (coated, plain)]
    got = reference.shown("front", [read(material)])
    one, other = reference.shown("front", parts)
    np.testing.assert_allclose(got[0], 0.7 * one + 0.3 * other, rtol=1e-7)
