# SPDX-License-Identifier: GPL-3.0-or-later
"""Transforms made by the exponential of a generator."""

import numpy as np
from scipy.linalg import expm


def turned(angle, scale=(1.0, 1.0, 1.0), at=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0)):
    """A rotation of a scaled object at a place.

    It turns about an axis by the exponential of its generator.
    """
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    rotation = expm(angle * np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]))
    return np.column_stack([rotation * scale, at])
