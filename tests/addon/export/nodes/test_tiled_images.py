# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiled images (UDIM): a file a tile, magenta where there is none, and against Cycles."""

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.image_files import tile_path
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.errors import Refused
from etalon.lib.scene import expressions as ex
from etalon.lib.textures.fold import walk
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

TILES = (1001, 1002, 1011, 1022)
GONE = 1012
"""A tile of the image whose file is not there."""


def tiled(folder, numbers, pattern="<UDIM>", alpha=False, space="Linear Rec.709"):
    texels = numbers.random((len(TILES), 3, 4, 4 if alpha else 3)).astype(np.float32)
    for number, pixels in zip((*TILES, GONE), (*texels, texels[0]), strict=True):
        buffer = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(4, 3, pixels.shape[2], OpenImageIO.FLOAT))
        buffer.set_pixels(OpenImageIO.ROI(), pixels)
        assert buffer.write(tile_path(str(folder / f"wall.{pattern}.exr"), number))
    image = bpy.data.images.load(tile_path(str(folder / f"wall.{pattern}.exr"), 1001))
    image.source = "TILED"
    image.filepath = str(folder / f"wall.{pattern}.exr")
    image.colorspace_settings.name = space
    for number in (*TILES[1:], GONE):
        image.tiles.new(number)
    (folder / tile_path(f"wall.{pattern}.exr", GONE)).unlink()
    return image


def scaled(image, alpha=False, **options):
    """Over a quad, from tile -1.5 to tile 4.5 both ways."""

    def build(tree):
        uv = node(tree, "TexCoord", output="UV")
        vector = node(tree, "Mapping", {"Vector": uv, "Scale": (6.0, 6.0, 1.0), "Location": (-1.5, -1.5, 0)})
        made = node(tree, "TexImage", {"Vector": vector}, image=image, **options)
        return made.node.outputs["Alpha"] if alpha else made

    return build


@pytest.mark.parametrize(
    ("pattern", "path"), [("/a/b.<UDIM>.png", "/a/b.1023.png"), ("/a/<UVTILE>.png", "/a/u3_v3.png"), ("/a/b.png", None)]
)
def test_the_path_of_a_tile(pattern, path):
    assert tile_path(pattern, 1023) == path


@pytest.mark.parametrize("pattern", ["<UDIM>", "<UVTILE>"])
def test_every_tile_shows_its_own_file(pattern, tmp_path, rng):
    image = tiled(tmp_path, rng, pattern)
    before = set(bpy.data.images.keys())
    images = ImageTable()
    (lobe,) = read_material(glowing("wall", through_emission(scaled(image))), images, refusals := []).lobes
    assert not refusals
    assert set(bpy.data.images.keys()) == before
    shown = {one.number: one.inside.image for one in walk(lobe.closure.color) if isinstance(one, ex.Tile)}
    assert sorted(shown) == sorted(TILES)
    for number, index in shown.items():
        file = OpenImageIO.ImageBuf(tile_path(image.filepath, number)).get_pixels(OpenImageIO.FLOAT)[::-1]
        np.testing.assert_array_equal(images.images[index].pixels[..., :3], file)
    (missing,) = images.missing
    assert tile_path(image.filepath, GONE) in missing


@pytest.mark.parametrize(
    ("place", "expected"),
    [((1.625, 0.5), (1002, 1, 2)), ((-0.375, 0.5), (1001, 1, 2)), ((1.5, 1.5), None), ((3.5, 0.5), None)],
)
def test_a_point_shows_the_texel_of_its_tile_or_magenta(place, expected, tmp_path, rng):
    """The texel in the middle row and the third column of four.

    To the left of tile 1001 the tile repeats.
    """
    image = tiled(tmp_path, rng)
    material = glowing("wall", through_emission(lambda tree: node(tree, "TexImage", image=image)))
    got = predicted(material, Points({"UV": np.array([[*place, 0.0]]).T}))
    color = (1.0, 0.0, 1.0)
    if expected:
        number, row, column = expected
        color = OpenImageIO.ImageBuf(tile_path(image.filepath, number)).get_pixels(OpenImageIO.FLOAT)[row, column]
    np.testing.assert_allclose(got[:, 0], color, rtol=1e-6)


def test_projections_of_tiled_images_are_refused(tmp_path, rng):
    material = glowing("wall", through_emission(scaled(tiled(tmp_path, rng), projection="SPHERE")))
    read_material(material, ImageTable(), refusals := [])
    (refusal,) = refusals
    assert "projection Sphere of a tiled image" in str(refusal)


