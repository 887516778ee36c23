# SPDX-License-Identifier: GPL-3.0-or-later
"""Images on a dome by projections, against Cycles.

The projections need a normal, a position or a direction.
"""

import numpy as np
import pytest
from etalon.addon.export.nodes.sky import render_skies
from etalon.tests.addon.export.nodes.node_cells import glowing, node, stored_image
from etalon.tests.addon.export.nodes.test_normals_against_cycles import BENT, lifted, seen

pytestmark = pytest.mark.compares_with_cycles


def dome(studio):
    """A dome over a square, steep enough that its normals turn to three faces of a box."""
    x, y = (g.ravel() for g in np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 9)))
    faces = [(k, k + 1, k + 10, k + 9) for k in (9 * j + i for j in range(8) for i in range(8))]
    mesh = studio.mesh("dome", np.stack([x, y, np.sqrt(2.2 - x * x - y * y)], axis=1), faces)
    mesh.shade_smooth()
    return mesh


def difference(studio, rays, hits, build):
    """The largest difference between Cycles and the reference over the dome.

    Also returns how much the picture varies.
    """
    mesh = dome(studio)
    mesh.materials.append(glowing("glow", lambda t: node(t, "Emission", {"Color": lifted(t, build(t))})))
    studio.add("dome", mesh, BENT)
    studio.look_down(3.0)
    scene = render_skies(studio.export())
    (lobe,) = scene.materials[0].lobes
    shown, got = seen(studio, scene, lobe.closure.color, rays, hits)
    return np.abs(shown - (got - 4.0)).max(axis=0), shown.std()


@pytest.mark.parametrize("blend", [0.0, 0.3, 1.0])
def test_box_projection_is_that_of_cycles(blend, studio, rays, hits, tmp_path, rng):
    image = stored_image(tmp_path, "box", "exr", "Linear Rec.709", "PREMUL", True, rng)

    def build(tree):
        inputs = {"Vector": node(tree, "TexCoord", output="Object")}
        return node(tree, "TexImage", inputs, image=image(), projection="BOX", projection_blend=blend)

    error, spread = difference(studio, rays, hits, build)
    assert spread > 0.02
    if blend == 0.0:  # a pixel on an edge may belong to either face
        assert (error > 1e-4).mean() < 0.005
    else:
        assert error.max() < 1e-4


@pytest.mark.parametrize("projection", ["EQUIRECTANGULAR", "MIRROR_BALL"])
@pytest.mark.parametrize("linked", [False, True])
def test_environment_textures_on_surfaces_are_those_of_cycles(projection, linked, studio, rays, hits, tmp_path, rng):
    """Without a link they are read at the position."""
    image = stored_image(tmp_path, "around", "exr", "Linear Rec.709", "PREMUL", True, rng)

    def build(tree):
        inputs = {"Vector": node(tree, "NewGeometry", output="Normal")} if linked else {}
        return node(tree, "TexEnvironment", inputs, image=image(), projection=projection)

    error, spread = difference(studio, rays, hits, build)
    assert spread > 0.02
    # Cycles' arc cosine of z in single precision is off by sqrt(2 * 2**-24) at the pole, of pi for the image's 4 rows: 4.4e-4 rows.
    assert error.max() < 4.5e-4


@pytest.mark.parametrize("linked", [False, True])
def test_skies_on_surfaces_are_those_of_cycles(linked, studio, rays, hits):
    """Without a link they are read at the generated coordinates, which are no unit vectors."""

    def build(tree):
        inputs = {"Vector": node(tree, "NewGeometry", output="Normal")} if linked else {}
        return node(tree, "TexSky", inputs, sun_disc=False)

    error, spread = difference(studio, rays, hits, build)
    assert spread > 0.005
    assert error.max() < 2e-3
