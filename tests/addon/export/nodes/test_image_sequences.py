# SPDX-License-Identifier: GPL-3.0-or-later
"""Image sequences show the file of the scene's frame.

A frame without a file is magenta.
"""

from types import SimpleNamespace

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.image_files import frame_of_user, numbered_path
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.scene import expressions as ex
from etalon.tests.addon.export.nodes.node_cells import glowing, node, prepare, quad, rendered, through_emission

FILES = range(2, 9)
"""Frames that have a file; the one of frame k is a grey of k / 10."""
USERS = {
    "plain": {"frame_duration": 7, "frame_start": 3, "frame_offset": 1},
    "cyclic": {"frame_duration": 3, "frame_start": 3, "frame_offset": 1, "use_cyclic": True},
    "late": {"frame_duration": 7, "frame_start": 3, "frame_offset": 4},
}


def sequence(folder):
    for number in FILES:
        buffer = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(2, 2, 3, OpenImageIO.FLOAT))
        buffer.set_pixels(OpenImageIO.ROI(), np.full((2, 2, 3), number / 10, np.float32))
        assert buffer.write(str(folder / f"take2_{number:03d}b.exr"))
    image = bpy.data.images.load(str(folder / "take2_004b.exr"))
    image.source = "SEQUENCE"
    return image


def playing(image, settings):
    def build(tree):
        made = node(tree, "TexImage", image=image)
        for name, value in settings.items():
            setattr(made.node.image_user, name, value)
        return made

    return glowing("screen", through_emission(build))


def colour_read(material, frame):
    images = ImageTable(frame)
    (lobe,) = read_material(material, images, refusals := []).lobes
    assert not refusals
    color = lobe.closure.color
    if isinstance(color, ex.Constant):
        (missing,) = images.missing
        assert "is not there" in missing
        return color.value
    return tuple(images.images[color.image].pixels[0, 0, :3])


@pytest.mark.parametrize(
    ("settings", "shown"),
    [
        ({}, {0: 0, 1: 1, 2: 2, 5: 5, 6: 5}),
        ({"frame_start": 3}, {1: 0, 2: 0, 3: 1, 7: 5, 8: 5}),
        ({"frame_offset": 10}, {-4: 10, 1: 11, 9: 15}),
        ({"use_cyclic": True}, {0: 5, 1: 1, 5: 5, 6: 1, -1: 4, -5: 5}),
        ({"frame_duration": 0, "frame_offset": 3}, {1: 0, 9: 0}),
    ],
)
def test_the_frame_of_an_image_user(settings, shown):
    user = {"frame_duration": 5, "frame_start": 1, "frame_offset": 0, "use_cyclic": False}
    assert {k: frame_of_user(SimpleNamespace(**{**user, **settings}), k) for k in shown} == shown


@pytest.mark.parametrize(
    ("path", "shown"),
    [
        ("/a1/b_0004.png", "/a1/b_0012.png"),
        ("/a1/take2_004b.v1.exr", "/a1/take2_004b.v12.exr"),
        ("/a1/9.png", "/a1/12.png"),
        ("/a1/still.png", "/a1/still12.png"),
    ],
)
def test_the_path_of_a_frame(path, shown):
    assert numbered_path(path, 12) == shown


def test_a_frame_shows_its_file_and_one_without_is_magenta(tmp_path):
    material = playing(sequence(tmp_path), USERS["late"])
    before = set(bpy.data.images.keys())
    np.testing.assert_allclose(colour_read(material, 5), [0.7] * 3, rtol=1e-6)
    assert colour_read(material, 8) == (1.0, 0.0, 1.0)
    assert set(bpy.data.images.keys()) == before


def test_the_same_sequence_at_two_frames_is_two_images(tmp_path):
    image = sequence(tmp_path)
    images = ImageTable(3)
    for settings in (USERS["plain"], {**USERS["plain"], "frame_offset": 3}):
        read_material(playing(image, settings), images, [])
    assert len(images.images) == 2


def test_an_exported_scene_has_the_file_of_its_frame(studio, tmp_path):
    mesh = studio.mesh("screen", np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float), [(0, 1, 2)])
    mesh.uv_layers.new(name="UVMap")
    mesh.materials.append(playing(sequence(tmp_path), USERS["plain"]))
    studio.add("screen", mesh)
    bpy.context.scene.frame_set(6)
    (image,) = studio.export().images
    np.testing.assert_allclose(image.pixels[..., :3], 0.5, rtol=1e-6)


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("frame", [-2, 2, 3, 6, 8, 12])
def test_frames_are_those_of_cycles(frame, tmp_path):
    scene = prepare("ORTHO", 4 * len(USERS), 4)
    scene.camera.data.ortho_scale = len(USERS)
    scene.camera.location = (len(USERS) / 2, 0.5, 10)
    image = sequence(tmp_path)
    materials = []
    for index, settings in enumerate(USERS.values()):
        materials.append(playing(image, settings))
        quad(str(index), (index + 0.5, 0.5, 0), 0.0, False).materials.append(materials[-1])
    scene.frame_set(frame)
    picture = rendered(scene, tmp_path)
    for index, material in enumerate(materials):
        shown = picture[:, 2, 4 * index + 2]
        np.testing.assert_allclose(colour_read(material, frame), shown, rtol=1e-6)
