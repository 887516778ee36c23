# SPDX-License-Identifier: GPL-3.0-or-later
"""The sRGB transfer function against IEC's numbers."""

import numpy as np
import pytest
from etalon.lib.srgb import srgb_decode, srgb_encode


@pytest.mark.parametrize(
    ("code", "linear"), [(0.0, 0.0), (0.04045, 0.0031308), (0.5, 0.2140411), (1.0, 1.0), (-0.3, 0.0)]
)
def test_srgb_decoding(code, linear):
    assert srgb_decode(np.array(code)) == pytest.approx(linear, abs=1e-7)


def test_encoding_undoes_decoding_beyond_one_too():
    code = np.linspace(0.0, 3.0, 301)
    np.testing.assert_allclose(srgb_encode(srgb_decode(code)), code, atol=1e-6)
