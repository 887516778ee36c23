# SPDX-License-Identifier: GPL-3.0-or-later
"""Movies show the frame that Blender decodes for the scene's frame."""

import bpy
import numpy as np
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.scene import expressions as ex
from etalon.lib.srgb import srgb_decode
from etalon.tests.addon.export.nodes.movies import SIZE, write_movie
from etalon.tests.addon.export.nodes.node_cells import (
    Points,
    assert_same,
    glowing,
    linearize_in_half_precision,
    node,
    predicted,
    prepare,
    quad,
    rendered,
    through_emission,
)
from etalon.tests.addon.export.nodes.reading import refused

OPAQUE = [(k / 5, 0.4, 1 - k / 5, 1.0) for k in range(1, 6)]
"""Codes of the right half of frames 1 to 5; the left half has half of them."""
USERS = {
    "plain": {"frame_duration": 5, "frame_start": 3, "frame_offset": 1},
    "cyclic": {"frame_duration": 3, "frame_start": 3, "frame_offset": 1, "use_cyclic": True},
    "stale": {"frame_duration": 5, "use_auto_refresh": False},
    "endless": {"frame_duration": 50},
}

pytestmark = pytest.mark.skipif(not bpy.app.ffmpeg.supported, reason="this Blender has no FFmpeg")


def load(folder):
    path = write_movie(folder, OPAQUE)  # which opens another file
    return bpy.data.images.load(path)


def playing(movie, settings, kind="TexImage"):
    def build(tree):
        made = node(tree, kind, image=movie)
        for name, value in settings.items():
            setattr(made.node.image_user, name, value)
        return made

    return build


def screen(movie, settings):
    return glowing("screen", through_emission(playing(movie, settings)))


def texels_read(material, frame):
    images = ImageTable(frame)
    (lobe,) = read_material(material, images, refusals := []).lobes
    assert not refusals
    assert not images.missing
    return images.images[lobe.closure.color.image]


