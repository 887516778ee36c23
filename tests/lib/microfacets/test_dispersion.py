# SPDX-License-Identifier: GPL-3.0-or-later
"""Cauchy's index against the definition of the Abbe number.

Also against a glass of the catalogue.
"""

import numpy as np
import pytest
from etalon.lib.microfacets.dispersion import LINE_C, LINE_D, LINE_F, cauchy_index


@pytest.mark.parametrize("abbe", [1.0, 20.0, 64.0])
@pytest.mark.parametrize("ior", [0.7, 1.0, 1.5, 2.4])
def test_the_abbe_number_is_the_one_given(ior, abbe):
    """V = (n_d - 1) / (n_F - n_C), and n_d is the index given."""
    f, d, c = cauchy_index(np.float64(ior), 1.0 / abbe, np.array([LINE_F, LINE_D, LINE_C]))
    assert d == pytest.approx(ior, rel=1e-14)
    assert abbe * (f - c) == pytest.approx(ior - 1.0, abs=1e-13)


def test_no_dispersion_is_the_same_index_at_every_wavelength():
    np.testing.assert_array_equal(cauchy_index(np.float64(1.5), 0.0, np.linspace(380.0, 780.0, 9)), 1.5)


def test_it_is_linear_in_the_inverse_square_of_the_wavelength():
    wavelength = np.array([400.0, 500.0, 650.0])
    slope = np.diff(cauchy_index(np.float64(1.6), 0.05, wavelength)) / np.diff(wavelength**-2)
    assert slope[0] == pytest.approx(slope[1], rel=1e-12)


def test_crown_glass():
    """Schott N-BK7: n_d 1.5168, V 64.17.

    Its catalogue has 1.5224 at line F, 1.5143 at C and 1.5268 at g, 435.84 nm.
    """
    f, c, g = cauchy_index(np.float64(1.5168), 1.0 / 64.17, np.array([LINE_F, LINE_C, 435.84]))
    assert (f, c) == (pytest.approx(1.52238, abs=2e-4), pytest.approx(1.51432, abs=2e-4))
    assert g == pytest.approx(1.52668, abs=5e-4)
