# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects and settings that the export refuses by name, and what it takes."""

import re
from collections import Counter

import bpy
import pytest
from etalon.addon import job
from etalon.addon.export import refusals
from etalon.lib.errors import Refused


def curves(studio, name="thing"):
    strands = bpy.data.hair_curves.new(name)
    strands.add_curves([2])
    strands.points[1].position = (0.0, 0.0, 1.0)
    return studio.add(name, strands)


def point_cloud(studio):
    thing = studio.add("thing", studio.mesh("thing", [(0, 0, 0), (1, 0, 0)], []))
    through_nodes(thing, ("GeometryNodeMeshToPoints", "Mesh"))
    return thing


def through_nodes(thing, *nodes):
    """Give a thing a modifier of these geometry nodes.

    Each is (type, input), one after the other.
    """
    tree = bpy.data.node_groups.new("nodes", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    last = tree.nodes.new("NodeGroupInput").outputs[0]
    for kind, name in nodes:
        node = tree.nodes.new(kind)
        tree.links.new(last, node.inputs[name])
        if kind in SHAPES:
            shape, into = SHAPES[kind]
            tree.links.new(tree.nodes.new(shape).outputs[0], node.inputs[into])
        last = node.outputs[0]
    tree.links.new(last, tree.nodes.new("NodeGroupOutput").inputs[0])
    thing.modifiers.clear()
    thing.modifiers.new("nodes", "NODES").node_group = tree


SHAPES = {
    "GeometryNodeCurveToMesh": ("GeometryNodeCurvePrimitiveCircle", "Profile Curve"),
    "GeometryNodeInstanceOnPoints": ("GeometryNodeMeshIcoSphere", "Instance"),
}


def volume(studio):
    studio.add("thing", bpy.data.volumes.new("thing"))


def grease_pencil(studio):
    pencils = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils)
    studio.add("thing", pencils.new("thing"))


def particles(kind, render):
    def make(studio):
        thing = studio.quad("thing")
        settings = thing.modifiers.new("hair", "PARTICLE_SYSTEM").particle_system.settings
        settings.type, settings.render_type, settings.count = kind, render, 3

    return make


