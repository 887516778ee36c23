# SPDX-License-Identifier: GPL-3.0-or-later
"""Wireframe: the share of a square that its lines cover.

They lie within half the width of its edges and its diagonal.
"""

import numpy as np
import pytest
from etalon.lib.scene.expressions import Constant, ValueToColor, Wireframe
from etalon.lib.scene.materials import Emission
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests import scenes

COUNT = 1 << 14


@pytest.mark.parametrize("size", [0.1, -0.1, 0.3, 0.7])
@pytest.mark.parametrize("slope", [0.0, 1.0])
def test_the_wire_covers_what_it_should(size, slope, seed):
    """A triangle, moved inward by d, keeps (1 - d / r)^2 of its area.

    r is the radius of its inscribed circle; five standard errors.
    """
    sides = np.array([1.0, np.hypot(1.0, slope), np.sqrt(2.0 + slope**2)])
    radius = sides[0] * sides[1] / sides.sum()
    share = 1.0 - max(1.0 - 0.5 * abs(size) / radius, 0.0) ** 2
    square = scenes.quad((-0.5, -0.5, -0.5 * slope), (1.0, 0.0, 0.0), (0.0, 1.0, slope))
    glow = scenes.material(Emission(ValueToColor(Wireframe(Constant(size)))))
    made = scenes.scene(square, glow, scenes.orthographic(1, 1, 1.0, (0.0, 0.0, 5.0)))
    shown = ReferenceRenderer(made, Options(threads=1, seed=seed)).render(0, COUNT).radiance.mean()
    assert shown == pytest.approx(share, abs=5.0 * np.sqrt(share * (1.0 - share) / COUNT) + 1e-9)
