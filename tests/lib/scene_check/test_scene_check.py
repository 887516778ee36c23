# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene check finds what is likely not meant, and names where it is.

It finds nothing in a sound scene.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.scene.expressions import ColorRamp, Constant, Coordinates, ImageTexture, NormalMap
from etalon.lib.scene.findings import Finding
from etalon.lib.scene.images import Image
from etalon.lib.scene.lights import AreaLight, PointLight
from etalon.lib.scene.materials import Diffuse, Emission, Material, WeightedClosure
from etalon.lib.scene.mesh import Object
from etalon.lib.scene.rays import EVERY, SHADOW
from etalon.lib.scene_check.check import check_scene
from etalon.tests import scenes

CAMERA = scenes.orthographic(2, 2, 1.0, (0.0, 0.0, 5.0))
TEXTURE = ImageTexture(Coordinates("POSITION"), 0)


def checked(geometry, materials=None, **how):
    """The findings about a scene, by check."""
    materials = scenes.diffuse(0.8) if materials is None else materials
    found = check_scene(scenes.scene(geometry, materials, CAMERA, **how))
    assert all(finding.effect.endswith(".") and finding.remedy.endswith(".") for finding in found)
    return {finding.check: finding.what for finding in found}


def test_a_sound_scene_has_no_findings():
    assert checked([scenes.floor(), scenes.cube(0.5, (0.0, 0.0, 1.0)), scenes.icosphere(0.3, 2, smooth=True)]) == {}


def test_overlapping_faces_are_named_by_objects_and_area_the_largest_first():
    """A rug in the floor's plane, and a panel whose quad is there twice."""
    panel = scenes.quad((3.0, 0.0, 0.0), (0.0, 0.0, 0.5), (0.0, 0.5, 0.0))
    twice = scenes.Part(panel.vertices, np.hstack([panel.triangles, panel.triangles]))
    found = checked([scenes.floor(2.0), scenes.floor(1.0), twice])
    assert found["overlapping faces"] == (
        "Faces share a plane and an area of it: 'object 0' and 'object 1' (4 m²); 'object 2' with itself (0.25 m²)."
    )


def test_an_image_decoded_as_a_colour_before_a_normal_map_is_named():
    def material(name):
        return Material(name, (WeightedClosure(Diffuse(normal=NormalMap(TEXTURE, Constant(1.0)))),))

    pixels = np.full((2, 2, 4), 0.5, np.float32)
    for encoding, says in (("SRGB", True), ("DATA", False), ("LINEAR", False)):
        found = checked(scenes.floor(), [material("Bricks")], images=(Image("bricks_n.png", pixels, encoding),))
        assert ("normal map read as a colour" in found) == says
        if says:
            assert "'bricks_n.png' (material 'Bricks')" in found["normal map read as a colour"]


def test_an_srgb_image_that_is_a_colour_is_no_finding():
    image = Image("wood.png", np.full((2, 2, 4), 0.5, np.float32), "SRGB")
    assert checked(scenes.floor(), [scenes.material(Diffuse(TEXTURE))], images=(image,)) == {}


def test_shading_normals_against_their_faces_are_counted_by_object():
    sphere = scenes.icosphere(0.5, 2, smooth=True)
    inside_out = replace(sphere, normals=-sphere.normals)
    found = checked([sphere, inside_out])
    assert "320 triangles have shading normals" in found["normals against faces"]
    assert "'object 1'" in found["normals against faces"]
    assert "'object 0'" not in found["normals against faces"]


@pytest.mark.parametrize(
    "closure",
    [
        Diffuse(scenes.color(0.5, -0.1, 0.5)),
        Emission(scenes.color(-1.0)),
        Diffuse(ColorRamp(Coordinates("POSITION"), (0.0, 1.0), ((-0.2, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)))),
        Diffuse(TEXTURE),
    ],
)
def test_negative_colours_are_named_by_material(closure):
    image = Image("ember.exr", np.full((1, 1, 4), -0.5, np.float32), "LINEAR")
    found = checked(scenes.floor(), [Material("Ember", (WeightedClosure(closure),))], images=(image,))
    assert found == {"negative colours": "A colour is below zero in 'Ember'."}


def test_mirrored_objects_are_counted_and_named():
    scene = scenes.scene([scenes.cube(0.2), scenes.floor()], scenes.diffuse(0.8), CAMERA)
    flipped = Object("Left shoe", np.diag([-1.0, 1.0, 1.0, 1.0])[:3])
    scene = replace(scene, mesh=replace(scene.mesh, objects=(flipped, scene.mesh.objects[1])))
    (found,) = check_scene(scene)
    assert (found.check, found.what) == ("negative scale", "1 object is mirrored by a negative scale: 'Left shoe'.")


PANEL = AreaLight("Panel", (0.0, 0.0, 3.0), (2.0, 0, 0), (0, -2.0, 0), (0, 0, -1.0), "RECTANGLE", (1.0,) * 3, np.pi)


@pytest.mark.parametrize(
    ("other", "area"),
    [
        ({}, "4"),
        ({"center": (1.0, 0.0, 3.0)}, "2"),
        ({"center": (2.0, 0.0, 3.0)}, None),  # side by side
        ({"center": (0.0, 0.0, 3.00001)}, None),
        ({"edge_v": (0, 2.0, 0), "normal": (0, 0, 1.0)}, None),  # back to back
        ({"radiance": (0.0,) * 3}, None),
        ({"shape": "ELLIPSE"}, "3.14"),
        ({"edge_u": (2**0.5, 2**0.5, 0), "edge_v": (2**0.5, -(2**0.5), 0)}, "3.31"),  # an octagon
    ],
)
def test_area_lights_that_overlap_in_one_plane_are_named_with_their_area(other, area):
    """The areas are those of the plane's geometry: 8 (sqrt 2 - 1) of two squares at 45 degrees."""
    found = checked(scenes.floor(), lights=(PANEL, replace(PANEL, name="Second", **other)))
    said = {} if area is None else {"overlapping lights": f"'Panel' and 'Second' ({area} m²)"}
    assert found.keys() == said.keys()
    assert all(text in found[check] for check, text in said.items())


def test_findings_of_the_export_come_last():
    told = Finding("soft falloff", "Soft falloff of 1 light is off on both sides: 'Lamp'.", "E.", "R.")
    scene = replace(scenes.scene([scenes.floor(), scenes.floor()], scenes.diffuse(0.8), CAMERA), findings=(told,))
    assert [finding.check for finding in check_scene(scene)] == ["overlapping faces", "soft falloff"]


def test_shadows_that_depend_on_how_light_is_found_are_named():
    """Only where a light has a size: what has none is found in one way alone."""
    area = AreaLight("area", (0, 0, 3.0), (1.0, 0, 0), (0, -1.0, 0), (0, 0, -1.0), "RECTANGLE", (1.0,) * 3, np.pi)
    point = PointLight("point", (0.0, 0.0, 3.0), (1.0, 1.0, 1.0))
    for light, found in ((area, False), (point, False), (replace(area, casts_shadow=False), True)):
        assert ("shadows apart" in checked(scenes.cube(), lights=(light,))) == found
    for light, found in ((area, True), (point, False)):
        one = scenes.scene(scenes.cube(), scenes.diffuse(0.8), CAMERA, (light,))
        hidden = replace(one.mesh.objects[0], rays=EVERY & ~SHADOW)
        findings = check_scene(replace(one, mesh=replace(one.mesh, objects=(hidden,))))
        assert [finding.check for finding in findings] == ["shadows apart"] * found
        assert all("'object 0'" in finding.what for finding in findings)
