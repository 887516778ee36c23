# SPDX-License-Identifier: GPL-3.0-or-later
"""Every alpha mode of every kind of file, with colour left where alpha is 0.

Tested are what is read, and the image against Cycles.
"""

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.srgb import srgb_decode
from etalon.tests.addon.export.nodes.node_cases import image_case
from etalon.tests.addon.export.nodes.node_cells import (
    CELL,
    Points,
    glowing,
    node,
    predicted,
    prepare,
    quad,
    rendered,
    through_emission,
)

MODES = ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")
FILES = {
    "byte sRGB": ("png", "sRGB", OpenImageIO.UINT8),
    "byte linear": ("png", "Linear Rec.709", OpenImageIO.UINT8),
    "byte data": ("png", "Non-Color", OpenImageIO.UINT8),
    "short sRGB": ("png", "sRGB", OpenImageIO.UINT16),
    "float linear": ("exr", "Linear Rec.709", OpenImageIO.FLOAT),
    "float sRGB": ("exr", "sRGB", OpenImageIO.FLOAT),
}
# Cycles multiplies alpha in at a file's 16 bits. Blender decodes floats in single precision, and the reader encodes them again.
TOLERANCES = {"short sRGB": 2e-3, "float sRGB": 5e-5}
FOLLOWED = bpy.app.version >= (5, 1, 0)


def natural(file):
    return "PREMUL" if file.startswith("float") else "STRAIGHT"


def is_refused(file, mode):
    return not FOLLOWED and file != "byte data" and mode in {"STRAIGHT", "PREMUL"} - {natural(file)}


def stored(folder, file, mode, texels):
    suffix, space, kind = FILES[file]
    height, width, _ = texels.shape
    buffer = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(width, height, 4, kind))
    buffer.specmod().attribute("oiio:UnassociatedAlpha", int(suffix == "png"))
    buffer.set_pixels(OpenImageIO.ROI(), texels.astype(np.float32))
    path = folder / f"{file} {mode}.{suffix}"
    assert buffer.write(str(path))
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name, image.alpha_mode = space, mode
    return image


def multiplied(file, mode, alpha_used):
    """Whether the colour that shows is the file's times alpha.

    With alpha in use it is divided out again.
    """
    return mode == "STRAIGHT" and file != "byte data" and not alpha_used


@pytest.mark.parametrize("alpha", ["unused", "used"])
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("file", FILES)
def test_one_texel_shows_the_colour_that_its_alpha_mode_gives(file, mode, alpha, tmp_path):
    """For a colour c and alpha a in the file: c, c times a, c over a, each decoded.

    In Cycles the decoding comes last.
    """
    texel = np.array([[[0.2, 0.4, 0.1, 0.6]]])
    image = stored(tmp_path, file, mode, texel)
    material = glowing("glow", through_emission(image_case(lambda: image, alpha, interpolation="Closest")))
    if is_refused(file, mode):
        refusals = []
        read_material(material, ImageTable(), refusals)
        assert len(refusals) == 1
        assert f"alpha {mode.title()}, which Cycles before 5.1 takes for {natural(file).title()}" in str(refusals[0])
        return
    color = texel[0, 0, :3]
    if multiplied(file, mode, alpha == "used"):
        color = color * 0.6
    if mode == "PREMUL" and file != "byte data" and alpha == "used":
        color = color / 0.6
    expected = srgb_decode(color) if "sRGB" in file else color
    before = set(bpy.data.images.keys())
    got = predicted(material, Points({"UV": np.full((3, 1), 0.5)}))
    assert set(bpy.data.images.keys()) == before
    # Cycles cuts products of bytes with alpha off at 8 bits, so up to 1/255 of them is gone.
    np.testing.assert_allclose(got[:, 0], expected, atol=1 / 255 if file.startswith("byte") else 1e-5)


def test_byte_codes_times_alpha_are_not_rounded_by_a_division(tmp_path):
    """Blender divides 8-bit codes by alpha and rounds.

    Of 3 at alpha 7 it makes 109, and times 7 / 255 that is 2.99.
    """
    if not FOLLOWED:
        pytest.skip("Blender before 5.1 refuses it")
    texel = np.array([[[3, 7, 5, 7]]]) / 255
    image = stored(tmp_path, "byte linear", "PREMUL", texel)
    images = ImageTable()
    read_material(glowing("glow", through_emission(image_case(lambda: image, "used"))), images, [])
    np.testing.assert_allclose(images.images[0].pixels, texel, rtol=1e-6)


