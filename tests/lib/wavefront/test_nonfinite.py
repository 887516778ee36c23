# SPDX-License-Identifier: GPL-3.0-or-later
"""What is not finite is counted and shown, never zeroed.

The pixels that met it are NaN, all others are as they were.
"""

import numpy as np
import pytest
from etalon.lib.scene.expressions import Constant, Coordinates, EnvironmentTexture
from etalon.lib.scene.images import Image
from etalon.lib.scene.materials import Emission
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import color, diffuse, floor, material, orthographic, perspective, quad, scene

BAD = pytest.mark.parametrize("bad", [np.inf, np.nan], ids=["inf", "nan"])
DIRECT = pytest.mark.parametrize("direct", ["mis", "lights", "bsdf"])


def render(the_scene, seed, samples=4, **options):
    return ReferenceRenderer(the_scene, Options(seed=seed, threads=1, russian_roulette=False, **options)).render(
        0, samples
    )


@BAD
@DIRECT
@pytest.mark.parametrize("where", ["color", "strength"])
def test_an_emitter_that_is_not_finite(bad, direct, where, seed):
    """Two patches side by side, seen by the camera alone.

    All samples of the bad one's pixels are counted.
    """
    emitter = Emission(color(bad, 1.0, 1.0)) if where == "color" else Emission(color(1.0), Constant(bad))
    parts = [
        quad((-1.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), 0),
        quad((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), 1),
    ]
    both = scene(parts, [material(emitter), material(Emission(color(2.0)))], orthographic(4, 4, 2.0, (0.0, 0.0, 1.0)))
    rendering = render(both, seed, direct=direct)
    assert np.isnan(rendering.radiance[:, :2]).all()
    np.testing.assert_array_equal(rendering.nonfinite[:, :2], 4)
    np.testing.assert_allclose(rendering.radiance[:, 2:], 2.0, rtol=1e-12)
    assert not rendering.nonfinite[:, 2:].any()


@BAD
@DIRECT
def test_light_from_it_spoils_what_it_reaches_only(bad, direct, seed):
    """A floor behind a wall: this side is lit by the bad emitter, the other by a good one."""
    parts = [
        floor(5.0),
        quad((0.0, -50.0, -1.0), (0.0, 100.0, 0.0), (0.0, 0.0, 50.0), 1),
        quad((-1.5, -1.0, 1.0), (0.0, 2.0, 0.0), (1.0, 0.0, 0.0), 2),
        quad((0.5, -1.0, 1.0), (0.0, 2.0, 0.0), (1.0, 0.0, 0.0), 3),
    ]
    materials = [diffuse(0.8), material(), material(Emission(color(bad))), material(Emission(color(2.0)))]
    rendering = render(scene(parts, materials, orthographic(4, 4, 2.0, (0.0, 0.0, 0.9))), seed, 64, direct=direct)
    assert np.isnan(rendering.radiance[:, :2]).all()
    assert (rendering.nonfinite[:, :2] > 0).all()
    assert np.isfinite(rendering.radiance[:, 2:]).all()
    assert (rendering.radiance[:, 2:] > 0.01).all()
    assert not rendering.nonfinite[:, 2:].any()


@BAD
@pytest.mark.parametrize("direct", ["mis", "bsdf"])
def test_an_environment_with_a_bad_texel(bad, direct, seed):
    """Seen by the camera it is NaN where it is, and nowhere else."""
    pixels = np.ones((4, 8, 4), np.float32)
    pixels[2, 6, 0] = bad  # columns 6 to 7 of 8: behind the camera's right, rows from below
    world = World(EnvironmentTexture(Coordinates("GENERATED"), 0, "CLOSEST"), (8, 4))
    # Blender's u = 1/2 - phi / 2 pi: the texel's middle at u = 6.5 / 8, v = 2.5 / 4 from below.
    phi, theta = 2.0 * np.pi * (0.5 - 6.5 / 8.0), np.pi * (1.0 - 2.5 / 4.0)
    towards = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    for forward, spoiled in ((towards, True), (-towards, False)):
        camera = perspective(2, 2, 0.05, (0.0, 0.0, 10.0), forward)
        rendering = render(
            scene(floor(0.1), diffuse(0.5), camera, world=world, images=[Image("sky", pixels, "LINEAR")]),
            seed,
            direct=direct,
        )
        assert np.isnan(rendering.radiance).all() == spoiled
        assert (rendering.nonfinite == (4 if spoiled else 0)).all()
        if not spoiled:
            np.testing.assert_allclose(rendering.radiance, 1.0)


@BAD
def test_a_colour_that_is_not_finite(bad, seed):
    """A diffuse surface of such a colour, beside a good one, under a sky."""
    parts = [
        quad((-1.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), 0),
        quad((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), 1),
    ]
    both = scene(parts, [diffuse(bad), diffuse(0.5)], orthographic(4, 4, 2.0, (0.0, 0.0, 1.0)), world=1.0)
    rendering = render(both, seed)
    assert np.isnan(rendering.radiance[:, :2]).all()
    assert (rendering.nonfinite[:, :2] > 0).all()
    np.testing.assert_allclose(rendering.radiance[:, 2:], 0.5, rtol=1e-12)
