# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour spaces of Blender's configuration against their published definitions."""

import numpy as np
import pytest
from etalon.addon.host.color_configuration import color_configuration
from etalon.lib.errors import EtalonError
from etalon.lib.srgb import srgb_decode
from etalon.lib.textures.linearize import linearize

WHITE = (0.3127, 0.3290)
REC709 = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
REC2020 = ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046))
P3 = ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060))


def to_xyz(primaries):
    """The matrix from linear RGB to XYZ with Y = 1 for white.

    It comes from chromaticities (SMPTE RP 177).
    """
    x, y = np.array(primaries).T
    columns = np.stack([x / y, np.ones(3), (1 - x - y) / y])
    white = np.array([WHITE[0] / WHITE[1], 1.0, (1 - sum(WHITE)) / WHITE[1]])
    return columns * np.linalg.solve(columns, white)


def to_rec709(primaries, color):
    return color @ (np.linalg.inv(to_xyz(REC709)) @ to_xyz(primaries)).T


SPACES = {
    "sRGB": srgb_decode,
    "Linear Rec.709": lambda c: c,
    "Linear Rec.2020": lambda c: to_rec709(REC2020, c),
    "Linear DCI-P3 D65": lambda c: to_rec709(P3, c),
    "Display P3": lambda c: to_rec709(P3, srgb_decode(c)),
    "Rec.1886": lambda c: c**2.4,
}


@pytest.mark.parametrize("space", SPACES)
def test_color_space_is_what_its_standard_says(space, rng):
    pixels = rng.random((6, 7, 4)).astype(np.float32)
    got = linearize(pixels, space, color_configuration())
    # Blender 4.5's matrices have four digits.
    np.testing.assert_allclose(got[..., :3], SPACES[space](pixels[..., :3].astype(np.float64)), atol=4e-4)
    np.testing.assert_array_equal(got[..., 3], pixels[..., 3])


def test_an_unknown_color_space_is_named():
    with pytest.raises(EtalonError, match="colour space 'Nowhere' cannot be converted"):
        linearize(np.zeros((1, 1, 4), np.float32), "Nowhere", color_configuration())
