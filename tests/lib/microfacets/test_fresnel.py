# SPDX-License-Identifier: GPL-3.0-or-later
"""Fresnel's equations to 50 digits from their definition, and their closed forms.

Also how far the approximations stray.
"""

import mpmath as mp
import numpy as np
import pytest
from etalon.lib.microfacets import fresnel

COSINES = np.concatenate([[1e-12, 1e-6, 1e-3], np.linspace(0.01, 1.0, 34), [1.0 - 2.0**-53]])
METALS = {
    "silver": (0.05, 4.2),
    "gold": (0.18, 3.4),
    "iron": (2.9, 3.1),
    "tungsten": (4.4, 3.6),
    "aluminium": (1.0, 7.5),
}


def by_definition(cos_i, index):
    """Mean of |r_s|^2 and |r_p|^2.

    The refracted cosine is Snell's, complex where it must be.
    """
    c = mp.mpf(float(cos_i))
    refracted = mp.sqrt(mp.mpc(1 - (1 - c * c) / index**2))
    s = (c - index * refracted) / (c + index * refracted)
    p = (index * c - refracted) / (index * c + refracted)
    return (abs(s) ** 2 + abs(p) ** 2) / 2


@pytest.mark.parametrize("eta", [0.2, 0.66, 1.0 / 1.5, 0.999, 1.0 + 1e-9, 1.0001, 1.33, 1.5, 2.4, 10.0])
def test_dielectric_to_fifty_digits(eta):
    cosines = COSINES
    if eta < 1.0:
        critical = np.sqrt((1.0 - eta) * (1.0 + eta))
        steps = np.array([-1e-3, -1e-9, -1e-15, 0.0, 1e-15, 1e-12, 1e-9, 1e-3])
        cosines = np.concatenate([cosines, [critical], critical + steps])
    value = fresnel.dielectric(cosines, eta)
    with mp.workdps(50):
        for c, f in zip(cosines, value, strict=True):
            expected = by_definition(c, mp.mpf(eta))
            # At the critical angle F = 1 - 2 g (1 + 1 / eta^2) / c, and g is the root of a difference that rounds.
            c50 = mp.mpf(float(c))
            g2 = abs(mp.mpf(eta) ** 2 - 1 + c50**2)
            step = mp.mpf(2e-15)
            root = mp.sqrt(g2 + mp.mpf(4e-16)) - mp.sqrt(g2)
            sensitivity = 2 * root * (1 + 1 / mp.mpf(eta) ** 2) / c50 if eta < 1.0 else 0
            assert (
                abs(mp.mpf(float(f)) - expected) <= step * expected + step * mp.mpf((eta - 1.0) ** 2) + sensitivity
            ), (c, f)


def test_total_internal_reflection_is_one():
    eta = 1.0 / 1.5
    critical = np.sqrt(1.0 - eta * eta)
    assert (fresnel.dielectric(np.linspace(0.0, critical - 1e-12, 1000), eta) == 1.0).all()
    beyond = fresnel.dielectric(critical + np.geomspace(1e-12, 0.2, 200), eta)
    assert (np.diff(beyond) < 0.0).all()
    assert beyond[0] == pytest.approx(1.0, abs=1e-4)


def test_dielectric_closed_forms():
    eta = np.array([1.1, 1.33, 1.5, 2.4, 0.7])
    normal = ((eta - 1.0) / (eta + 1.0)) ** 2
    np.testing.assert_allclose(fresnel.dielectric(np.ones(5), eta), normal, rtol=1e-14)
    np.testing.assert_allclose(fresnel.dielectric(np.zeros(5), eta), 1.0, rtol=4e-15)
    assert not fresnel.dielectric(np.linspace(0.0, 1.0, 9), 1.0).any()
    # Brewster: tan = eta, only the s part is left.
    cos_b = 1.0 / np.sqrt(1.0 + eta * eta)
    s_part = 0.5 * ((1.0 - eta * eta) / (1.0 + eta * eta)) ** 2
    np.testing.assert_allclose(fresnel.dielectric(cos_b, eta), s_part, rtol=1e-13)


