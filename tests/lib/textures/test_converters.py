# SPDX-License-Identifier: GPL-3.0-or-later
"""Converter nodes against their definitions."""

import numpy as np
from etalon.lib.textures.converters import cosine_between
from scipy.spatial.transform import Rotation


def test_cosine_between_vectors_is_that_of_the_angle_that_turns_one_into_the_other(rng):
    axes = Rotation.from_rotvec(rng.normal(size=(50, 3)))
    angle = rng.uniform(0.0, np.pi, 50)
    a = axes.apply([1.0, 0.0, 0.0]).T * rng.uniform(1e-3, 1e3, 50)
    b = axes.apply(np.stack([np.cos(angle), np.sin(angle), np.zeros(50)], axis=1)).T * rng.uniform(1e-3, 1e3, 50)
    assert np.allclose(cosine_between(a, b), np.cos(angle), rtol=0.0, atol=1e-14)
    assert np.allclose(cosine_between(a[:, :1], b), cosine_between(np.repeat(a[:, :1], 50, axis=1), b))


def test_cosine_with_a_vector_of_no_length_is_no_number():
    with np.errstate(invalid="ignore"):
        assert np.isnan(cosine_between(np.ones((3, 1)), np.array([[0.0, 1.0]] * 3))).tolist() == [True, False]
