# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiled images (UDIM): a file a tile, magenta where there is none, and against Cycles."""

import bpy
import numpy as np
import OpenImageIO
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes.image_files import tile_path
from etalon.addon.export.nodes.images import ImageTable
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
    """The texel in the middle row and the third column of four; to the left of tile 1001 the tile repeats."""
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
