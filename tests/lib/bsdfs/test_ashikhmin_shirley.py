# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin and Shirley's lobe, translucency and tilted lobes.

Sampling is compared with density, and weights with values.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.ashikhmin_shirley import AshikhminShirley
from etalon.lib.bsdfs.lambert import Lambert, LambertTransmission
from etalon.lib.bsdfs.microfacet import MicrofacetReflection
from etalon.lib.bsdfs.tilted import Tilted
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.vectors import orthonormal_basis
from etalon.tests.chi2 import Reflections, Sphere, Tangents, chi_square, integrals, sidak
from scipy.integrate import quad

COUNT = 100_000
LEVEL = 1e-3
LOBES = [(0.1, 0.1, 0.9), (0.5, 0.5, 0.4), (0.15, 0.6, 0.7), (0.7, 0.2, 0.3), (1.0, 1.0, 0.5)]
TILTS = [(0.0, 0.3, 0.9), (0.5, 0.1, 0.6), (-0.4, 0.5, 0.2)]


def viewer(cos_o):
    sine = np.sqrt(1.0 - cos_o**2)
    return np.array([0.6 * sine, 0.8 * sine, cos_o])


def repeated(vector, count):
    return np.repeat(vector[:, None], count, axis=1)


@pytest.mark.parametrize(("alpha_x", "alpha_y", "cos_o"), LOBES)
def test_ashikhmin_shirley_follows_its_density(alpha_x, alpha_y, cos_o, rng):
    wo = viewer(cos_o)
    lobe = AshikhminShirley(repeated(wo, COUNT), np.float64(alpha_x), np.float64(alpha_y))
    wi, weight, pdf = lobe.sample(*rng.random((2, COUNT)))
    lost = weight[0] <= 0.0
    samples = np.where(lost, np.nan, wi)

    def density(directions):
        there = AshikhminShirley(repeated(wo, directions.shape[1]), np.float64(alpha_x), np.float64(alpha_y))
        return there.evaluate(directions)[1]

    chart = Reflections(wo, Tangents(alpha_x, alpha_y))
    assert chi_square(samples, density, chart, tolerance=5e-5).p_value > sidak(LEVEL, len(LOBES))
    value, pdf_there = lobe.evaluate(wi)
    np.testing.assert_allclose(pdf[~lost], pdf_there[~lost], rtol=1e-6)
    np.testing.assert_allclose((weight * pdf)[:, ~lost], value[:, ~lost], rtol=1e-6)


def test_light_and_viewer_of_ashikhmin_shirley_may_change_places(rng):
    directions = rng.normal(size=(2, 3, 2000))
    wo, wi = directions / np.sqrt((directions**2).sum(axis=1, keepdims=True))
    wo[2], wi[2] = np.abs(wo[2]), np.abs(wi[2])
    there = AshikhminShirley(wo, np.float64(0.3), np.float64(0.6)).evaluate(wi)[0] / wi[2]
    back = AshikhminShirley(wi, np.float64(0.3), np.float64(0.6)).evaluate(wo)[0] / wo[2]
    np.testing.assert_allclose(there, back, rtol=1e-9)


def test_translucency_is_lambert_on_the_far_side(rng):
    uniforms = rng.random((2, 1000))
    near, far = Lambert().sample(*uniforms), LambertTransmission().sample(*uniforms)
    np.testing.assert_array_equal(far[0], near[0] * np.array([[1.0], [1.0], [-1.0]]))
    np.testing.assert_array_equal(far[2], LambertTransmission().evaluate(far[0])[1])
    assert not LambertTransmission().evaluate(near[0])[0].any()


@pytest.mark.parametrize("normal", TILTS)
def test_tilted_lobes_follow_their_density(normal, rng):
    """What a tilted lobe sends below the face is lost.

    All else has the density that it states.
    """
    n = np.array(normal) / np.linalg.norm(normal)
    t, s = (axis[:, 0] for axis in orthonormal_basis(n[:, None]))
    rows = np.stack([t, s, n])
    wo = rows.T @ viewer(0.8)

    def lobe(count):
        inner = MicrofacetReflection(repeated(viewer(0.8), count), 0.5, 0.5, GGX(), "correlated", "visible")
        return Tilted(inner, np.repeat(rows[:, :, None], count, axis=2))

    wi, weight, pdf = lobe(COUNT).sample(*rng.random((2, COUNT)))
    kept = weight[0] > 0.0
    assert (wi[2, kept] > 0.0).all()
    assert wo @ n == pytest.approx(0.8)
    result = chi_square(
        np.where((wi * n[:, None]).sum(axis=0) > 0.0, wi, np.nan),
        lambda w: np.where(w.T @ n > 0.0, lobe(w.shape[1]).evaluate(w)[1], 0.0),
        Sphere(),
        (12, 16),
        tolerance=1e-3,
    )
    assert result.p_value > sidak(LEVEL, len(TILTS))
    value, density = lobe(COUNT).evaluate(wi)
    np.testing.assert_allclose(density[kept], pdf[kept], rtol=1e-9)
    np.testing.assert_allclose(value[:, kept], (weight * pdf)[:, kept], rtol=1e-9)


def normal_incidence_albedo(alpha_x, alpha_y):
    """Albedo seen along the normal.

    The paper's density of half vectors times cos(2 theta), a turn about the normal by quadrature: the integral of
    sqrt((nx + 1)(ny + 1)) / (2 pi) c^e (2 c^2 - 1) over theta < 45 degrees (closed form in c) and phi.
    """
    nx, ny = (2.0 / alpha**2 - 2.0 for alpha in (alpha_x, alpha_y))
    low = np.sqrt(0.5)

    def ring(phi):
        e = nx * np.cos(phi) ** 2 + ny * np.sin(phi) ** 2
        return 2.0 * (1.0 - low ** (e + 3.0)) / (e + 3.0) - (1.0 - low ** (e + 1.0)) / (e + 1.0)

    turn = quad(ring, 0.0, 0.5 * np.pi, epsabs=1e-12, epsrel=1e-10, limit=200)[0]
    return np.sqrt((nx + 1.0) * (ny + 1.0)) / (2.0 * np.pi) * 4.0 * turn


@pytest.mark.parametrize(("alpha_x", "alpha_y"), [(0.2, 0.2), (0.6, 0.6), (1.0, 1.0), (0.2, 0.7)])
def test_ashikhmin_shirley_is_normalised(alpha_x, alpha_y):
    """Along the normal max(i.n, o.n) is 1.

    The lobe is then its density times the cosine, whose integral is known.
    """
    wo = np.array([0.0, 0.0, 1.0])

    def value(wi):
        lobe = AshikhminShirley(repeated(wo, wi.shape[1]), np.float64(alpha_x), np.float64(alpha_y))
        return lobe.evaluate(wi)[0][0]

    chart = Reflections(wo, Tangents(alpha_x, alpha_y))
    total = integrals(value, chart, (16, 24), tolerance=1e-5).sum()
    assert total == pytest.approx(normal_incidence_albedo(alpha_x, alpha_y), abs=1e-4)


def test_narrow_ashikhmin_shirley_reflects_all_light_along_the_normal():
    assert normal_incidence_albedo(0.01, 0.01) == pytest.approx(1.0, abs=3e-4)