def smoke(studio):
    modifier = studio.quad("thing").modifiers.new("fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    modifier.domain_settings.domain_type = "GAS"


def flag(**values):
    def make(studio):
        thing = studio.quad("thing")
        for name, value in values.items():
            setattr(thing, name, value)

    return make


def adaptive(studio):
    thing = studio.quad("thing")
    modifier = thing.modifiers.new("levels", "SUBSURF")
    if bpy.app.version >= (5, 0, 0):
        modifier.use_adaptive_subdivision = True
    else:
        studio.scene.cycles.feature_set = "EXPERIMENTAL"
        thing.cycles.use_adaptive_subdivision = True


OBJECTS = {
    "hair curves": curves,
    "a point cloud": point_cloud,
    "a volume": volume,
    "grease pencil": grease_pencil,
    "particle hair": particles("HAIR", "PATH"),
    "smoke": smoke,
    "adaptive subdivision": adaptive,
}


@pytest.mark.parametrize("what", OBJECTS)
def test_objects_that_are_not_simulated_are_refused_by_name(studio, what):
    studio.quad("other")
    OBJECTS[what](studio)
    with pytest.raises(Refused, match=f"^object 'thing': {re.escape(what)} is not simulated; ") as caught:
        studio.export()
    assert "convert" not in str(caught.value)  # what Blender converts these to has no faces


def test_hair_and_points_are_exported_once_they_have_faces(studio):
    """The two remedies that their refusals name."""
    tubes = curves(studio)
    through_nodes(tubes, ("GeometryNodeCurveToMesh", "Curve"))
    assert studio.export().mesh.triangle_count >= 2 * 32
    bpy.data.objects.remove(tubes)
    points = point_cloud(studio)
    through_nodes(points, ("GeometryNodeMeshToPoints", "Mesh"), ("GeometryNodeInstanceOnPoints", "Points"))
    assert studio.export().mesh.triangle_count == 2 * 20


def switch(owner, name, value=True):
    return lambda studio: setattr({"render": studio.scene.render, "layer": studio.layer}[owner], name, value)


SETTINGS = {
    "scene 'Scene': Simplify": switch("render", "use_simplify"),
    "scene 'Scene': stereoscopy": switch("render", "use_multiview"),
    "view layer 'ViewLayer': leaving out its surfaces": switch("layer", "use_solid", False),
}


@pytest.mark.parametrize("what", SETTINGS)
def test_settings_that_are_not_simulated_are_refused_by_name(studio, what):
    studio.quad()
    SETTINGS[what](studio)
    with pytest.raises(Refused, match=f"^{re.escape(what)} is not simulated; "):
        studio.export()


def test_all_refusals_come_at_once_and_each_once(studio):
    for i in range(3):
        curves(studio, f"hair {i}")
    studio.scene.render.use_simplify = True
    studio.add("lamp", bpy.data.lights.new("lamp", "AREA")).data.cycles.is_caustics_light = True
    with pytest.raises(Refused) as caught:
        studio.export()
    owners = [refusal.owner for refusal in caught.value.refusals]
    assert sorted(owners) == ["light 'lamp'", "object 'hair 0'", "object 'hair 1'", "object 'hair 2'", "scene 'Scene'"]


def test_what_cycles_leaves_out_is_no_reason_to_refuse(studio):
    studio.quad()
    flag(**{f"visible_{ray}": False for ray in ("camera", "diffuse", "glossy", "transmission", "shadow")})(studio)
    hidden = studio.quad("hidden")
    hidden.is_holdout, hidden.hide_render = True, True
    for kind in ("ARMATURE", "LATTICE"):
        studio.add(kind, getattr(bpy.data, {"ARMATURE": "armatures", "LATTICE": "lattices"}[kind]).new(kind))
    scene = studio.export()
    assert [thing.name for thing in scene.mesh.objects] == ["quad"]


def test_a_particle_system_that_shows_objects_is_exported(studio, rays, hits):
    leaf = studio.quad("leaf", half=0.1)
    leaf.location.x = 50.0
    thing = studio.quad("thing")
    settings = thing.modifiers.new("hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.render_type, settings.count = "HAIR", "OBJECT", 5
    settings.instance_object = leaf
    names = [one.name for one in studio.export().mesh.objects]
    assert names.count("leaf") == 6


def forty_instances(studio, mesh):
    """An object that shows 40 instances of `mesh`, one at each vertex of another."""
    child = studio.add(f"child of {mesh.name}", mesh)
    parent = studio.add(f"points of {mesh.name}", studio.mesh("points", [(k, 0, 0) for k in range(40)], []))
    child.parent = parent
    parent.instance_type = "VERTS"
    return parent


def test_the_properties_of_instances_are_checked_once_per_object(studio, monkeypatch):
    checks = Counter()
    check = refusals.refuse_undeclared

    def count(owner, group, struct, found):
        checks[group, owner] += 1
        check(owner, group, struct, found)

    monkeypatch.setattr(refusals, "refuse_undeclared", count)
    first, second = (studio.mesh(name, [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]) for name in ("one", "two"))
    second.texco_mesh = first  # in no table
    forty_instances(studio, first)
    forty_instances(studio, second)
    with pytest.raises(Refused) as refused:
        studio.export()
    assert {refusal.owner for refusal in refused.value.refusals} == {"mesh 'two'"}
    assert checks["mesh", "mesh 'one'"] == checks["mesh", "mesh 'two'"] == 1


def test_smoke_is_refused_before_blender_evaluates_it(studio, monkeypatch):
    domain = studio.quad().modifiers.new("smoke", "FLUID")
    domain.fluid_type = "DOMAIN"
    monkeypatch.setattr(job, "with_render_frames", lambda *_: pytest.fail("the scene was evaluated"))
    with pytest.raises(Refused, match="object 'quad': smoke is not simulated"):
        job.export(studio.scene)
    domain.show_render = False
    with pytest.raises(pytest.fail.Exception):
        job.export(studio.scene)
