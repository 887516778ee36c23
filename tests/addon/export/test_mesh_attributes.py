# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes: each type on each domain is read as Cycles reads it, or refused by name.

None becomes 0.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.export.mesh_attributes import _NO_AVERAGE, _STORED
from etalon.addon.export.nodes.textures import _CYCLES_NAMES, _VOLUME_NAMES, _VOLUME_NAMES_TAKEN
from etalon.lib.errors import Refused

KINDS = [item.identifier for item in bpy.types.Attribute.bl_rna.properties["data_type"].enum_items]
DOMAINS = ("POINT", "EDGE", "FACE", "CORNER")
CHANNELS = {"Color": slice(0, 3), "Fac": slice(4, 5), "Alpha": slice(3, 4)}
REFUSED = {"FLOAT4X4", "STRING", "INT16_2D", "INT32_2D"}
"""Cycles shows 0 for these types, as if there were no attribute."""


# Cycles 5.2, and no other, decodes bytes of corners 2.4e-4 off the sRGB curve; 4.5 and 5.3 follow it to 1e-6.
DECODED = 3e-4 if bpy.app.version[:2] == (5, 2) else 2e-6


def reads(kind, domain):
    return kind not in REFUSED and not (domain == "EDGE" and kind in _NO_AVERAGE)


def store(mesh, kind, domain, name="warmth"):
    """An attribute with another value everywhere; halves among the means of whole numbers."""
    attribute = mesh.attributes.new(name, kind, domain)
    if kind in _STORED:
        field, width, dtype = _STORED[kind]
        size = len(attribute.data) * width
        values = np.arange(1, size + 1, dtype=np.float64)
        values = values % 3 == 0 if kind == "BOOLEAN" else values if dtype == np.int32 else values / (size + 1)
        attribute.data.foreach_set(field, values.astype(dtype))


def asking(studio, output, name="warmth", node="ShaderNodeAttribute", field="attribute_name"):
    material = studio.probe_material(node, output)
    setattr(next(n for n in material.node_tree.nodes if n.bl_idname == node), field, name)
    return material


def test_every_type_is_read_or_refused():
    assert set(KINDS) <= set(_STORED) | REFUSED


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in REFUSED])
def test_a_type_is_read_as_cycles_reads_it(studio, rays, hits, kind):
    cells = [(domain, output) for domain in DOMAINS if reads(kind, domain) for output in CHANNELS]
    materials = {output: asking(studio, output) for output in CHANNELS}
    for k, (domain, output) in enumerate(cells):
        corners = [(k, 0, 0), (k + 1, 0, 0), (k + 1, 1, 0), (k, 1, 0)]
        quad = studio.add("quad", studio.mesh("quad", corners, [(0, 1, 2, 3)]))
        store(quad.data, kind, domain)
        quad.data.materials[0] = materials[output]
    studio.look_down(len(cells))
    studio.camera.location[:2] = len(cells) / 2, 0.5
    studio.scene.render.resolution_x, studio.scene.render.resolution_y = 4 * len(cells), 4
    shown, scene = studio.cycles(), studio.export()
    triangle, weights, _ = hits(scene.mesh, *rays(scene.camera))
    values = np.einsum("chw,cvhw->vhw", weights, scene.mesh.attributes["warmth"][:, :, triangle])
    for k, (domain, output) in enumerate(cells):
        cell = np.s_[:, 4 * k : 4 * k + 4]
        expected = np.broadcast_to(values[CHANNELS[output]][(slice(None), *cell)], (3, 4, 4)).transpose(1, 2, 0)
        close = DECODED if (kind, domain) == ("BYTE_COLOR", "CORNER") else 2e-6
        np.testing.assert_allclose(shown[cell], expected, rtol=close, err_msg=f"{domain}, {output}")


@pytest.mark.parametrize(("kind", "domain"), [(k, d) for k in KINDS for d in DOMAINS if not reads(k, d)])
def test_a_type_or_domain_that_is_not_read_is_refused_by_name(studio, kind, domain):
    quad = studio.quad()
    store(quad.data, kind, domain)
    quad.data.materials[0] = asking(studio, "Color")
    text = kind.replace("_", " ").lower()
    with pytest.raises(Refused, match=rf"mesh 'quad': attribute 'warmth' of type {text} on domain {domain.lower()}"):
        studio.export()


@pytest.mark.parametrize("name", [*_CYCLES_NAMES, *_VOLUME_NAMES])
def test_a_name_that_cycles_keeps_for_itself_is_refused(studio, name):
    quad = studio.quad()
    for output in CHANNELS:
        quad.data.materials[0] = asking(studio, output, name)
        if name in _VOLUME_NAMES and bpy.app.version not in _VOLUME_NAMES_TAKEN:
            studio.export()
            continue
        with pytest.raises(Refused, match=f"name '{name}', which Cycles keeps for itself, is not simulated"):
            studio.export()


def test_a_name_that_cycles_keeps_for_itself_is_refused_in_a_color_attribute_node(studio):
    studio.quad().data.materials[0] = asking(studio, "Color", "N", "ShaderNodeVertexColor", "layer_name")
    with pytest.raises(Refused, match="name 'N', which Cycles keeps for itself"):
        studio.export()


def test_the_tangents_of_a_uv_map_are_refused(studio):
    quad = studio.quad()
    quad.data.uv_layers.new(name="map")
    quad.data.materials[0] = asking(studio, "Vector", "map.tangent")
    with pytest.raises(Refused, match=r"attribute 'map\.tangent', which Cycles makes itself"):
        studio.export()


@pytest.mark.parametrize("kind", ["OBJECT", "INSTANCER", "VIEW_LAYER"])
def test_attributes_that_are_not_of_the_geometry_are_refused(studio, kind):
    material = asking(studio, "Color")
    next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeAttribute").attribute_type = kind
    studio.quad().data.materials[0] = material
    with pytest.raises(Refused, match=f"type {kind.replace('_', ' ').title()}, is not simulated"):
        studio.export()


def test_a_partial_comparison_leaves_out_the_material_that_reads_it(studio):
    hot, cold = studio.quad("hot"), studio.quad("cold", z=1.0)
    for quad in (hot, cold):
        store(quad.data, "FLOAT4X4", "POINT")
    hot.data.materials[0] = asking(studio, "Color")
    scene = studio.export(partial=True)
    reasons = {material.name: material.unknown for material in scene.materials}
    assert reasons["plain"] == ""
    assert "attribute 'warmth' of type float4x4" in next(text for name, text in reasons.items() if name != "plain")


def test_an_attribute_that_no_material_of_the_mesh_reads_is_no_reason_to_refuse(studio):
    hot, cold = studio.quad("hot"), studio.quad("cold", z=1.0)
    store(hot.data, "FLOAT", "POINT")
    store(cold.data, "FLOAT4X4", "POINT")
    hot.data.materials[0] = asking(studio, "Color")
    studio.export()
