# SPDX-License-Identifier: GPL-3.0-or-later
"""The chosen form of masking reaches every microfacet, those that refract too."""

import numpy as np
import pytest
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.materials import Glass, Glossy, Metallic, Refraction
from etalon.lib.settings.reference import MASKING, Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import floor, material, orthographic, scene

HALF, IOR = Constant(0.8), Constant(1.5)


@pytest.mark.parametrize(
    ("closure", "forms"),
    [
        (Glossy("GGX", roughness=HALF), 3),
        (Metallic("BECKMANN", roughness=HALF), 3),
        (Glass(ior=IOR, roughness=HALF), 3),
        (Glass(ior=IOR, roughness=HALF, distribution="BECKMANN"), 3),
        (Refraction(ior=IOR, roughness=HALF), 2),
    ],
)
def test_every_facet_is_masked_as_asked(closure, forms, seed):
    """A grazing view of a plane in a white world: its albedo by that form.

    Refraction alone has no Torrance-Sparrow.
    """
    view = orthographic(2, 2, 0.1, (0.0, -5.0, 1.5), (0.0, 1.0, -0.3))
    plane = scene(floor(), material(closure), view, world=1.0)
    images = [
        ReferenceRenderer(plane, Options(threads=1, seed=seed, masking=form)).render(0, 64).radiance for form in MASKING
    ]
    assert np.all(np.isfinite(images))
    assert len({image.tobytes() for image in images}) == forms
    departed = Options(threads=1, seed=seed, masking="separable", departures=frozenset({"correlated masking"}))
    np.testing.assert_array_equal(ReferenceRenderer(plane, departed).render(0, 64).radiance, images[0])
