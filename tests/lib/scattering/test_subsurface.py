# SPDX-License-Identifier: GPL-3.0-or-later
"""The medium below a surface: its mappings against transport in a half space.

Chandrasekhar's H function solves it.
"""

import mpmath
import numpy as np
import pytest
from etalon.lib.scattering.subsurface import (
    albedo_fitted,
    albedo_van_de_hulst,
    dipole_albedo,
    dipole_reflectance,
    make_medium,
)
from numpy.polynomial.legendre import leggauss

NODE, WEIGHT = leggauss(64)
MU, WEIGHT = 0.5 * (NODE + 1.0), 0.5 * WEIGHT


def h_function(albedo):
    """Chandrasekhar's H at MU for isotropic scattering, by his iteration.

    Radiative Transfer, section 38.
    """
    h = np.ones_like(MU)
    for _ in range(4000):
        integral = (WEIGHT * h * MU / (MU[:, None] + MU)).sum(axis=1)
        new = 1.0 / (np.sqrt(1.0 - albedo) + 0.5 * albedo * integral)
        if np.abs(new - h).max() < 1e-13:
            return new
        h = 0.5 * (h + new)
    raise AssertionError("the iteration has not settled")


def reflectance_of_half_space(albedo):
    """What it reflects of diffuse light: 1 - 2 sqrt(1 - albedo) times the integral of H mu."""
    return 1.0 - 2.0 * np.sqrt(1.0 - albedo) * (WEIGHT * h_function(albedo) * MU).sum()


@pytest.mark.parametrize("color", [0.02, 0.2, 0.5, 0.8, 0.95])
def test_a_half_space_of_the_mapped_albedo_reflects_the_colour(color):
    assert reflectance_of_half_space(albedo_van_de_hulst(color, 0.0)) == pytest.approx(color, abs=0.0021)


@pytest.mark.parametrize(("color", "excess"), [(0.02, 0.0), (0.2, 0.002), (0.5, 0.005), (0.8, 0.012), (0.9, 0.038)])
def test_the_older_mapping_is_too_bright_for_bright_colours(color, excess):
    """What Random Walk before Blender 5.2 makes of a colour.

    Above 0.94 it takes the medium for lossless.
    """
    albedo = albedo_fitted(np.float64(color), np.float64(0.0))
    assert reflectance_of_half_space(albedo) - color == pytest.approx(excess, abs=0.001)
    assert albedo_fitted(np.float64(0.95), np.float64(0.0)) > 1.0


def test_an_anisotropic_medium_has_the_similarity_parameter_of_the_isotropic_one():
    color, g = np.linspace(0.05, 0.95, 7), np.float64(0.6)
    isotropic, forward = albedo_van_de_hulst(color, np.float64(0.0)), albedo_van_de_hulst(color, g)
    np.testing.assert_allclose((1.0 - forward) / (1.0 - g * forward), 1.0 - isotropic, rtol=1e-12)


@pytest.mark.parametrize("color", [0.01, 0.3, 0.8])
def test_the_dipole_is_inverted(color):
    color, ior = np.full((3, 1), color), np.full(1, 1.4)
    albedo = dipole_albedo(color, ior)
    inverse = 1.0 / 1.4
    mean = -1.44 * inverse**2 + 0.71 * inverse + 0.668 + 0.0636 * 1.4
    np.testing.assert_allclose(dipole_reflectance(albedo, (1.0 + mean) / (1.0 - mean)), color, rtol=1e-9)


def test_the_dipole_is_the_integral_of_its_profile():
    """Jensen et al. 2001, eq. 4: a source below the surface and its image above."""
    albedo, internal = 0.9, 3.2
    with mpmath.workdps(20):
        extinction = 1.0
        transport = mpmath.sqrt(3 * (1 - mpmath.mpf(albedo)) * extinction)
        depth = 1 / mpmath.mpf(extinction)
        image = depth * (1 + mpmath.mpf(4) / 3 * internal)

        def profile(radius):
            def part(z):
                d = mpmath.sqrt(radius**2 + z**2)
                return z * (transport * d + 1) * mpmath.exp(-transport * d) / d**3

            return albedo / (4 * mpmath.pi) * (part(depth) + part(image))

        total = mpmath.quad(lambda r: 2 * mpmath.pi * r * profile(r), [0, 1, 5, 20, 80, mpmath.inf])
    assert float(dipole_reflectance(np.float64(albedo), np.float64(internal))) == pytest.approx(float(total), rel=1e-8)


def medium(mapping, color, radius=0.1, g=0.0):
    return make_medium(mapping, np.full((3, 1), color), np.full((3, 1), radius), np.full(1, g), np.full(1, 1.4))


def test_the_radius_is_a_mean_free_path():
    assert 1.0 / medium("VAN_DE_HULST", 0.8, g=0.5).extinction[0, 0] == pytest.approx(0.1)
    assert 4.0 * np.pi / (0.5 * medium("FITTED", 0.8, g=0.5).extinction[0, 0]) == pytest.approx(0.1)
    skin = medium("SKIN", 0.8).extinction[0, 0]
    reduced = dipole_albedo(np.full((3, 1), 0.8), np.full(1, 1.4))[0, 0]
    assert 1.0 / (skin * np.sqrt(3.0 * (1.0 - reduced))) == pytest.approx(0.1)


def test_backward_scattering_has_one_mapping():
    for mapping in ("FITTED", "VAN_DE_HULST"):
        albedo = medium(mapping, 0.8, g=-0.4).albedo[0, 0]
        assert albedo == pytest.approx(albedo_van_de_hulst(np.float64(0.8), np.float64(-0.4)))


def test_dark_colours_fade_to_black_without_a_step():
    """Below an albedo of 0.2 the light is scaled.

    The product of the two goes on as the albedo would.
    """
    for color in (0.0, 1e-6, 0.01, 0.04, 0.05):
        one = medium("VAN_DE_HULST", color)
        expected = np.clip(albedo_van_de_hulst(np.float64(color), np.float64(0.0)), 0.0, None)
        np.testing.assert_allclose(one.scale * one.albedo, expected, rtol=1e-12)
        assert one.albedo.min() >= 0.2
