# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole export.

Tested are materials on their faces, the settings that count, and what is refused by name.
"""

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon.export import export_scene
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