def test_dielectric_is_the_same_from_both_sides(rng):
    eta = rng.uniform(1.01, 3.0, 200)
    cos_i = rng.uniform(0.01, 1.0, 200)
    cos_t = np.sqrt(1.0 - (1.0 - cos_i**2) / eta**2)
    np.testing.assert_allclose(fresnel.dielectric(cos_i, eta), fresnel.dielectric(cos_t, 1.0 / eta), rtol=1e-11)


@pytest.mark.parametrize("metal", METALS.values(), ids=METALS.keys())
def test_conductor_to_fifty_digits(metal):
    value = fresnel.conductor(COSINES, *metal)
    with mp.workdps(50):
        for c, f in zip(COSINES, value, strict=True):
            assert float(abs(f - by_definition(c, mp.mpc(*metal)))) < 4e-15


def test_conductor_closed_forms():
    for eta, k in METALS.values():
        normal = ((eta - 1.0) ** 2 + k * k) / ((eta + 1.0) ** 2 + k * k)
        assert fresnel.conductor(np.ones(1), eta, k) == pytest.approx(normal, rel=1e-14)
        assert fresnel.conductor(np.zeros(1), eta, k) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("eta", [0.5, 0.9, 1.5, 3.0])
def test_conductor_without_absorption_is_the_dielectric(eta):
    cosines = np.linspace(0.0, 1.0, 400)
    np.testing.assert_allclose(
        fresnel.conductor(cosines, eta, 0.0), fresnel.dielectric(cosines, eta), rtol=0.0, atol=1e-7
    )
    away = np.abs(cosines**2 - (1.0 - eta * eta)) > 1e-3
    np.testing.assert_allclose(
        fresnel.conductor(cosines[away], eta, 0.0), fresnel.dielectric(cosines[away], eta), rtol=1e-11
    )


def test_colours_are_bands():
    cosines = np.linspace(0.0, 1.0, 7)
    eta, k = np.array([[0.18], [0.42], [1.37]]), np.array([[3.42], [2.35], [1.77]])
    together = fresnel.conductor(cosines, eta, k)
    assert together.shape == (3, 7)
    for band in range(3):
        assert (together[band] == fresnel.conductor(cosines, eta[band, 0], k[band, 0])).all()
    f0 = np.array([[0.04], [0.5], [1.0]])
    for approximation in (fresnel.schlick, fresnel.cook_torrance):
        together = approximation(cosines, f0)
        for band in range(3):
            np.testing.assert_array_equal(together[band], approximation(cosines, f0[band, 0]))


def test_approximations_keep_both_ends():
    f0 = np.array([0.0, 0.02, 0.5, 0.95, 1.0])
    for approximation in (fresnel.schlick, fresnel.cook_torrance):
        np.testing.assert_allclose(approximation(np.ones(5), f0), f0, atol=1e-14)
        np.testing.assert_allclose(approximation(np.zeros(4), f0[1:]), 1.0, atol=1e-12)
    np.testing.assert_allclose(fresnel.cook_torrance(np.linspace(0.0, 1.0, 9), 1.0), 1.0, atol=1e-12)


def test_how_far_the_approximations_stray():
    """The reason for the exact forms.

    Schlick is 0.03 off for glass, Cook-Torrance's real index more than that for gold.
    """
    cosines = np.linspace(0.0, 1.0, 2001)
    glass = fresnel.schlick(cosines, 0.04) - fresnel.dielectric(cosines, 1.5)
    assert 0.02 < np.abs(glass).max() < 0.04
    np.testing.assert_allclose(fresnel.cook_torrance(cosines, 0.04), fresnel.dielectric(cosines, 1.5), atol=1e-14)
    gold = fresnel.conductor(cosines, *METALS["gold"])
    f0 = gold[-1]
    assert np.abs(fresnel.cook_torrance(cosines, f0) - gold).max() > 0.02


def test_arguments_stay_as_they_were(rng):
    cosines, eta, k, f0 = rng.uniform(0.1, 1.0, (4, 32))
    for argument in (cosines, eta, k, f0):
        argument.flags.writeable = False
    fresnel.dielectric(cosines, eta)
    fresnel.conductor(cosines, eta, k)
    fresnel.schlick(cosines, f0)
    fresnel.cook_torrance(cosines, f0)
