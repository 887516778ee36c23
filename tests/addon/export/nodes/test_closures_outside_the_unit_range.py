# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures with a colour of -0.5, 0.6 and 1.4, as Cycles shows them.

The colour is constant and from a texture, and one sun lights them without noise. Beyond 0..1 there is no physics to go
by: what Cycles does with such a colour is its definition.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.job import export
from etalon.lib.departures.catalogue import relevant
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.reference_scenes import building
from etalon.tests.addon.export.nodes.node_cells import glowing, node

pytestmark = pytest.mark.compares_with_cycles

COLOR = (-0.5, 0.6, 1.4)
GREY = (0.5, 0.5, 0.5)
TILE = 4

# Material: node, distribution, inputs.
CASES = {
    "emission": ("Emission", None, {"Color": COLOR}),
    "emission of negative strength": ("Emission", None, {"Color": GREY, "Strength": -2.0}),
    "diffuse": ("BsdfDiffuse", None, {"Color": COLOR}),
    "rough diffuse": ("BsdfDiffuse", None, {"Color": COLOR, "Roughness": 0.7}),
    "too rough diffuse": ("BsdfDiffuse", None, {"Color": GREY, "Roughness": 1.7}),
    "translucent": ("BsdfTranslucent", None, {"Color": COLOR}),
    **{
        f"glossy {kind}": ("BsdfAnisotropic", kind, {"Color": COLOR, "Roughness": 0.7})
        for kind in ("GGX", "MULTI_GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY")
    },
    "glossy of negative roughness": ("BsdfAnisotropic", "GGX", {"Color": GREY, "Roughness": -0.7}),
    "glossy too rough": ("BsdfAnisotropic", "GGX", {"Color": GREY, "Roughness": 1.7}),
    **{f"glass {kind}": ("BsdfGlass", kind, {"Color": COLOR, "Roughness": 0.7}) for kind in ("GGX", "MULTI_GGX")},
    "refraction": ("BsdfRefraction", "GGX", {"Color": COLOR, "Roughness": 0.7}),
    "metallic": ("BsdfMetallic", "MULTI_GGX", {"Base Color": COLOR, "Edge Tint": COLOR, "Roughness": 0.7}),
    "principled": ("BsdfPrincipled", "GGX", {"Base Color": COLOR, "Roughness": 0.7}),
    "principled metal": ("BsdfPrincipled", "MULTI_GGX", {"Base Color": COLOR, "Metallic": 1.0, "Roughness": 0.7}),
    "principled too metallic": ("BsdfPrincipled", "GGX", {"Base Color": GREY, "Metallic": 1.5, "Roughness": 0.7}),
    "principled too opaque": ("BsdfPrincipled", "GGX", {"Base Color": GREY, "Alpha": 1.5, "Roughness": 0.7}),
    "principled glow": ("BsdfPrincipled", "GGX", {"Emission Color": COLOR, "Emission Strength": 1.0, "Roughness": 0.7}),
    "principled dark glow": (
        "BsdfPrincipled",
        "GGX",
        {"Emission Color": GREY, "Emission Strength": -1.0, "Roughness": 0.7},
    ),
    "principled tint": ("BsdfPrincipled", "GGX", {"Specular Tint": COLOR, "Roughness": 0.7}),
}
COAT = {"Coat Tint": COLOR, "Coat Weight": 0.8, "Base Color": GREY, "Roughness": 0.7}
# Sockets that are read as constants only.
CONSTANT_ONLY = {"principled coat": ("BsdfPrincipled", "MULTI_GGX", COAT)}
FORMS = {f"{name}, constant": (case, False) for name, case in {**CASES, **CONSTANT_ONLY}.items()} | {
    f"{name}, textured": (case, True) for name, case in CASES.items()
}


def content(tree, value):
    """The value or colour as a texture gives it.

    No renderer knows it before it is at the point.
    """
    numbers = value if isinstance(value, tuple) else (value,) * 3
    uv = node(tree, "TexCoord", output="UV")
    return node(
        tree,
        "VectorMath",
        {"Vector": uv, "Vector_001": (1e-12,) * 3, "Vector_002": numbers},
        operation="MULTIPLY_ADD",
    )


def shaded(kind, distribution, inputs, textured):
    def build(tree):
        made = node(tree, kind).node
        if distribution:
            made.distribution = distribution
        for name, value in inputs.items():
            if textured:
                tree.links.new(content(tree, value), made.inputs[name])
            else:
                made.inputs[name].default_value = (*value, 1.0) if isinstance(value, tuple) else value
        return made.outputs[0]

    return build


@pytest.fixture(scope="module", params=["front", "behind"])
def shown(request):
    """Form -> what Cycles and the reference show (3,), under a sun on one side of all faces."""
    side = int(np.ceil(np.sqrt(len(FORMS))))
    scene = building.start("closures", side * TILE, side * TILE, 0)
    for k, (name, (case, textured)) in enumerate(FORMS.items()):
        x, y = float(k % side), float(k // side)
        corners = np.array([(x, y, 0), (x + 1, y, 0), (x + 1, y + 1, 0), (x, y + 1, 0)])
        thing = building.mesh(name, corners, np.array([[0, 1, 2, 3]]), [glowing(name, shaded(*case, textured))])
        (thing or bpy.data.objects[name]).data.uv_layers.new(name="UVMap")
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle = np.pi, 0.0
    sun.rotation_euler = (0.0, 0.4 if request.param == "front" else np.pi - 0.4, 0.0)
    scene.collection.objects.link(sun)
    building.camera((side / 2, side / 2, 50.0), (side / 2, side / 2, 0.0), ortho_scale=side)
    exported = export(scene)
    departures = frozenset(departure.name for departure in relevant(exported))
    with neutral(scene, threads=2):
        cycles = CyclesRenderer(scene, threads=2).render(0, 1).radiance
    reference = ReferenceRenderer(exported, Options(threads=2, departures=departures)).render(0, 1).radiance
    found = {}
    for k, name in enumerate(FORMS):
        row, column = (side - 1 - k // side) * TILE, k % side * TILE
        inner = slice(row + 1, row + TILE - 1), slice(column + 1, column + TILE - 1)
        found[name] = [image[inner].mean(axis=(0, 1)) for image in (cycles, reference)]
    return found


@pytest.mark.parametrize("name", FORMS)
def test_closure_takes_colours_outside_the_unit_range_as_cycles_does(shown, name):
    cycles, reference = shown[name]
    if name.startswith(("glass", "refraction", "translucent")) and cycles[1] > 0.0:
        # Cycles' samples of what passes the face differ in size, but not in colour.
        cycles, reference = (image / image[1] for image in (cycles, reference))
    np.testing.assert_allclose(reference, cycles, rtol=5e-4, atol=5e-5)
