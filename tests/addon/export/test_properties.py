# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of this Blender.

Each stands in a table, or is refused when it is not at its default.
"""

import warnings
from fnmatch import filter as matching

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.neutral import neutral
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.export.properties import declared as properties
from etalon.lib.errors import Refused

REFUSED = {
    "world.cycles": {"use_shadows"},
    "mesh": {"texco_mesh", "texture_mesh"},
    "image": {"use_multiview", "use_deinterlace", "views_format"},
}
"""Properties that stand in no table on purpose: another value than the default is refused."""
# Values that the tables leave out on purpose.
REFUSED_VALUES = {"working_space"}
# Reasons that promise the same image under other values of the property alone; the others speak of what Blender evaluates, of
# noise, or of settings that are derived from each other.
FREE = ("goes into", "is in what", "steers noise", "is in the pixels", "steers simulations")
GROUPS = sorted(properties.GROUPS)


def owners(studio):
    """Group -> the structs of that kind in a scene that has one of each."""
    quad, world = studio.quad(), bpy.data.worlds.new("world")
    quad.data.materials[0] = shining = studio.probe_material("ShaderNodeTexImage", "Color", 0.1)
    image = bpy.data.images.new("image", 4, 4)
    image.pixels.foreach_set(np.linspace(0.1, 1.0, 64).astype(np.float32))
    texture = next(node for node in shining.node_tree.nodes if node.bl_idname == "ShaderNodeTexImage")
    texture.image, image.alpha_mode = image, "NONE"
    diffuse = shining.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    both = shining.node_tree.nodes.new("ShaderNodeAddShader")
    (out,) = (node for node in shining.node_tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    for k, socket in enumerate((out.inputs["Surface"].links[0].from_socket, diffuse.outputs[0])):
        shining.node_tree.links.new(socket, both.inputs[k])
    shining.node_tree.links.new(both.outputs[0], out.inputs["Surface"])
    studio.scene.world = world
    kinds = ("POINT", "SUN", "SPOT", "AREA")
    lamps = [studio.add(kind, bpy.data.lights.new(kind, kind)) for kind in kinds]
    for k, lamp in enumerate(lamps):
        lamp.location, lamp.data.energy = (0.3 * k, 0.2, 2.0), 5.0
    studio.look_down(1.5)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 8
    studio.scene.collection.children.link(bpy.data.collections.new("inside"))
    camera = studio.camera.data
    found = {
        "scene": [studio.scene],
        "render": [studio.scene.render],
        "cycles": [studio.scene.cycles],
        "view_layer": [studio.layer],
        "view_layer.cycles": [studio.layer.cycles],
        "layer_collection": [studio.layer.layer_collection.children["inside"]],
        "object": [quad],
        "object.cycles": [quad.cycles],
        "mesh": [quad.data],
        "light": [lamp.data for lamp in lamps],
        "light.cycles": [lamps[0].data.cycles],
        "camera": [camera],
        "camera.dof": [camera.dof],
        "world": [world],
        "world.cycles": [world.cycles],
        "world.cycles_visibility": [world.cycles_visibility],
        "material": [shining],
        "material.cycles": [shining.cycles],
        "image": [image],
    }
    if hasattr(bpy.data, "colorspace"):
        found["colorspace"] = [bpy.data.colorspace]
    return found


@pytest.fixture
def there(studio):
    return owners(studio)


def names_of(structs):
    return {one.identifier for struct in structs for one in struct.bl_rna.properties}


def test_every_group_is_tried_here(there):
    assert set(GROUPS) - set(there) <= {"colorspace"}


@pytest.mark.parametrize("group", GROUPS)
def test_every_property_of_this_blender_stands_in_a_table_or_is_refused(there, group):
    new = {name for struct in there.get(group, ()) for name in properties.undeclared(group, struct)}
    assert new == (REFUSED.get(group, set()) & names_of(there.get(group, ())))


@pytest.mark.parametrize("group", GROUPS)
def test_the_releases_of_a_row_are_those_that_have_the_property(there, group):
    known, have = properties.GROUPS[group], names_of(there.get(group, ()))
    if group not in there:
        pytest.skip("this release of Blender has no such struct")
    wrong = [name for name in known.names if bool(matching(have, name)) != (bpy.app.version in known.releases_of(name))]
    assert wrong == []


@pytest.mark.parametrize("group", GROUPS)
def test_every_enum_value_of_this_blender_is_declared(there, group):
    new = {
        (name, item.identifier)
        for struct in there.get(group, ())
        for name, values in properties.GROUPS[group].values.items()
        if name in struct.bl_rna.properties and name not in REFUSED_VALUES
        for item in struct.bl_rna.properties[name].enum_items
        if item.identifier not in values.split()
    }
    assert new == set()


@pytest.mark.parametrize("group", GROUPS)
def test_no_property_is_in_two_tables(there, group):
    known = properties.GROUPS[group]
    names = names_of(there.get(group, ()))
    twice = [name for name in names if sum(bool(matching([name], one)) for one in known.names) > 1]
    assert twice == []


def change(struct, name):
    """Give a property another value; whether that was possible."""
    kind = struct.bl_rna.properties[name]
    if kind.is_readonly or kind.type in ("POINTER", "COLLECTION", "STRING"):
        return False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        value = getattr(struct, name)
    if kind.type == "ENUM":
        items = [] if kind.is_enum_flag else [item.identifier for item in kind.enum_items]
        if value not in items or len(items) < 2:
            return False
        other = items[(items.index(value) + 1) % len(items)]
    elif kind.type == "BOOLEAN":
        other = [not one for one in value] if kind.is_array else not value
    else:
        parts = [one + 1 if one + 1 <= kind.hard_max else one - 1 for one in (value if kind.is_array else [value])]
        other = parts if kind.is_array else parts[0]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of properties that the next Blender removes
            setattr(struct, name, other)
    except TypeError:  # an item that this build of Blender does not have
        return False
    return True


@pytest.mark.compares_with_cycles
def test_neutral_properties_change_nothing_in_what_cycles_shows(studio, there):
    """One render with all neutral properties changed against one with none.

    The export accepts them, and one sample has no noise.
    """
    studio.export()
    before = CyclesRenderer(studio.scene, seed=0, threads=1).render(0, 1).radiance
    changed = 0
    for group, structs in there.items():
        for reason, names in properties.GROUPS[group].neutral.items():
            if reason.startswith(FREE):
                continue
            for struct in structs:
                found = [
                    n
                    for name in names.split()
                    for n in matching([p.identifier for p in struct.bl_rna.properties], name)
                ]
                changed += sum(change(struct, name) for name in found)
    assert changed > 150
    studio.export()
    after = CyclesRenderer(studio.scene, seed=0, threads=1).render(0, 1).radiance
    assert before.std() > 0.01
    np.testing.assert_array_equal(after, before)


@pytest.mark.parametrize("group", sorted(properties.CYCLES_GROUPS))
def test_no_setting_is_both_neutral_and_irrelevant(there, group):
    irrelevant = {name for names in properties.GROUPS[group].neutral.values() for name in names.split()}
    with neutral(bpy.context.scene) as changes:
        held = {path.removeprefix(group + ".") for path in changes.settings if path.startswith(group + ".")}
    assert irrelevant & held == set()


@pytest.mark.parametrize(
    ("group", "name", "value"),
    [
        ("cycles", "tile_size", 64),
        ("view_layer.cycles", "pass_debug_sample_count", True),
        ("object.cycles", "ao_distance", 1.0),
        ("light.cycles", "max_bounces", 500),
        ("material.cycles", "volume_step_rate", 2.0)
        if bpy.app.version < (5, 0)
        else ("cycles", "min_light_bounces", 3),
        ("world.cycles", "sample_map_resolution", 512),
        ("scene", "use_gravity", False),
        ("render", "dither_intensity", 0.5),
        ("view_layer", "use_pass_z", True),
        ("layer_collection", "hide_viewport", True),
        ("object", "show_wire", True),
        ("object", "lightgroup", "key"),
        ("mesh", "use_mirror_x", True),
        ("light", "specular_factor", 0.5),
        ("camera", "display_size", 2.0),
        ("camera.dof", "aperture_ratio", 2.5),
        ("world", "sun_threshold", 5.0),
        ("world.cycles_visibility", "shadow", False),
        ("material", "metallic", 0.5),
        ("image", "seam_margin", 5),
    ],
)
def test_a_property_in_no_table_is_refused_where_it_is_changed(studio, there, monkeypatch, group, name, value):
    """Plants a property that is new: its row is taken out of the tables."""
    for struct in there[group]:
        monkeypatch.setitem(properties._undeclared, (group, struct.bl_rna.identifier), (name,))
    monkeypatch.setattr(properties, "_fresh", {})
    studio.export()
    setattr(there[group][0], name, value)
    kind = "Cycles' setting" if group in properties.CYCLES_GROUPS else "property"
    with pytest.raises(Refused, match=rf"{kind} '.*' \({name}\),? is not simulated; set it back to its default"):
        studio.export()


@pytest.mark.parametrize(
    ("group", "name"),
    [("camera", "type"), ("camera", "sensor_fit"), ("light", "shape"), ("object", "type"), ("image", "alpha_mode")],
)
def test_an_enum_value_that_no_table_has_is_refused_by_name(studio, there, monkeypatch, group, name):
    value = getattr(there[group][-1], name)
    monkeypatch.setitem(properties.GROUPS[group].values, name, "NOTHING")
    with pytest.raises(Refused, match=rf" {value} \(property {name}\),? is not simulated; choose another"):
        studio.export()


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="the world's switch Shadows is new in Blender 5")
def test_a_world_that_casts_no_shadows_is_refused(studio, there):
    there["world.cycles"][0].use_shadows = False
    with pytest.raises(Refused, match="world 'world': Cycles' setting 'Shadows'"):
        studio.export()


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="files have a working space from Blender 5 on")
def test_another_working_space_is_refused(studio, monkeypatch):
    studio.quad()
    monkeypatch.setitem(properties.GROUPS["colorspace"].values, "working_space", "ACEScg")
    with pytest.raises(Refused, match=r"the file: .* Linear Rec.709 \(property working_space\) is not simulated"):
        studio.export()


def test_defaults_are_learnt_without_a_trace_in_the_file(studio, monkeypatch):
    monkeypatch.setattr(properties, "_fresh", {})
    before = [one.name for one in bpy.data.user_map()]
    properties.remember_properties()
    assert properties._fresh
    assert [one.name for one in bpy.data.user_map()] == before


def test_what_an_add_on_registered_is_no_setting_of_the_render(studio):
    quad = studio.quad()
    bpy.types.Object.strange = bpy.props.IntProperty(default=1)
    properties._undeclared.clear()
    try:
        quad.strange = 5
        studio.export()
    finally:
        del bpy.types.Object.strange
        properties._undeclared.clear()


def test_a_struct_inside_a_struct_counts_as_changed_only_where_something_in_it_is(studio, monkeypatch):
    """As a new struct of settings would: Blender always makes it, so that it is never None."""
    studio.quad()
    monkeypatch.setitem(properties._undeclared, ("scene", "Scene"), ("unit_settings",))
    monkeypatch.setattr(properties, "_fresh", {})
    studio.export()
    studio.scene.unit_settings.scale_length = 0.5
    with pytest.raises(Refused, match=r"scene 'Scene': property 'Unit Settings' \(unit_settings\)"):
        studio.export()
