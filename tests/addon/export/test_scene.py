# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole export.

Tested are materials on their faces, the settings that count, and what is refused by name.
"""

import re
from collections import Counter

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon import job
from etalon.addon.export import export_scene, refusals
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.archive import load, save
from etalon.lib.scene.materials import Diffuse, Emission
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer

COLORS = {"red": (1.0, 0.25, 0.125), "green": (0.125, 1.0, 0.25), "blue": (0.25, 0.125, 1.0), "grey": (0.5, 0.5, 0.5)}


def glow(studio, name):
    """A material that glows in its own colour."""
    material = studio.probe_material("ShaderNodeNewGeometry", "Position")
    material.name = name
    tree = material.node_tree
    find = {n.bl_idname: n for n in tree.nodes}
    tree.nodes.remove(find["ShaderNodeVectorMath"])
    tree.nodes.remove(find["ShaderNodeNewGeometry"])
    find["ShaderNodeEmission"].inputs["Color"].default_value = (*COLORS[name], 1.0)
    return material


def set_material(material):
    """A geometry node tree that gives everything a material."""
    tree = bpy.data.node_groups.new("set", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    source, change = tree.nodes.new("NodeGroupInput"), tree.nodes.new("GeometryNodeSetMaterial")
    out = tree.nodes.new("NodeGroupOutput")
    change.inputs["Material"].default_value = material
    tree.links.new(source.outputs[0], change.inputs["Geometry"])
    tree.links.new(change.outputs[0], out.inputs[0])
    return tree


def strip(studio, name, y, *materials, slots=(0, 1, 2)):
    """Three squares side by side that ask for the given slots."""
    xs = (-1.5, -0.5, 0.5, 1.5)
    vertices = [(x, y + h, 0.0) for x in xs for h in (-0.4, 0.4)]
    mesh = studio.mesh(name, vertices, [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(3)])
    for material in materials:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", list(slots))
    return studio.add(name, mesh)


def test_each_face_has_the_material_that_cycles_gives_it(studio, rays, hits):
    red, green, blue, grey = (glow(studio, name) for name in COLORS)
    strip(studio, "data", 1.5, red, green, blue)
    strip(studio, "clamped", 0.5, red, green, slots=(1, 7, 0))
    linked = strip(studio, "object", -0.5, red, green, blue)
    linked.material_slots[1].link = "OBJECT"
    linked.material_slots[1].material = grey
    strip(studio, "set", -1.5, red, green).modifiers.new("set", "NODES").node_group = set_material(blue)
    studio.look_down(4.1)
    scene = studio.export()
    index, _, _ = hits(scene.mesh, *rays(scene.camera))
    met = index >= 0
    lobes = [material.lobes for material in scene.materials]
    assert all(isinstance(one.closure, Emission) for (one,) in lobes)
    colors = np.array([one.closure.color.value for (one,) in lobes])
    shown = studio.cycles()
    assert np.abs(colors[scene.mesh.material_index[index[met]]] - shown[met]).max() < 1e-6
    assert {material.name for material in scene.materials} == set(COLORS)


def bare(studio):
    strip(studio, "none", 0.5).data.materials.clear()
    strip(studio, "empty", -0.5, None, studio.plain, slots=(0, 0, 0))


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="from Blender 5.0 on Cycles' default is a Principled BSDF")
def test_without_a_material_faces_are_the_grey_that_cycles_shows(studio):
    bare(studio)
    sun = studio.add("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.angle, sun.data.energy = 0.0, 1.0
    studio.look_down(0.5)
    for y in (0.5, -0.5):
        studio.camera.location.y = y
        scene = studio.export()
        (lobe,) = scene.materials[0].lobes
        assert isinstance(lobe.closure, Diffuse)
        assert studio.cycles() == pytest.approx(lobe.closure.color.value[0] / np.pi, rel=1e-6)


@pytest.mark.skipif(bpy.app.version < (5, 0, 0), reason="before Blender 5.0 Cycles' default is a grey diffuse surface")
def test_without_a_material_faces_are_the_principled_bsdf_that_cycles_shows(studio):
    bare(studio)
    sun = studio.add("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.angle, sun.data.energy = 0.0, 1.0
    sun.rotation_euler = (0.5, 0.0, 0.0)
    studio.look_down(0.5)
    for y in (0.5, -0.5):
        studio.camera.location.y = y
        reference = ReferenceRenderer(studio.export(), Options(threads=1)).render(0, 1).radiance
        assert studio.cycles() == pytest.approx(reference, rel=1e-3)


def test_overrides_of_the_view_layer(studio):
    strip(studio, "strip", 0.0, glow(studio, "red"), glow(studio, "green"))
    studio.layer.material_override = glow(studio, "blue")
    scene = studio.export()
    assert [material.name for material in scene.materials] == ["blue"]
    assert scene.world.radiance == ex.BLACK
    if hasattr(studio.layer, "world_override"):
        studio.layer.world_override = bpy.data.worlds.new("override")
        assert studio.export().world.radiance != ex.BLACK


def test_transport_is_the_scenes_unless_given(studio):
    studio.quad()
    studio.scene.cycles.max_bounces = 7
    assert studio.export().transport.max_bounces == 7
    assert studio.export(max_bounces=3).transport.max_bounces == 3
    studio.scene.cycles.transparent_max_bounces = 100
    assert studio.export().transport.transparent_max_bounces == 100


def test_the_export_survives_its_archive(studio, tmp_path):
    strip(studio, "strip", 0.0, glow(studio, "red"), glow(studio, "green"))
    studio.add("lamp", bpy.data.lights.new("lamp", "AREA"))
    scene = studio.export()
    save(scene, tmp_path / "scene.npz")
    again = load(tmp_path / "scene.npz")
    assert (again.materials, again.lights, again.world) == (scene.materials, scene.lights, scene.world)
    assert np.array_equal(again.mesh.vertices, scene.mesh.vertices)


def test_the_viewports_depsgraph_is_not_taken(studio):
    studio.quad()
    with pytest.raises(EtalonError, match="was evaluated for the viewport"):
        export_scene(bpy.context.evaluated_depsgraph_get())


def test_no_faces_is_bad_input(studio):
    studio.add("lamp", bpy.data.lights.new("lamp", "POINT"))
    with pytest.raises(EtalonError, match="Scene: the scene has no faces to render; "):
        studio.export()


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


def in_collection(name):
    def make(studio):
        inner = bpy.data.collections.new("inner")
        studio.scene.collection.children.link(inner)
        thing = studio.quad("thing")
        studio.scene.collection.objects.unlink(thing)
        inner.objects.link(thing)
        setattr(studio.layer.layer_collection.children["inner"], name, True)

    return make


OBJECTS = {
    "hair curves": curves,
    "a point cloud": point_cloud,
    "a volume": volume,
    "grease pencil": grease_pencil,
    "particle hair": particles("HAIR", "PATH"),
    "smoke": smoke,
    "a holdout": flag(is_holdout=True),
    "a shadow catcher": flag(is_shadow_catcher=True),
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


def test_a_holdout_collection_is_refused(studio):
    in_collection("holdout")(studio)
    with pytest.raises(Refused, match="object 'thing': a holdout"):
        studio.export()


def switch(owner, name, value=True):
    return lambda studio: setattr({"render": studio.scene.render, "layer": studio.layer}[owner], name, value)


SETTINGS = {
    "scene 'Scene': Simplify": switch("render", "use_simplify"),
    "scene 'Scene': stereoscopy": switch("render", "use_multiview"),
    "scene 'Scene': Freestyle": switch("render", "use_freestyle"),
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


def test_materials_that_are_not_simulated_are_unknown_in_part(studio):
    """Each says what of it is not simulated; objects, lights and settings are refused as ever."""
    soft, lost = glow(studio, "red"), glow(studio, "green")
    for material, kind in ((soft, "ShaderNodeBsdfHair"), (lost, "ShaderNodeBsdfRayPortal")):
        tree = material.node_tree
        node, out = tree.nodes.new(kind), next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
        tree.links.new(node.outputs[0], out.inputs["Surface"])
    strip(studio, "strip", 0.0, soft, lost, glow(studio, "blue"))
    with pytest.raises(EtalonError):
        studio.export()
    red, green, blue = studio.export(partial=True).materials
    assert red.lobes == green.lobes == ()
    assert "Hair BSDF" in red.unknown
    assert "Ray Portal" in green.unknown
    assert blue.unknown == ""
    assert isinstance(blue.lobes[0].closure, Emission)
    studio.scene.render.use_simplify = True
    with pytest.raises(Refused, match="Simplify"):
        studio.export(partial=True)


def saved_image(path, value):
    """Write a file of 2 x 2 texels of one value."""
    buffer = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(2, 2, 3, OpenImageIO.FLOAT))
    buffer.set_pixels(OpenImageIO.ROI(), np.full((2, 2, 3), value, np.float32))
    assert buffer.write(str(path))


def shown_image(studio, path):
    """A square that glows with the image at `path`; the image as Blender holds it, read."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Linear Rec.709"
    assert len(image.pixels) > 0
    material = glow(studio, "red")
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    emission = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
    tree.links.new(node.outputs[0], emission.inputs["Color"])
    thing = studio.quad("thing")
    thing.data.materials.clear()
    thing.data.materials.append(material)
    return image


