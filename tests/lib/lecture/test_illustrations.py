# SPDX-License-Identifier: GPL-3.0-or-later
"""The two rows of spheres.

Tested is the table for a planted difference, for noise, and for another model.
"""

import numpy as np
import pytest
from etalon.lib.lecture.illustrations import Rows, Sphere, illustrate_missing, illustrate_rows


def rows(candidate=1.0, all_ggx=1.0, error=0.0):
    """Two grey halves, above and below, as the spheres."""
    grey = np.full((32, 32, 3), 0.3)
    upper = np.zeros((32, 32))
    upper[:16] = 1.0
    spheres = tuple(
        Sphere(name, 0.3, weights, "EQUIVALENT", 0.0, 0.02)
        for name, weights in (("Beckmann", upper), ("GGX", 1.0 - upper))
    )
    brighter = np.where(upper[..., None] > 0.0, candidate, 1.0)
    errors = np.full_like(grey, error), np.zeros_like(grey)
    return Rows(grey, grey * brighter, grey * all_ggx, errors, spheres, 0.03, 1.0, "Cycles")


def test_flip_is_zero_where_renders_agree_and_sees_a_sphere_that_is_brighter():
    alike, brighter = (illustrate_rows(rows(factor), 0).numbers["spheres"] for factor in (1.0, 1.3))
    assert [one["flip"] for one in alike] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert brighter[0]["flip"] > 0.1
    assert brighter[1]["flip"] < 0.5 * brighter[0]["flip"]  # the edge between the two is seen from both sides


def test_flip_of_noise_grows_with_the_noise_and_not_with_a_difference(seed):
    none, some, more = (
        illustrate_rows(rows(1.3, error=error), seed).numbers["spheres"][0]["flip_of_noise"]
        for error in (0.0, 0.01, 0.04)
    )
    assert none == pytest.approx(0.0, abs=1e-6)
    assert 0.0 < some < more


def test_another_model_is_told_by_light_and_by_flip():
    (found,) = illustrate_rows(rows(all_ggx=0.8), 0).numbers["ggx_for_beckmann"]
    assert found["difference"] == pytest.approx(-0.2)
    assert found["flip"] > 0.05


def test_a_page_without_blender_says_what_is_missing():
    figure = illustrate_missing("Blender is <not> installed")
    assert "Not rendered." in figure.drawing
    assert "Pas de rendu." in figure.drawing
    assert "Blender is &lt;not&gt; installed" in figure.drawing
