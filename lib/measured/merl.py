# SPDX-License-Identifier: GPL-3.0-or-later
"""MERL's `.binary` files: isotropic values in half and difference angles.

There are 90 x 90 x 180 values (Matusik et al. 2003).

Three int32 sizes, then float64 for red, green and blue. The half vector's angle to the normal is cell k from k^2 to
(k + 1)^2 over 90^2 of 90 degrees, the difference vector's angle is in whole degrees, its azimuth in whole degrees
from 0 to 180: f is reciprocal. Stored values times 1/1500, 1.15/1500 and 1.66/1500 are f. Negative values mark
directions that were not measured.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import EtalonError
from ..vectors import dot
from .brdf import MeasuredBrdf, require_numbers
from .tensor_file import truncated

SHAPE = (90, 90, 180)
SCALES = np.array([1.0, 1.15, 1.66]) / 1500.0
HEADER = np.dtype("<i4")
VALUES = np.dtype("<f8")
TRUSTED_COSINE = float(np.cos(np.radians(80.0)))
"""Both directions within 80 degrees of the normal: there every cell of a good file has a value."""


@dataclass(frozen=True)
class Merl(MeasuredBrdf):
    """One MERL material.

    `values` are f in sr^-1, (3, 90, 90, 180), NaN where there was no measurement.
    """

    values: np.ndarray
    isotropic: bool = True

    def evaluate(self, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
        """Return f |n.wi| of the cell that holds the directions, (3, n).

        There is no interpolation, as in the authors' own reader.
        """
        half, difference, azimuth = half_difference_angles(wi, wo)
        h = np.minimum((90.0 * np.sqrt(half / (0.5 * np.pi))).astype(int), 89)
        d = np.minimum((90.0 * difference / (0.5 * np.pi)).astype(int), 89)
        p = np.minimum((180.0 * azimuth / np.pi).astype(int), 179)
        lit = (wi[2] > 0.0) & (wo[2] > 0.0)
        return np.where(lit, self.values[:, h, d, p] * np.abs(wi[2]), 0.0)


def half_difference_angles(wi: np.ndarray, wo: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return Rusinkiewicz's angles of unit directions (3, n).

    The angles are theta_h, theta_d in [0, pi/2] and phi_d in [0, pi), each (n,).

    The difference vector is wi in the frame whose z is the half vector and whose x is the direction of growing
    theta_h; phi_d and phi_d + pi are one, by reciprocity (Rusinkiewicz 1998).
    """
    m = wi + wo
    m = m / np.sqrt(np.maximum(dot(m, m), 1e-300))
    rim = np.hypot(m[0], m[1])
    cos_phi, sin_phi = np.where(rim > 0.0, m[:2] / np.maximum(rim, 1e-300), [[1.0], [0.0]])
    along = m[2] * (cos_phi * wi[0] + sin_phi * wi[1]) - rim * wi[2]
    across = cos_phi * wi[1] - sin_phi * wi[0]
    difference = np.arctan2(np.hypot(along, across), dot(wi, m))
    azimuth = np.arctan2(across, along) % np.pi
    return np.arctan2(rim, m[2]), np.minimum(difference, 0.5 * np.pi), np.where(azimuth >= np.pi, 0.0, azimuth)


def directions_of_angles(
    half: np.ndarray, difference: np.ndarray, azimuth: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the directions wi and wo, (3, n), of given `half_difference_angles`.

    The half vector is in the x-z plane.
    """
    sine, cosine = np.sin(half), np.cos(half)
    x, y, z = np.sin(difference) * np.cos(azimuth), np.sin(difference) * np.sin(azimuth), np.cos(difference)
    wi = np.stack([cosine * x + sine * z, y, cosine * z - sine * x])
    wo = np.stack([sine * z - cosine * x, -y, cosine * z + sine * x])
    return wi, wo


def read_merl(path: Path) -> Merl:
    """Read a MERL file.

    Raises EtalonError for a foreign or truncated file, for values that are not finite, and for negative ones where both directions
    lie within 80 degrees of the normal; OSError where the file cannot be read.
    """
    data = path.read_bytes()
    if len(data) < 12 or tuple(np.frombuffer(data, HEADER, 3)) != SHAPE:
        raise EtalonError(f"{path} is not a MERL file of 90 x 90 x 180 cells; give a .binary file of the MERL database")
    count = 3 * int(np.prod(SHAPE))
    if len(data) != 12 + count * VALUES.itemsize:
        if len(data) < 12 + count * VALUES.itemsize:
            raise truncated(path)
        raise EtalonError(f"{path}: more data than 3 x 90 x 90 x 180 values; give a .binary file of the MERL database")
    stored = np.frombuffer(data, VALUES, count, 12).reshape(3, *SHAPE)
    require_numbers(path, "the BRDF", stored[:, _measured_cells()])
    missing = ~(stored >= 0.0)
    return Merl(np.where(missing, np.nan, stored) * SCALES[:, None, None, None])


@functools.cache
def _measured_cells() -> np.ndarray:
    """Return the cells whose directions lie within 80 degrees of the normal, (90, 90, 180).

    Both directions at the middle of the cell count.
    """
    k, d, p = np.meshgrid(*(np.arange(n) + 0.5 for n in SHAPE), indexing="ij")
    wi, wo = directions_of_angles(np.square(k / 90.0) * 0.5 * np.pi, np.radians(d), np.radians(p))
    return (wi[2] > TRUSTED_COSINE) & (wo[2] > TRUSTED_COSINE)
