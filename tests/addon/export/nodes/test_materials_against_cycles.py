# SPDX-License-Identifier: GPL-3.0-or-later
"""Every supported node, driven by texture coordinates, against Cycles itself.

One orthographic render shows one quad per case; its material glows with the node under test. One sample per pixel falls on the
pixel's centre and has no noise. The coordinates the prediction starts from are those that Cycles renders in a cell of its own.
"""

import zlib

import numpy as np
import pytest
from etalon.addon.export.materials import read_material
from etalon.addon.export.nodes import images as images_of_blender
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.scene import expressions as ex
from etalon.lib.textures.evaluate import Evaluator
from etalon.lib.textures.images import ImageSet
from etalon.lib.textures.ramp import color_ramp
from etalon.tests.addon.export.nodes.node_cases import CASES, COORDINATES, RAMPS, image_cases, space_cases
from etalon.tests.addon.export.nodes.node_cells import (
    CELL,
    FACING,
    Points,
    assert_same,
    glowing,
    linearize_in_half_precision,
    predicted,
    prepare,
    quad,
    rendered,
    through_emission,
)

pytestmark = pytest.mark.compares_with_cycles

RAMP_ENTRIES = 257


@pytest.fixture(scope="module")
def cells(tmp_path_factory):
    """Case -> (material, what Cycles shows, what we predict, the points)."""
    folder = tmp_path_factory.mktemp("cells")
    numbers = np.random.default_rng(zlib.crc32(b"cells"))
    cases = {name: (build, FACING) for name, build in COORDINATES.items()}
    cases |= CASES
    cases |= {name: (build, FACING) for name, build in RAMPS.items()}
    cases |= {name: (build, FACING) for name, build in image_cases(folder, numbers)}
    cases |= {name: (build, FACING) for name, build in space_cases(folder, numbers)}
    side = int(np.ceil(np.sqrt(len(cases))))
    scene = prepare("ORTHO", side * CELL, side * CELL)
    scene.camera.data.ortho_scale = side
    scene.camera.location = (side / 2, side / 2, 10)
    materials = {}
    for index, (name, (build, (tilt, flipped))) in enumerate(cases.items()):
        mesh = quad(name, (index % side + 0.5, index // side + 0.5, 0), tilt, flipped)
        materials[name] = glowing(name, build if "shader" in name else through_emission(build))
        mesh.materials.append(materials[name])
    picture = rendered(scene, folder)
    shown = {}
    for index, name in enumerate(cases):
        row, column = index // side * CELL, index % side * CELL
        shown[name] = picture[:, row : row + CELL, column : column + CELL].reshape(3, -1)
    coordinates = {kind: shown[kind] for kind in COORDINATES}
    coordinates["OBJECT"] = shown["UV"] - np.array([[0.5], [0.5], [0.0]])
    points = {}
    for index, (name, (_, stance)) in enumerate(cases.items()):
        corner = np.array([[index % side], [index // side], [0.0]])
        points[name] = Points({**coordinates, "POSITION": shown["UV"] + corner}, stance)
    return {
        # What colour spaces give is predicted in the test that needs it: each conversion reads Blender's whole configuration.
        name: (
            materials[name],
            shown[name],
            None if " in " in name else predicted(materials[name], points[name]),
            points[name],
        )
        for name in cases
    }


def test_coordinates_are_those_of_the_geometry(cells):
    centre = (np.arange(CELL) + 0.5) / CELL
    expected = np.stack([np.tile(centre, CELL), np.repeat(centre, CELL), np.zeros(CELL * CELL)])
    assert_same(expected, cells["UV"][1], 1e-3)  # sample 0 lies 0.0005 pixels from the centre
    assert_same(expected + np.array([[0], [0], [0.5]]), cells["GENERATED"][1], 1e-3)
    assert_same(cells["OBJECT"][2], cells["OBJECT"][1], 1e-3)


@pytest.mark.parametrize("name", CASES)
def test_node_shows_what_cycles_shows(cells, name):
    _, shown, got, _ = cells[name]
    # 4.5 has an older matrix behind its luminance, off by 3.5e-5; divisions and products near a pole amplify float32.
    tolerance = {"luminance": 1e-4, "group": 1e-4, "mix DODGE": 1e-3, "mix DIVIDE": 2e-4}.get(name, 2e-5)
    assert_same(got, shown, tolerance)


@pytest.mark.parametrize("name", RAMPS)
def test_cycles_ramp_is_a_table_of_ours(cells, name):
    """Cycles tabulates the ramp; our exact ramp, tabulated as densely, is what it shows."""
    material, shown, _, points = cells[name]
    images = ImageTable()
    (lobe,) = read_material(material, images, []).lobes
    ramp = lobe.closure.color
    ramp = ramp.value if isinstance(ramp, ex.ValueToColor) else ramp
    x = np.clip(Evaluator(points, ImageSet(()))(ramp.factor), 0, 1) * (RAMP_ENTRIES - 1)
    table = np.atleast_2d(color_ramp(ramp, np.arange(RAMP_ENTRIES) / (RAMP_ENTRIES - 1)))
    low = np.floor(x + 1e-5).astype(int)
    high = np.minimum(low + 1, RAMP_ENTRIES - 1)
    t = 0 if ramp.interpolation == "CONSTANT" and ramp.mode == "RGB" else x - low
    assert_same((1 - t) * table[:, low] + t * table[:, high], shown, 2e-5)


def test_ramp_is_blenders_own(cells):
    """Between the table's entries the exact ramp is what Blender itself evaluates."""
    x = np.linspace(0, 1, 338)
    for name in RAMPS:
        material = cells[name][0]
        (made,) = (n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeValToRGB")
        (lobe,) = read_material(material, ImageTable(), []).lobes
        ramp = lobe.closure.color
        ramp = ramp.value if isinstance(ramp, ex.ValueToColor) else ramp
        truth = np.array([made.color_ramp.evaluate(v) for v in x]).T
        truth = truth[:3] if ramp.output == "COLOR" else truth[3]
        np.testing.assert_allclose(color_ramp(ramp, x), truth, atol=3e-6)


def test_images_are_sampled_as_cycles_samples(cells):
    names = [name for name in cells if name.startswith("image")]
    assert len(names) > 20
    for name in names:
        _, shown, got, _ = cells[name]
        # Cycles multiplies alpha in at the file's 16 bits and, 5.2, raises to 2.4 with a polynomial.
        assert_same(got, shown, 2e-3 if "16.png" in name else 2e-5)


@pytest.mark.parametrize("step", [6, pytest.param(1, marks=pytest.mark.slow)])
def test_color_spaces_are_linearized_as_cycles_does(cells, monkeypatch, step):
    """Of bytes Cycles keeps the codes and their decoded values in half precision.

    Curves of logarithms enlarge the error of that; so does this test.
    """
    names = [name for name in cells if " in " in name and name.startswith(("png", "exr"))]
    assert len(names) > 20
    names = names[::step]
    with monkeypatch.context() as patch:
        patch.setattr(images_of_blender, "linearize", linearize_in_half_precision)
        errors = {}
        for name in names:
            material, shown, _, points = cells[name]
            error = np.abs(predicted(material, points) - shown) / (0.05 + np.abs(shown))
            errors[name] = float(error.max())
    # The two versions of OpenColorIO may round a value to neighbours in half precision.
    wrong = {name: error for name, error in errors.items() if error > (1e-3 if name.startswith("png") else 2e-5)}
    assert not wrong


def test_decoding_first_is_another_picture(cells):
    """The named departure is visible: an 8-bit sRGB image differs by per cents between texels."""
    material, shown, _, points = cells["image png sRGB"]
    images = ImageTable()
    (lobe,) = read_material(material, images, []).lobes
    by_the_book = Evaluator(points, ImageSet(images.images))(lobe.closure.color)
    assert np.abs(by_the_book - shown).max() > 0.01
