# SPDX-License-Identifier: GPL-3.0-or-later
"""The check that nothing of a node is ignored.

Each input, property and enum value of this Blender is declared, and what is not is refused.
"""

from dataclasses import replace

import bpy
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes import tree as tree_module
from etalon.addon.export.nodes.declarations import DECLARATIONS
from etalon.addon.export.nodes.declared import own_properties, remember_defaults, unknown_properties
from etalon.addon.export.nodes.images import ImageTable
from etalon.addon.export.nodes.shaders import _COMBINERS, _SURFACE_SHADERS, _WORLD_SHADERS
from etalon.addon.export.nodes.values import VALUES
from etalon.addon.export.nodes.volumes import VOLUME_SHADERS
from etalon.tests.addon.export.nodes.node_cells import glowing, node

BESIDE = {
    "ShaderNodeDisplacement",
    "ShaderNodeVectorDisplacement",
    "ShaderNodeTangent",
    "ShaderNodeOutputMaterial",
    "ShaderNodeOutputWorld",
    "ShaderNodeOutputLight",
}
HERE = sorted(
    kind for kind, row in DECLARATIONS.items() if bpy.app.version in row.versions and hasattr(bpy.types, kind)
)
# Contents with which every input that is read has an effect.
AWAKE = {
    "Roughness": 0.3,
    "Anisotropy": 0.4,
    "Anisotropic": 0.4,
    "Alpha": 0.9,
    "Metallic": 0.3,
    "Transmission Weight": 0.3,
    "Transmission Dispersion Scale": 0.4,
    "Coat Weight": 0.5,
    "Sheen Weight": 0.4,
    "Subsurface Weight": 0.4,
    **({"Thin Film Thickness": 300.0} if bpy.app.version >= (5, 0, 0) else {}),
    "Coat Tint": (0.5, 0.6, 0.7, 1.0),
    "Emission Strength": 1.0,
}
SHADERS = sorted(kind for kind in _SURFACE_SHADERS if (kind in HERE and "Bsdf" in kind) or kind == "ShaderNodeEmission")


@pytest.fixture(scope="module")
def _factory_settings():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


@pytest.fixture(autouse=True)
def _empty_file(_factory_settings):
    """Nothing of the test before: to read the settings for each takes longer than the tests."""
    for kind in ("materials", "node_groups", "images", "worlds", "lights"):
        bpy.data.batch_remove(list(getattr(bpy.data, kind)))


def fresh(kind):
    return bpy.data.node_groups.new("fresh", "ShaderNodeTree").nodes.new(kind)


def export(kind, change=lambda node, tree: None, awake=True, **properties):
    """The lobes of a material of one shader node after `change`, and the refusals."""

    def build(tree):
        socket = node(tree, kind.removeprefix("ShaderNode"), **properties)
        for one in socket.node.inputs:
            if awake and one.identifier in AWAKE and not is_neutral(kind, one.identifier):
                one.default_value = AWAKE[one.identifier]
        change(socket.node, tree)
        return socket

    material, refusals = glowing("Gold", build), []
    remember_defaults(DECLARATIONS)
    lobes = read_material(material, ImageTable(), refusals).lobes
    return lobes, [str(refusal) for refusal in refusals]


def is_neutral(kind, name):
    return name in DECLARATIONS[kind].neutral


def changed(socket):
    """Another value of the socket, within its range; None where it can only be linked."""
    if not hasattr(socket, "default_value") or socket.hide_value:
        return None
    value = socket.default_value
    if socket.type == "BOOLEAN":
        return not value
    if socket.type in ("RGBA", "VECTOR"):
        return [0.25 + 0.5 * part for part in value]
    limits = socket.bl_rna.properties["default_value"]
    return value + 0.11 if value + 0.11 <= limits.soft_max else value - 0.11


def test_every_reader_has_a_row_and_every_row_a_reader():
    shaders = {*_SURFACE_SHADERS, *_WORLD_SHADERS, *VOLUME_SHADERS, *_COMBINERS}
    assert set(DECLARATIONS) == set(VALUES) | shaders | BESIDE


@pytest.mark.parametrize("kind", sorted(DECLARATIONS))
def test_the_node_type_exists_in_the_releases_of_its_row(kind):
    try:
        fresh(kind)
        exists = True
    except RuntimeError:
        exists = False
    assert exists == (bpy.app.version in DECLARATIONS[kind].versions)


@pytest.mark.parametrize("kind", HERE)
def test_every_input_and_property_of_this_blender_is_declared(kind):
    row = DECLARATIONS[kind]
    assert [s.identifier for s in fresh(kind).inputs if s.identifier not in row.sockets] == []
    assert unknown_properties(kind, row) == ()


@pytest.mark.parametrize("kind", HERE)
def test_every_enum_value_of_this_blender_is_declared(kind):
    properties = getattr(bpy.types, kind).bl_rna.properties
    known = DECLARATIONS[kind].properties
    new = {
        (name, item.identifier)
        for name in own_properties(kind)
        if known.get(name) is not None
        for item in properties[name].enum_items
        if item.identifier not in known[name]
    }
    assert new == set()


