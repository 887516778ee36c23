# SPDX-License-Identifier: GPL-3.0-or-later
"""The lecture's two rows of spheres by both renderers."""

import numpy as np
import pytest
from etalon.addon.illustrations import render_rows
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.settings.comparison import Settings
from etalon.reference_scenes.sigma_sweep import SIGMAS


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_rows_are_eight_spheres_by_both_renderers_and_once_more_with_ggx():
    settings = Settings(time=20.0, samples=4, replicates=4, size="full", threads=1, tolerance=0.3)
    rows = render_rows(0, NO_PROGRESS, settings, percent=10)
    assert [(one.distribution, one.sigma) for one in rows.spheres] == [
        (name, sigma) for name in ("Beckmann", "GGX") for sigma in SIGMAS
    ]
    assert all(abs(one.difference) < 0.5 for one in rows.spheres)
    lower = rows.spheres[-1].weights > 0.5
    # GGX in place of GGX changes the noise alone; in place of Beckmann it takes a quarter of the light at sigma 0.5.
    means = [float(image[lower].mean()) for image in (rows.reference, rows.all_ggx)]
    assert means[1] == pytest.approx(means[0], rel=0.15)
    upper = np.array([one.weights for one in rows.spheres[3:4]]).sum(axis=0) > 0.5
    assert rows.all_ggx[upper].mean() < 0.9 * rows.reference[upper].mean()