@pytest.mark.compares_with_cycles
def test_alpha_modes_are_those_of_cycles(tmp_path, rng):
    cases = [
        (file, mode, alpha)
        for file in FILES
        for mode in MODES
        for alpha in ("unused", "used", "shown")
        if not is_refused(file, mode)
    ]
    side = int(np.ceil(np.sqrt(len(cases) + 1)))
    scene = prepare("ORTHO", side * CELL, side * CELL)
    scene.camera.data.ortho_scale = side
    scene.camera.location = (side / 2, side / 2, 10)
    loaded = {}
    for file, mode, _ in cases:
        texels = rng.random((4, 5, 4))
        texels[1:3, 1:4, 3] = 0.0
        if (file, mode) not in loaded:
            loaded[file, mode] = stored(tmp_path, file, mode, texels)
    materials = []
    for index, (file, mode, alpha) in enumerate(cases):
        mesh = quad(str(index), (index % side + 0.5, index // side + 0.5, 0), 0.0, False)
        build = image_case(lambda image=loaded[file, mode]: image, alpha)
        materials.append(glowing(str(index), through_emission(build)))
        mesh.materials.append(materials[-1])
    coordinates = glowing("UV", through_emission(lambda tree: node(tree, "TexCoord", output="UV")))
    quad("UV", (side - 0.5, side - 0.5, 0), 0.0, False).materials.append(coordinates)
    picture = rendered(scene, tmp_path)
    cells = picture.reshape(3, side, CELL, side, CELL).transpose(1, 3, 0, 2, 4).reshape(side * side, 3, -1)
    points = Points({"UV": cells[-1]})
    wrong = {}
    for material, shown, case in zip(materials, cells, cases, strict=False):
        error = np.abs(predicted(material, points) - shown) / (0.05 + np.abs(shown))
        if error.max() > TOLERANCES.get(case[0], 2e-5):
            wrong[case] = float(error.max())
    assert not wrong


KEPT = ("packed byte", "packed float", "generated byte", "generated float")


def kept(folder, kind, mode):
    """An image of one texel that Cycles takes from Blender."""
    texel = np.array([[[0.2, 0.4, 0.1, 0.6]]])
    if kind.startswith("packed"):
        image = stored(folder, "byte linear" if kind == "packed byte" else "float linear", mode, texel)
        image.pack()
        return image
    image = bpy.data.images.new("kept", 1, 1, alpha=True, float_buffer=kind == "generated float")
    image.alpha_mode, image.colorspace_settings.name = mode, "Linear Rec.709"
    image.pixels.foreach_set(texel.astype(np.float32).ravel())
    return image


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("alpha", ["unused", "used"])
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", KEPT)
def test_images_that_blender_keeps_are_read_as_cycles_reads_them_or_refused(kind, mode, alpha, tmp_path):
    """From Blender 5.1 on, Cycles treats these alpha modes in another way.

    It multiplies floats said to be straight again, and bytes said to be multiplied not at all.
    """
    scene = prepare("ORTHO", 4, 4)
    scene.camera.data.ortho_scale = 1
    scene.camera.location = (0.5, 0.5, 10)
    image = kept(tmp_path, kind, mode)
    material = glowing("glow", through_emission(image_case(lambda: image, alpha, interpolation="Closest")))
    quad("glow", (0.5, 0.5, 0), 0.0, False).materials.append(material)
    read_material(material, ImageTable(), refusals := [])
    if FOLLOWED and mode == ("STRAIGHT" if kind.endswith("float") else "PREMUL"):
        (refusal,) = refusals
        assert f"alpha {mode.title()} of an image that Blender keeps" in str(refusal)
        return
    shown = rendered(scene, tmp_path)[:, 1, 1]
    np.testing.assert_allclose(predicted(material, Points({"UV": np.full((3, 1), 0.5)}))[:, 0], shown, rtol=2e-5)
