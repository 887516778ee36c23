# SPDX-License-Identifier: GPL-3.0-or-later
"""Christensen and Burley's subsurface scattering beside Cycles', block by block."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from etalon.lib.scattering.subsurface import BY_DISK
from etalon.lib.scene.materials import Diffuse, Subsurface
from etalon.tests.addon.export.test_visibility import FEW_SAMPLES, apart, below_a_sky, shader, square
from mathutils import Euler, Matrix

pytestmark = pytest.mark.compares_with_cycles


def wax(studio, kind="SubsurfaceScattering", scale=1.0, **values):
    """A box of wax on a floor, below a sky and a lamp near it."""
    square(
        studio, "floor", shader("grey", "BsdfDiffuse", Color=(0.5, 0.5, 0.5, 1)), 5.0, Matrix.Translation((0, 0, -1.2))
    )
    if kind == "SubsurfaceScattering":
        values = {"Color": (0.8, 0.5, 0.3, 1), "Radius": (6.0, 3.0, 1.0), "Scale": scale, **values}
    material = shader("wax", kind, **values)
    (node,) = (one for one in material.node_tree.nodes if one.bl_idname == f"ShaderNode{kind}")
    setattr(node, "falloff" if kind == "SubsurfaceScattering" else "subsurface_method", "BURLEY")
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    thing = bpy.context.object
    thing.name = "box"
    thing.data.materials.append(material)
    thing.matrix_world = Matrix.LocRotScale((0.0, 0.0, 0.2), Euler((0.0, 0.0, 0.5)), (1.3, 0.9, 1.1))
    lamp = studio.add("lamp", bpy.data.lights.new("lamp", "AREA"), Matrix.Translation((1.6, -1.2, 2.2)))
    lamp.data.energy, lamp.data.size = 60.0, 0.3
    below_a_sky(studio, bounces=3)
    return thing, node


def smooth(studio):
    thing, _ = wax(studio)
    thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))


def thin(studio):
    """A slab that light gets through."""
    thing, _ = wax(studio)
    thing.matrix_world = Matrix.LocRotScale((0.0, 0.3, 0.2), Euler((0.3, 0.0, 0.2)), (1.3, 0.1, 1.1))


def beside_a_mirror(studio):
    """Seen after a reflection, and after a diffuse one, where the surface is diffuse."""
    wax(studio)
    upright = Euler((np.pi / 2, 0, 0)).to_matrix().to_4x4()
    square(studio, "wall", shader("wall", "BsdfGlossy", Roughness=0.0), 4.0, Matrix.Translation((0, 2.4, 2)), upright)


def bumped(studio):
    thing, node = wax(studio)
    tree = thing.data.materials[0].node_tree
    mapped = tree.nodes.new("ShaderNodeNormalMap")
    mapped.space, mapped.inputs["Color"].default_value = "OBJECT", (0.7, 0.6, 0.9, 1.0)
    mapped.inputs["Strength"].default_value = 0.5
    tree.links.new(mapped.outputs[0], node.inputs["Normal"])


def principled(studio):
    more = {"Subsurface Radius": (1.0, 0.5, 0.2), "Subsurface Scale": 5.0, "Roughness": 0.4}
    wax(studio, "BsdfPrincipled", **{"Base Color": (0.8, 0.4, 0.2, 1.0), "Subsurface Weight": 0.6, **more})


CASES = {
    "node": wax,
    "wide": lambda studio: wax(studio, scale=4.0),
    "a channel without a radius": lambda studio: wax(studio, Radius=(6.0, 0.0, 1.0)),
    "smooth": smooth,
    "thin": thin,
    "beside a mirror": beside_a_mirror,
    "below a normal map": bumped,
    "Principled": principled,
}


def blind(scene):
    """The scene with Lambert's lobes in place of subsurface scattering."""

    def lobe(one):
        closure = one.closure
        return (
            replace(one, closure=Diffuse(closure.color, normal=closure.normal))
            if isinstance(closure, Subsurface)
            else one
        )

    return replace(scene, materials=tuple(replace(m, lobes=tuple(map(lobe, m.lobes))) for m in scene.materials))


@pytest.mark.slow
@pytest.mark.parametrize("make", CASES.values(), ids=CASES)
def test_light_leaves_by_disks_as_in_cycles(studio, make):
    """And the comparison notices light that leaves where it enters."""
    make(studio)
    aware = studio.export()
    found = apart(studio, aware, blind(aware), samples=FEW_SAMPLES)
    assert found[0] < 1.5
    assert found[1] > 5.0


def test_the_method_is_read(studio):
    _, node = wax(studio)
    node.inputs["Radius"].default_value = (1.0, 0.5, 0.25)
    (material,) = (one for one in studio.export().materials if one.name == "wax")
    first, second = (lobe.closure for lobe in material.lobes)
    assert isinstance(first, Subsurface)
    assert first.mapping == BY_DISK
    assert isinstance(second, Diffuse)