@pytest.mark.parametrize("kind", SHADERS)
def test_a_changed_input_of_a_shader_changes_the_export_or_is_idle(kind):
    """Idle inputs are those of layers that are refused while they are on."""
    variants = [{}]
    if kind == "ShaderNodeBsdfMetallic":
        variants = [{"fresnel_type": "F82"}, {"fresnel_type": "PHYSICAL_CONDUCTOR"}]
    silent = []
    for properties in variants:
        before = export(kind, **properties)
        assert before[1] == []
        probe = fresh(kind)
        for name, value in properties.items():
            setattr(probe, name, value)
        for socket in [s for s in probe.inputs if s.enabled]:
            name, value = socket.identifier, changed(socket)

            def change(node, tree, name=name, value=value):
                target = next(s for s in node.inputs if s.identifier == name)
                if value is not None:
                    target.default_value = (
                        target.default_value + 0.1 if name in AWAKE and target.type == "VALUE" else value
                    )
                elif "Tangent" in name:
                    turned = tree.nodes.new("ShaderNodeTangent")
                    turned.axis = "X"
                    tree.links.new(turned.outputs[0], target)
                else:
                    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Incoming"], target)

            if export(kind, change, **properties) == before:
                silent.append(name)
    refused = set() if bpy.app.version >= (5, 0, 0) else {"Thin Film IOR"}  # where a film is refused by its thickness
    assert set(silent) <= set(DECLARATIONS[kind].idle) | refused


@pytest.mark.parametrize("name", ["Anisotropy", "Transmission Dispersion Scale", "Thin Film Thickness", "Thin Wall"])
def test_inputs_new_in_some_release_are_read_or_refused(name):
    kinds = [kind for kind in SHADERS if any(s.identifier == name and s.enabled for s in fresh(kind).inputs)]
    for kind in kinds:

        def change(node, tree):
            socket = next(s for s in node.inputs if s.identifier == name)
            socket.default_value = True if socket.type == "BOOLEAN" else 0.5

        assert export(kind, change) != export(kind)


def without(monkeypatch, kind, **fields):
    """Plant a Blender that is newer than the row of `kind`.

    The row loses what `fields` leave out.
    """
    rows = {**DECLARATIONS, kind: replace(DECLARATIONS[kind], **fields)}
    monkeypatch.setattr(tree_module, "DECLARATIONS", rows)
    monkeypatch.setitem(DECLARATIONS, kind, rows[kind])


def test_an_undeclared_input_is_refused_where_it_is_not_as_blender_makes_it(monkeypatch):
    kind = "ShaderNodeBsdfGlossy" if bpy.app.version < (4, 0) else "ShaderNodeBsdfAnisotropic"
    kind = fresh(kind).bl_idname
    reads = tuple(name for name in DECLARATIONS[kind].reads if name != "Roughness")
    without(monkeypatch, kind, reads=reads)
    assert export(kind, awake=False)[1] == []
    (refusal,) = export(kind)[1]
    assert "node 'Glossy BSDF' (Glossy BSDF), socket 'Roughness', is not simulated; set it back to 0.5" in refusal


def test_an_undeclared_input_is_refused_where_it_is_linked(monkeypatch):
    reads = tuple(name for name in DECLARATIONS["ShaderNodeBsdfDiffuse"].reads if name != "Roughness")
    without(monkeypatch, "ShaderNodeBsdfDiffuse", reads=reads)

    def link(node, tree):
        tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], node.inputs["Roughness"])

    (refusal,) = export("ShaderNodeBsdfDiffuse", link, awake=False)[1]
    assert "socket 'Roughness' (linked), is not simulated; unlink Roughness" in refusal


def test_an_undeclared_property_is_refused_where_it_is_not_as_blender_makes_it(monkeypatch):
    without(monkeypatch, "ShaderNodeBsdfTranslucent")
    without(monkeypatch, "ShaderNodeBsdfMetallic", properties={"distribution": None})
    assert export("ShaderNodeBsdfMetallic")[1] == []
    (refusal,) = export("ShaderNodeBsdfMetallic", fresnel_type="PHYSICAL_CONDUCTOR")[1]
    assert "property 'fresnel_type', is not simulated; set it back to F82" in refusal


def test_an_undeclared_enum_value_is_refused_by_name(monkeypatch):
    without(monkeypatch, "ShaderNodeBsdfRefraction", properties={"distribution": ("GGX",)})
    (refusal,) = export("ShaderNodeBsdfRefraction", distribution="BECKMANN")[1]
    assert "Distribution Beckmann, is not simulated; choose another Distribution" in refusal


def test_defaults_are_learnt_without_a_trace_in_the_file(monkeypatch):
    without(monkeypatch, "ShaderNodeBsdfTransparent", reads=())
    glowing("Gold", lambda tree: node(tree, "BsdfTransparent"))
    before = [one.name for one in bpy.data.user_map()]
    remember_defaults(DECLARATIONS)
    assert [one.name for one in bpy.data.user_map()] == before
