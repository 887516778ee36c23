# SPDX-License-Identifier: GPL-3.0-or-later
"""Unknown materials.

The pixels whose paths met none are what they would be with any material in its place.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.plan import make_plan
from etalon.lib.scene.lights import AreaLight
from etalon.lib.scene.materials import Diffuse, Emission, Glossy, Material, Transparent
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.kernel import Kernel
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import color, diffuse, floor, material, perspective, quad, scene

LAMP = AreaLight(
    "lamp", (0.0, 0.0, 4.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", (9.0, 9.0, 9.0), np.pi
)
STAND_INS = {
    "diffuse": Diffuse(color(0.9, 0.1, 0.1)),
    "glossy": Glossy("GGX", color(1.0)),
    "transparent": Transparent(color(0.2, 0.5, 0.9)),
    "emission": Emission(color(3.0)),
}


def room(sheet, bounces=2):
    """A floor, a mirror, a sheet, and a veil before a part of them.

    The mirror stands on the floor at the left, the sheet hovers at the right.
    """
    parts = [
        floor(4.0, material=0),
        quad((-2.0, -3.0, 0.0), (0.0, 6.0, 0.0), (0.0, 0.0, 2.0), 1),
        quad((1.5, -0.5, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 2),
        quad((-4.0, -3.5, 0.0), (8.0, 0.0, 0.0), (0.0, 0.0, 0.7), 3),
    ]
    materials = [diffuse(0.7), material(Glossy("GGX", color(0.9))), sheet, material(Transparent(color(0.8)))]
    view = perspective(24, 16, 0.6, (0.0, -9.0, 5.0), (0.0, 9.0, -5.0))
    return scene(parts, materials, view, lights=[LAMP], world=0.3, bounces=bounces)


def render(of, seed):
    return ReferenceRenderer(of, Options(seed=seed, threads=1, russian_roulette=False)).render(0, 16)


@pytest.mark.parametrize("stand_in", STAND_INS)
def test_pixels_that_met_none_are_as_with_any_material_there(stand_in, seed, monkeypatch):
    """The pixels are exactly the same, whatever way a path may take, with lights chosen alike.

    Ways are by the camera, in the mirror, by rays off the floor, by shadow rays, and behind the veil. Light that is not
    known to be a light source is never sampled, so that an emitter is found by rays alone.
    """
    # A clear sheet lets more light arrive than one that is not known.
    monkeypatch.setattr(Kernel, "_arriving", lambda self, like: None)
    known = room(material(STAND_INS[stand_in]))
    if stand_in == "emission":
        known = replace(known, lights=())
    partial = replace(known, materials=(*known.materials[:2], Material("sheet", (), "a node"), known.materials[3]))
    options = Options(seed=seed, threads=1, russian_roulette=False, direct="bsdf" if stand_in == "emission" else "mis")
    whole, part = (ReferenceRenderer(one, options, make_plan(one).forcing()).render(0, 16) for one in (known, partial))
    met = part.unknown > 0
    assert whole.unknown is None
    assert 0.05 < met.mean() < 0.95
    np.testing.assert_array_equal(part.radiance[~met], whole.radiance[~met])
    assert (part.radiance[met] != whole.radiance[met]).any(axis=1).mean() > 0.5


def test_what_might_shine_is_met_by_the_last_rays(seed):
    """In the dark and without bounces nothing needs rays off the floor.

    The sheet may still be a light.
    """
    dark = replace(room(Material("sheet", (), "a node"), bounces=0), lights=())
    met = render(dark, seed).unknown > 0
    seen = (
        render(
            replace(dark, materials=(Material("floor", ()), Material("mirror", ()), *dark.materials[2:])), seed
        ).unknown
        > 0
    )
    assert (met & ~seen).sum() > seen.sum() > 0