@pytest.mark.parametrize(
    ("user", "scene_frame", "shown"),
    [("plain", 3, 2), ("plain", 6, 5), ("plain", 9, 5), ("plain", -9, 1), ("cyclic", 6, 2), ("endless", 40, 5)],
)
def test_the_texels_are_those_that_the_movie_was_made_of(user, scene_frame, shown, tmp_path):
    movie = load(tmp_path)
    before = set(bpy.data.images.keys())
    image = texels_read(screen(movie, USERS[user]), scene_frame)
    right = np.array(OPAQUE[shown - 1])
    # The file holds codes of 8 bits; those of half a code may be rounded either way.
    np.testing.assert_allclose(image.pixels[:, SIZE // 2 :], np.broadcast_to(right, (SIZE, SIZE // 2, 4)), atol=1e-6)
    np.testing.assert_allclose(image.pixels[:, : SIZE // 2, :3] - right[:3] / 2, 0.0, atol=0.51 / 255)
    assert (image.encoding, image.multiplied) == ("SRGB", False)
    assert set(bpy.data.images.keys()) == before
    assert not movie.is_dirty


def test_two_frames_of_a_movie_are_two_images_and_the_same_frame_is_one(tmp_path):
    movie = load(tmp_path)
    images = ImageTable(3)
    for settings in (USERS["plain"], {**USERS["plain"], "frame_offset": 2}, USERS["plain"]):
        read_material(screen(movie, settings), images, [])
    assert len(images.images) == 2


def test_a_movie_that_is_not_there_is_magenta(tmp_path):
    path = write_movie(tmp_path, OPAQUE)
    movie = bpy.data.images.load(path)
    movie.filepath = path + ".gone"
    images = ImageTable(3)
    (lobe,) = read_material(screen(movie, USERS["plain"]), images, []).lobes
    assert lobe.closure.color == ex.Constant((1.0, 0.0, 1.0))
    assert [text.partition("file ")[2] for text in images.missing] == [f"'{path}.gone' is not there"]


def test_a_movie_of_a_library_is_found_beside_it(tmp_path):
    (tmp_path / "props").mkdir()
    movie = load(tmp_path / "props")
    movie.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "props" / "props.blend"))
    movie.filepath = "//" + bpy.path.basename(movie.filepath)
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    with bpy.data.libraries.load(str(tmp_path / "props" / "props.blend"), link=True, relative=True) as (there, linked):
        linked.images = there.images
    (movie,) = (image for image in bpy.data.images if image.source == "MOVIE")
    assert movie.filepath.startswith("//")
    assert texels_read(screen(movie, USERS["plain"]), 4).pixels[0, -1, 0] == pytest.approx(OPAQUE[2][0], abs=1e-6)


def test_an_environment_texture_shows_the_frame(tmp_path):
    movie = load(tmp_path)
    material = glowing("screen", through_emission(playing(movie, USERS["plain"], "TexEnvironment")))
    assert texels_read(material, 5).pixels[0, -1, 0] == pytest.approx(OPAQUE[3][0], abs=1e-6)


def test_a_blender_without_ffmpeg_refuses_movies(tmp_path, monkeypatch):
    movie = load(tmp_path)
    monkeypatch.setattr("etalon.addon.export.nodes.images._DECODES_MOVIES", False)
    (text,) = refused(screen(movie, USERS["plain"]))
    assert "'FFV18.mkv' (movie, in a Blender without FFmpeg), is not simulated; use a sequence of image files" in text


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("frame", [-2, 1, 3, 4, 8])
def test_frames_are_those_of_cycles(frame, tmp_path):
    path = write_movie(tmp_path, OPAQUE)
    scene = prepare("ORTHO", 4 * len(USERS), 4)
    scene.camera.data.ortho_scale = len(USERS)
    scene.camera.location = (len(USERS) / 2, 0.5, 10)
    movie = bpy.data.images.load(path)
    materials = []
    for index, settings in enumerate(USERS.values()):
        materials.append(screen(movie, settings))
        quad(str(index), (index + 0.5, 0.5, 0), 0.0, False).materials.append(materials[-1])
    scene.frame_set(frame)
    picture = rendered(scene, tmp_path)
    for index, material in enumerate(materials):
        (codes,) = {tuple(code) for code in texels_read(material, frame).pixels[:, -1, :3]}
        np.testing.assert_allclose(picture[:, 2, 4 * index + 2], srgb_decode(np.array(codes)), rtol=1e-5)


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(
    ("codec", "depth", "alpha", "settings"),
    [
        ("H264", "8", 1.0, {}),
        ("H264", "10", 1.0, {}),
        ("FFV1", "8", 0.6, {}),
        ("FFV1", "8", 0.6, {"alpha_mode": "CHANNEL_PACKED"}),
        ("FFV1", "10", 1.0, {}),
        ("FFV1", "8", 1.0, {"colorspace": "Non-Color"}),
        ("PNG", "8", 1.0, {"colorspace": "Linear Rec.2020"}),
    ],
)
def test_codecs_alpha_and_colour_spaces_are_those_of_cycles(codec, depth, alpha, settings, tmp_path, monkeypatch):
    path = write_movie(tmp_path, [(*rgb, alpha) for *rgb, _ in OPAQUE], codec, depth)
    scene = prepare("ORTHO", 8, 8)
    scene.camera.data.ortho_scale = 1
    scene.camera.location = (0, 0, 10)
    movie = bpy.data.images.load(path)
    if "colorspace" in settings:
        movie.colorspace_settings.name = settings["colorspace"]
    movie.alpha_mode = settings.get("alpha_mode", movie.alpha_mode)
    material = screen(movie, {"frame_duration": 5})
    quad("screen", (0, 0, 0), 0.0, False).materials.append(material)
    scene.frame_set(2)
    across = (np.arange(8) + 0.5) / 8
    u, v = (part.ravel() for part in np.meshgrid(across, across))
    points = Points({"UV": np.stack([u, v, np.zeros(64)])})
    tolerance = 2e-5
    if movie.colorspace_settings.name == "Linear Rec.2020":
        monkeypatch.setattr("etalon.addon.export.nodes.images.linearize", linearize_in_half_precision)
        tolerance = 2**-9  # Cycles 4.5 cuts codes and decoded values off to half precision, whose steps are up to 2^-10
    assert_same(predicted(material, points, frame=2), rendered(scene, tmp_path).reshape(3, -1), tolerance)
