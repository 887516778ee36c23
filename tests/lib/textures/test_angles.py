# SPDX-License-Identifier: GPL-3.0-or-later
"""Fresnel and Layer Weight: closed forms at both ends."""

import numpy as np
import pytest
from etalon.lib.textures.angles import fresnel_factor, layer_weight_facing, layer_weight_fresnel

FRONT, BACK = np.array([False]), np.array([True])


@pytest.mark.parametrize("ior", [0.5, 1.0, 1.45, 3.0])
@pytest.mark.parametrize("side", [FRONT, BACK])
def test_at_normal_incidence_both_sides_reflect_alike(ior, side):
    assert fresnel_factor(np.array(ior), np.ones(1), side)[0] == pytest.approx(((ior - 1) / (ior + 1)) ** 2, abs=1e-12)


def test_total_reflection_from_inside_only():
    grazing = np.array([0.5])  # 60 degrees, beyond the critical angle of glass, 43.6
    assert fresnel_factor(np.array(1.45), grazing, BACK)[0] == 1.0
    assert 0.0 < fresnel_factor(np.array(1.45), grazing, FRONT)[0] < 0.2


def test_layer_weight_fresnel_is_fresnel_of_its_index():
    cos = np.linspace(0.05, 1, 20)
    for side in (np.zeros(20, bool), np.ones(20, bool)):
        got = layer_weight_fresnel(np.array(0.3), cos, side)
        np.testing.assert_allclose(got, fresnel_factor(np.array(1 / 0.7), cos, side))


@pytest.mark.parametrize(
    ("blend", "expected"), [(-1.0, 0.0), (0.0, 0.0), (0.25, 1 - 0.5), (0.5, 0.75), (0.75, 1 - 0.0625), (1.0, 1.0)]
)
def test_facing_at_cosine_a_quarter(blend, expected):
    assert layer_weight_facing(np.array(blend), np.array([0.25]))[0] == pytest.approx(expected, abs=1e-9)
