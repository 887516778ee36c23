# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's view transform, against what Blender itself writes into a PNG."""

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon.export.view_transform import export_view_transform

RADIANCE = np.array([[[0.18, 0.18, 0.18], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [4.0, 1.0, 0.2], [0.02, 0.5, 0.9]]])


@pytest.fixture
def settings():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.dither_intensity = 0.0
    return scene.view_settings


def written_by_blender(path):
    """The codes that Blender writes of RADIANCE for the scene's display."""
    height, width, _ = RADIANCE.shape
    image = bpy.data.images.new("radiance", width, height, float_buffer=True)
    image.pixels = np.concatenate([RADIANCE, np.ones((height, width, 1))], axis=2).ravel()
    image.save_render(str(path), scene=bpy.context.scene)
    return OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8)[..., :3]


@pytest.mark.parametrize(
    ("view", "look", "exposure", "gamma"),
    [
        ("Standard", "None", 0.0, 1.0),
        ("AgX", "None", 0.0, 1.0),
        ("AgX", "AgX - Punchy", 0.5, 1.0),
        ("Filmic", "None", -1.0, 1.0),
        ("Standard", "None", 0.0, 2.0),
    ],
)
def test_a_view_transform_gives_the_codes_that_blender_writes(settings, tmp_path, view, look, exposure, gamma):
    settings.view_transform, settings.look, settings.exposure, settings.gamma = view, look, exposure, gamma
    found = export_view_transform(bpy.context.scene).apply(RADIANCE)
    expected = written_by_blender(tmp_path / "blender.png")
    # Blender rounds its own tables to another code now and then.
    np.testing.assert_allclose(found.astype(int), expected.astype(int), atol=1)


def test_curves_of_the_view_are_named_as_omitted(settings):
    assert export_view_transform(bpy.context.scene).omitted == ()
    settings.use_curve_mapping = True
    assert export_view_transform(bpy.context.scene).omitted == ("curves",)


def test_pixels_that_are_not_finite_are_black(settings):
    settings.view_transform = "AgX"
    radiance = RADIANCE.copy()
    radiance[0, 1] = np.nan
    assert export_view_transform(bpy.context.scene).apply(radiance)[0, 1].tolist() == [0, 0, 0]
