# SPDX-License-Identifier: GPL-3.0-or-later
"""Converter and Color nodes and procedural textures against Cycles itself.

The pictures are the same as for other nodes.
"""

import numpy as np
import pytest
from etalon.tests.addon.export.nodes.converter_cases import CONVERTED, CURVED_CASES, EXTRA, PATTERNS
from etalon.tests.addon.export.nodes.node_cases import COORDINATES
from etalon.tests.addon.export.nodes.node_cells import (
    CELL,
    FACING,
    Points,
    glowing,
    predicted,
    prepare,
    quad,
    read_tabulated,
    rendered,
    through_emission,
)

pytestmark = pytest.mark.compares_with_cycles


@pytest.fixture(scope="module")
def cells(tmp_path_factory):
    """Case -> what Cycles shows, what we predict."""
    cases = {name: (build, FACING) for name, build in COORDINATES.items()} | EXTRA
    side = int(np.ceil(np.sqrt(len(cases))))
    scene = prepare("ORTHO", side * CELL, side * CELL)
    scene.camera.data.ortho_scale = side
    scene.camera.location = (side / 2, side / 2, 10)
    materials = {}
    for index, (name, (build, (tilt, flipped))) in enumerate(cases.items()):
        mesh = quad(name, (index % side + 0.5, index // side + 0.5, 0), tilt, flipped)
        materials[name] = glowing(name, through_emission(build))
        mesh.materials.append(materials[name])
    picture = rendered(scene, tmp_path_factory.mktemp("converted"))
    shown = {}
    for index, name in enumerate(cases):
        row, column = index // side * CELL, index % side * CELL
        shown[name] = picture[:, row : row + CELL, column : column + CELL].reshape(3, -1)
    points = Points({kind: shown[kind] for kind in COORDINATES})
    return {name: (shown[name], predicted(materials[name], points, read_tabulated)) for name in EXTRA}


def apart(shown, got):
    """Relative differences, the largest channel of each point, in ascending order."""
    return np.sort((np.abs(got - shown) / (0.05 + np.abs(shown))).max(axis=0))


@pytest.mark.parametrize("name", CONVERTED)
def test_converter(cells, name):
    shown, got = cells[name]
    assert np.ptp(shown) > 0.0
    tolerance = {"vector math DIVIDE": 1e-3, "vector math MODULO": 1e-3, "blackbody": 5e-4}.get(name, 3e-5)
    assert apart(shown, got)[-1] < tolerance


@pytest.mark.parametrize("name", CURVED_CASES)
def test_curve(cells, name):
    """Cycles reads curves from tables of 257 entries.

    Beyond their ends it goes on from the last two.
    """
    shown, got = cells[name]
    assert apart(shown, got)[-1] < 3e-5


@pytest.mark.parametrize("name", PATTERNS)
def test_pattern(cells, name):
    """Steps fall elsewhere by rounding: a point in a hundred may differ."""
    shown, got = cells[name]
    differences = apart(shown, got)
    assert differences[int(0.99 * differences.size)] < 3e-5
