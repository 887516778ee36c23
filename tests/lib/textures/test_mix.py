# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends: what holds for all of them, and the closed forms of some."""

import numpy as np
import pytest
from etalon.lib.textures.mix import BLENDS, mix


@pytest.mark.parametrize("blend", BLENDS)
def test_no_factor_changes_nothing(blend, rng):
    a, b = rng.random((2, 3, 300))
    before = a.copy(), b.copy()
    got = mix(blend, np.zeros(300), a, b, clamp_factor=True, clamp_result=False)
    np.testing.assert_allclose(got, a, atol=1e-12)
    np.testing.assert_array_equal(a, before[0])
    np.testing.assert_array_equal(b, before[1])


@pytest.mark.parametrize("blend", BLENDS)
def test_constants_and_arrays_agree(blend, rng):
    t, (a, b) = rng.random(50), rng.random((2, 3, 50))
    got = mix(blend, t, a, b[:, :1], clamp_factor=True, clamp_result=False)
    one = mix(blend, t[7], a[:, 7:8], b[:, :1], clamp_factor=True, clamp_result=False)
    np.testing.assert_allclose(got[:, 7:8], one, rtol=1e-12)


@pytest.mark.parametrize(
    ("blend", "expected"),
    [
        ("MIX", (0.9, 0.0, 0.5)),
        ("DARKEN", (0.2, 0.0, 0.5)),
        ("LIGHTEN", (0.9, 0.6, 0.5)),
        ("MULTIPLY", (0.18, 0.0, 0.25)),
        ("SCREEN", (0.92, 0.6, 0.75)),
        ("ADD", (1.1, 0.6, 1.0)),
        ("SUBTRACT", (-0.7, 0.6, 0.0)),
        ("DIVIDE", (0.2 / 0.9, 0.6, 1.0)),
        ("DIFFERENCE", (0.7, 0.6, 0.0)),
        ("EXCLUSION", (0.74, 0.6, 0.5)),
        ("OVERLAY", (0.36, 0.2, 0.5)),
        ("LINEAR_LIGHT", (1.0, -0.4, 0.5)),
        ("DODGE", (1.0, 0.6, 1.0)),
        ("BURN", (1 - 0.8 / 0.9, 0.0, 0.0)),
    ],
)
def test_closed_forms_at_full_factor(blend, expected):
    a, b = np.array([[0.2], [0.6], [0.5]]), np.array([[0.9], [0.0], [0.5]])
    got = mix(blend, np.array(1.0), a, b, clamp_factor=True, clamp_result=False)
    np.testing.assert_allclose(got[:, 0], expected, atol=1e-12)


def test_clamping():
    a, b = np.array([[0.5]] * 3), np.array([[2.0]] * 3)
    assert mix("MIX", np.array(3.0), a, b, clamp_factor=True, clamp_result=False)[0, 0] == 2.0
    assert mix("MIX", np.array(3.0), a, b, clamp_factor=False, clamp_result=False)[0, 0] == 5.0
    assert mix("MIX", np.array(3.0), a, b, clamp_factor=False, clamp_result=True)[0, 0] == 1.0