def test_a_texture_that_changed_on_disk_is_what_cycles_will_read(studio, tmp_path):
    saved_image(tmp_path / "rug.exr", 0.25)
    shown_image(studio, tmp_path / "rug.exr")
    assert studio.export().images[0].pixels[0, 0, 0] == 0.25
    saved_image(tmp_path / "rug.exr", 0.75)
    assert studio.export().images[0].pixels[0, 0, 0] == 0.75


def test_a_texture_that_is_gone_since_blender_read_it_is_magenta(studio, tmp_path):
    saved_image(tmp_path / "rug.exr", 0.25)
    shown_image(studio, tmp_path / "rug.exr")
    (tmp_path / "rug.exr").unlink()
    scene = studio.export()
    assert scene.images == ()
    (finding,) = (one for one in scene.findings if one.check == "missing textures")
    assert f"1 image is missing: image 'rug.exr': file '{tmp_path / 'rug.exr'}' is not there." in str(finding)


def test_missing_textures_are_magenta_in_cycles_too(studio, tmp_path):
    saved_image(tmp_path / "rug.exr", 0.25)
    shown_image(studio, tmp_path / "rug.exr")
    (tmp_path / "rug.exr").unlink()
    studio.look_down(1.0)
    np.testing.assert_allclose(studio.cycles()[16, 16], [1.0, 0.0, 1.0], atol=1e-6)


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
    monkeypatch.setattr(job, "with_render_depsgraph", lambda *_: pytest.fail("the scene was evaluated"))
    with pytest.raises(Refused, match="object 'quad': smoke is not simulated"):
        job.export(studio.scene)
    domain.show_render = False
    with pytest.raises(pytest.fail.Exception):
        job.export(studio.scene)
