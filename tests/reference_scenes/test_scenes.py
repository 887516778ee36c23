# SPDX-License-Identifier: GPL-3.0-or-later
"""Every reference scene builds and exports.

The two with closed forms are what Cycles renders, too.
"""

from math import pi

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.job import export
from etalon.lib.errors import EtalonError
from etalon.lib.microfacets.albedo import directional_albedo
from etalon.reference_scenes import SCENES, build, furnace, lambert_analytic, save


@pytest.mark.parametrize("name", SCENES)
def test_every_scene_builds_and_exports(name):
    build(name)
    scene = export(bpy.context.scene)
    module = SCENES[name]
    assert scene.name == name
    assert scene.mesh.triangle_count > 0
    if hasattr(module, "WIDTH"):
        assert (scene.camera.width, scene.camera.height) == (module.WIDTH, module.HEIGHT)


def test_a_saved_scene_opens_again(tmp_path):
    save("lambert_analytic", tmp_path / "a.blend")
    assert [path.name for path in tmp_path.iterdir()] == ["a.blend"]
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert bpy.context.scene.name == "lambert_analytic"


def test_names_that_are_none_are_refused():
    with pytest.raises(EtalonError, match="teapot: no reference scene of that name; there are glossy_spheres"):
        build("teapot")


def lambert(points):
    """Irradiance over radiance (n,) at `points` (n, 2) of the plane: Arvo 1995, eq. 2.33."""
    center, size = np.array(lambert_analytic.LIGHT_CENTER), lambert_analytic.LIGHT_SIZE
    corners = [
        center + np.array([0.5 * sx * size[0], 0.5 * sy * size[1], 0.0])
        for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    toward = [c - np.column_stack([points, np.zeros(len(points))]) for c in corners]
    toward = [v / np.linalg.norm(v, axis=1, keepdims=True) for v in toward]
    total = np.zeros(len(points))
    for a, b in zip(toward, toward[1:] + toward[:1], strict=True):
        normal = np.cross(a, b)
        total += np.arccos((a * b).sum(axis=1)) * normal[:, 2] / np.linalg.norm(normal, axis=1)
    return 0.5 * np.abs(total)


@pytest.mark.compares_with_cycles
def test_lambert_of_cycles_is_the_closed_form():
    """Blocks of 32 x 32 pixels.

    Within a block the irradiance is averaged over four points a pixel.
    """
    build("lambert_analytic")
    size, across = lambert_analytic.WIDTH, lambert_analytic.ACROSS
    shown = CyclesRenderer(bpy.context.scene, threads=2).render(0, 4).radiance
    at = ((np.arange(2 * size) + 0.5) / (2 * size) - 0.5) * across
    x, y = np.meshgrid(at, -at)
    irradiance = lambert(np.column_stack([x.ravel(), y.ravel()])).reshape(size, 2, size, 2).mean(axis=(1, 3))
    expected = irradiance[..., None] * np.array(lambert_analytic.LIGHT) * lambert_analytic.ALBEDO / pi
    blocks = [image.reshape(8, 32, 8, 32, 3).mean(axis=(1, 3)) for image in (shown, expected)]
    np.testing.assert_allclose(blocks[0], blocks[1], rtol=0.01)
    assert blocks[0].mean() == pytest.approx(blocks[1].mean(), rel=1e-3)


@pytest.mark.compares_with_cycles
def test_the_furnace_of_cycles_is_the_directional_albedo():
    """The GGX rows: E(mu) by quadrature. The rim of each tile is left out."""
    build("furnace")
    shown = CyclesRenderer(bpy.context.scene, threads=2).render(0, 8).radiance
    tile, tilts = furnace.TILE, np.array(furnace.TILTS)
    tiles = shown.reshape(len(furnace.ROWS) + 2, tile, len(tilts) + 2, tile, 3)[1:-1, 4:-4, 1:-1, 4:-4].mean(
        axis=(1, 3)
    )
    for row, (kind, alpha) in enumerate(furnace.ROWS):
        if kind == "GGX":
            expected = directional_albedo(np.cos(tilts), np.full(len(tilts), alpha))
            np.testing.assert_allclose(tiles[row], np.repeat(expected[:, None], 3, axis=1), rtol=0.01)
