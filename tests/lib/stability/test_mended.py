# SPDX-License-Identifier: GPL-3.0-or-later
"""Four places at which the equations as printed keep no digits.

The reference is compared with mpmath, beside the printed form.
"""

import mpmath as mp
import numpy as np
import pytest
from etalon.lib.bsdfs.ashikhmin_shirley import AshikhminShirley
from etalon.lib.bsdfs.fresnels import Dielectric, TintedDielectric
from etalon.lib.bsdfs.oren_nayar import lost_share
from etalon.lib.bsdfs.reflected import Reflected
from etalon.lib.microfacets import fresnel
from etalon.lib.stability import exact, exact_lobes


def relative(found, expected):
    with mp.workdps(50):
        return float(abs(mp.mpf(float(found)) - expected) / abs(expected))


def exactly(truth, *arguments):
    with mp.workdps(50):
        return truth(*(mp.mpf(float(a)) for a in arguments))[0]


@pytest.mark.parametrize("cosine", [1e-2, 1e-5, 1e-8])
def test_ashikhmin_shirley_between_opposite_grazing_directions(cosine):
    """At alpha 1 the lobe is 1 / (8 pi h.o max(i.n, o.n)).

    It is 4e6 at cosines of 1e-8, where the scalar product h.o rounds to 0.
    """
    sine = np.sqrt((1.0 - cosine) * (1.0 + cosine))
    wi, wo = np.array([[sine], [0.0], [cosine]]), np.array([[-sine], [0.0], [cosine]])
    value, pdf = AshikhminShirley(wo, np.float64(1.0), np.float64(1.0)).evaluate(wi)
    assert value[:, 0] == pytest.approx(1.0 / (8.0 * np.pi * cosine), rel=1e-15)
    assert relative(value[0, 0], exactly(exact_lobes.ashikhmin_shirley, *wi[:, 0], *wo[:, 0], 1.0, 1.0)) < 1e-15
    assert pdf[0] == value[0, 0]


@pytest.mark.parametrize("below", [1e-8, 1e-6, 1e-3, 0.3, 0.6])
def test_a_metal_without_absorption_reflects_all_at_the_critical_angle(below):
    """Next to the critical angle F = 1 - 2 g (1 + 1 / eta^2) / c.

    g is the root of what rounding leaves of c^2.
    """
    eta = 1.0 - below
    critical = np.sqrt((1.0 - eta) * (1.0 + eta))
    cosines = critical * np.array([0.5, 1.0 - 1e-12, 1.0 - 2.0**-52, 1.0])
    least = 1.0 - 4.0 * np.sqrt(2.0**-51) * (1.0 + 1.0 / eta**2)
    assert (fresnel.conductor(cosines[:2], eta, 0.0) == 1.0).all()
    assert (fresnel.conductor(cosines, eta, 0.0) >= least).all()
    beyond = critical * 1.001
    found = fresnel.conductor(np.array([beyond]), eta, 0.0)[0]
    assert relative(found, exactly(exact.conductor, beyond, eta, 0.0)) < 1e-10


@pytest.mark.parametrize("cosine", [1e-15, 1e-12, 1e-8, 1e-4, 0.1, 0.5, 0.9, 1.0 - 1e-9])
def test_what_oren_nayar_loses_keeps_its_digits(cosine):
    """(1 - E) / B as printed holds (1 - sin^3) / cos, which is 0 / cos below a cosine of 1e-8."""
    with mp.workdps(60):
        c = mp.mpf(cosine)
        s = mp.sqrt(1 - c * c)
        g = s * (mp.acos(c) - mp.mpf(2) / 3 - s * c) + mp.mpf(2) / 3 * s / c * (1 - s**3)
        expected = mp.pi / 2 - mp.mpf(2) / 3 - g
    assert relative(lost_share(np.array([cosine]))[0], expected) < 2e-15


@pytest.mark.parametrize("eta", [0.7, 1.0001, 1.5, 3.0])
@pytest.mark.parametrize("angle", [1e-6, 1e-3, 0.1, 1.0])
def test_a_tinted_dielectric_keeps_its_digits_as_f0_falls_to_0(eta, angle):
    """Near the normal the curve rises by sin^4.

    As a difference from F0 it keeps no digits below an angle of 1e-4.
    """
    cosine = np.cos(angle)
    found = TintedDielectric(np.float64(eta), np.array([[0.0]]))(np.array([cosine]))[0, 0]
    condition = 4.0 / max(np.sin(angle) ** 2, 1e-15)  # what the last place of the cosine is worth
    assert relative(found, exactly(exact_lobes.tinted_dielectric, cosine, eta, 0.0)) < 1e-15 * (condition + 100.0)


@pytest.mark.parametrize("cosine", [1e-3, 1e-6, 1e-9])
def test_a_reflecting_lobe_knows_its_facet_between_opposite_grazing_directions(cosine):
    class White:
        delta = diffuse = False

        def evaluate(self, wi):
            return np.ones(wi.shape), np.ones(wi.shape[1])

    sine = np.sqrt((1.0 - cosine) * (1.0 + cosine))
    wi, wo = np.array([[sine], [0.0], [cosine]]), np.array([[-sine], [0.0], [cosine]])
    value, _ = Reflected(White(), wo, Dielectric(np.float64(1.5))).evaluate(wi)
    assert 1.0 - value[:, 0] == pytest.approx(1.0 - fresnel.dielectric(np.array([cosine]), 1.5)[0], abs=1e-15)
