# SPDX-License-Identifier: GPL-3.0-or-later
"""The Mapping node against SciPy's rotations."""

import numpy as np
import pytest
from etalon.lib.textures.mapping import mapping
from scipy.spatial.transform import Rotation


@pytest.mark.parametrize("varying", [False, True])
def test_mapping_is_scale_rotation_translation(varying, rng):
    n = 40
    vector = rng.normal(size=(3, n))
    location, rotation, scale = rng.normal(size=(3, 3, n if varying else 1))
    spun = Rotation.from_euler("xyz", np.broadcast_to(rotation, (3, n)).T)
    turned = spun.apply((vector * scale).T).T
    inverse = spun.inv().apply((vector - location).T).T / scale
    normal = spun.apply((vector / scale).T).T
    np.testing.assert_allclose(mapping("POINT", vector, location, rotation, scale), turned + location, atol=1e-12)
    np.testing.assert_allclose(mapping("VECTOR", vector, location, rotation, scale), turned, atol=1e-12)
    np.testing.assert_allclose(mapping("TEXTURE", vector, location, rotation, scale), inverse, atol=1e-12)
    expected = normal / np.linalg.norm(normal, axis=0)
    np.testing.assert_allclose(mapping("NORMAL", vector, location, rotation, scale), expected, atol=1e-12)


@pytest.mark.parametrize("kind", ["TEXTURE", "NORMAL"])
def test_no_scale_gives_zero(kind, rng):
    none = np.zeros((3, 1))
    np.testing.assert_array_equal(mapping(kind, rng.normal(size=(3, 5)), none, none, none), 0.0)