@pytest.mark.compares_with_cycles
def test_tiles_are_those_of_cycles(tmp_path, rng):
    scene = prepare("ORTHO", 8 * 4 * CELL, 4 * CELL)
    plain = tiled(tmp_path, rng)
    (tmp_path / "alpha").mkdir()
    covered = tiled(tmp_path / "alpha", rng, alpha=True, space="sRGB")
    cases = {
        **{extension: scaled(plain, extension=extension) for extension in ("REPEAT", "EXTEND", "MIRROR")},
        "closest": scaled(plain, interpolation="Closest"),
        "multiplied": scaled(covered),
        "alpha": scaled(covered, alpha=True),
        "direct": lambda tree: node(tree, "TexImage", image=plain),
        "UV": lambda tree: node(tree, "TexCoord", output="UV"),
    }
    assert len(cases) == 8
    scene.camera.data.ortho_scale = len(cases)
    scene.camera.location = (len(cases) / 2, 0.5, 10)
    materials = {}
    for index, (name, build) in enumerate(cases.items()):
        materials[name] = glowing(name, through_emission(build))
        quad(name, (index + 0.5, 0.5, 0), 0.0, False).materials.append(materials[name])
    picture = rendered(scene, tmp_path)
    cells = picture.reshape(3, 4 * CELL, len(cases), 4 * CELL).transpose(2, 0, 1, 3).reshape(len(cases), 3, -1)
    points = Points({"UV": cells[-1]})
    wrong = {}
    for shown, name in zip(cells, list(cases)[:-1], strict=False):
        error = np.abs(predicted(materials[name], points) - shown) / (0.05 + np.abs(shown))
        if error.max() > 5e-5:
            wrong[name] = float(error.max()), float((error.max(axis=0) > 5e-5).mean())
    assert not wrong


def spread(studio, image, corners, lift=None):
    """A square metre with these texture coordinates.

    They are linked directly or through a Mapping node that lifts them in z.
    """

    def build(tree):
        uv = node(tree, "TexCoord", output="UV")
        if lift is not None:
            uv = node(tree, "Mapping", {"Vector": uv, "Location": (0.0, 0.0, lift)})
        return node(tree, "TexImage", {"Vector": uv}, image=image)

    mesh = studio.mesh("wall", np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float), [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new(name="UVMap")
    for place, corner in zip(layer.data, corners, strict=True):
        place.uv = corner
    mesh.materials.append(glowing("wall", through_emission(build)))
    studio.add("wall", mesh)


OVER_THREE_ROWS = ((0.2, 0.2), (0.8, 0.2), (0.8, 2.8), (0.2, 2.8))
WITHIN_TILES = ((0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0))
"""Its upper corners lie on the border of tile 1011, and count to it."""


@pytest.mark.parametrize("lift", [None, 0.0])
def test_a_tile_without_a_corner_of_the_faces_that_show_it_is_refused(lift, studio, tmp_path, rng):
    """A Mapping node that changes nothing changes nothing."""
    spread(studio, tiled(tmp_path, rng), OVER_THREE_ROWS, lift)
    with pytest.raises(Refused, match="tile 1011 of an image, which faces reach over"):
        studio.export()


@pytest.mark.parametrize(("corners", "lift"), [(OVER_THREE_ROWS, 1.0), (WITHIN_TILES, None)])
def test_tiles_that_cycles_loads_are_not_refused(corners, lift, studio, tmp_path, rng):
    spread(studio, tiled(tmp_path, rng), corners, lift)
    assert len(studio.export().images) == len(TILES)


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("lift", [None, 0.0, 1.0])
def test_cycles_shows_magenta_in_a_tile_without_a_corner(lift, studio, tmp_path, rng):
    spread(studio, tiled(tmp_path, rng), OVER_THREE_ROWS, lift)
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("above")
    camera.type, camera.ortho_scale = "ORTHO", 1.0
    scene.camera = bpy.data.objects.new("above", camera)
    scene.camera.location = (0.5, 0.5, 10)
    scene.collection.objects.link(scene.camera)
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "CYCLES", 9, 9
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.max_bounces = 1, False, 0
    middle = rendered(scene, tmp_path)[:, 4, 4]
    assert np.allclose(middle, (1.0, 0.0, 1.0)) == (lift != 1.0)
