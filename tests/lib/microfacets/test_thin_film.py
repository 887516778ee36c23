# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films: colours against the wave optics of single wavelengths.

Also known limits, and how far Cycles' series is off.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.films import Film, FilmConductor, FilmDielectric, FilmF82, Tabulated, under_film
from etalon.lib.bsdfs.fresnels import F82, reflectance_at_normal
from etalon.lib.microfacets import fresnel
from etalon.lib.microfacets.thin_film import cycles_sensitivity, exact_sensitivity
from etalon.lib.sampling import wavelengths
from scipy.interpolate import CubicSpline

COSINES = np.array([1e-4, 0.02, 0.1, 0.3, 0.6, 0.9, 1.0])
SUBSTRATES = [1.5, 2.4, 0.2 + 3.4j, 1.5 + 1.8j, 3.0 + 0.01j]
FILMS = [(1.33, 60.0), (1.33, 480.0), (2.2, 150.0), (1.8, 2500.0)]


def slab(cosine, index, thickness, substrate, wavelength):
    """Reflectance of a film by the characteristic matrix of a layer.

    See Born and Wolf, sec. 1.6.2. Mean of both polarisations.
    """
    sine2 = (1.0 - cosine) * (1.0 + cosine)
    inside, beyond = (n * np.sqrt(1.0 - sine2 / n**2 + 0j) for n in (index, substrate))
    turn = 2.0 * np.pi / wavelength * inside * thickness
    total = 0.0
    for outer, film, base in (
        (cosine, inside, beyond),  # s: n cos
        (1.0 / cosine, index**2 / inside, substrate**2 / beyond),  # p: n / cos
    ):
        field = np.cos(turn) - 1j * np.sin(turn) * base / film
        flux = base * np.cos(turn) - 1j * np.sin(turn) * film
        total = total + 0.5 * np.abs((outer * field - flux) / (outer * field + flux)) ** 2
    return total


def equal_energy_colors():
    """Wavelengths every 0.25 nm, and the weights of linear Rec. 709 there.

    They come from the integer table that dispersion uses, not the film's.
    """
    observer = np.array([row.split() for row in wavelengths._OBSERVER], float)
    fine = np.arange(380.0, 780.001, 0.25)
    weights = wavelengths._REC709 @ CubicSpline(wavelengths.NODES, observer, axis=1)(fine)
    return fine, weights / weights.sum(axis=1, keepdims=True)


def curve(index, thickness, substrate, to, outside=1.0):
    film = Film(np.float64(thickness), np.float64(index), to, np.float64(outside))
    if np.iscomplexobj(np.asarray(substrate)):
        return FilmConductor(film, np.full((3, 1), substrate.real), np.full((3, 1), substrate.imag))
    return FilmDielectric(film, np.float64(substrate), reflectance_at_normal(np.full((3, 1), substrate)))


@pytest.mark.parametrize("substrate", SUBSTRATES)
@pytest.mark.parametrize(("index", "thickness"), FILMS)
def test_colours_are_the_integral_of_wave_optics(index, thickness, substrate):
    """The two agree to what two prints of the observer leave.

    One print has four digits every 5 nm. Colours beyond Rec. 709's range are clipped.
    """
    wavelength, weights = equal_energy_colors()
    truth = np.stack([weights @ slab(c, index, thickness, substrate, wavelength) for c in COSINES], axis=1)
    found = curve(index, thickness, substrate, exact_sensitivity())(COSINES)
    np.testing.assert_allclose(found, np.clip(truth, 0.0, 1.0), atol=3e-4)


def test_a_thick_film_reflects_without_interference():
    """R12 + T12^2 R23 / (1 - R12 R23) for each polarisation.

    Here along the normal, where they are equal.

    At path differences of 150 micrometres 2e-5 of the transform is left.
    """
    index, substrate = 1.5, 2.4
    outer = ((1.0 - index) / (1.0 + index)) ** 2
    inner = ((index - substrate) / (index + substrate)) ** 2
    expected = outer + (1.0 - outer) ** 2 * inner / (1.0 - outer * inner)
    np.testing.assert_allclose(curve(index, 50_000.0, substrate, exact_sensitivity())(np.ones(1)), expected, rtol=3e-5)


@pytest.mark.parametrize("substrate", SUBSTRATES)
def test_a_film_that_is_hardly_there_changes_nothing(substrate):
    """At 0.1 nm there is none, and next to it the index has faded to that outside."""
    bare = (
        fresnel.conductor(COSINES, substrate.real, substrate.imag)
        if substrate.imag
        else fresnel.dielectric(COSINES, substrate)
    )
    for thickness, apart in ((0.1, 1e-12), (0.101, 3e-3)):
        found = curve(1.8, thickness, substrate, exact_sensitivity())(COSINES)
        np.testing.assert_allclose(found, np.broadcast_to(bare, (3, COSINES.size)), atol=apart)


def test_a_film_of_the_substrates_index_is_no_film():
    found = curve(1.5, 300.0, 1.5, exact_sensitivity())(COSINES)
    np.testing.assert_allclose(found, np.broadcast_to(fresnel.dielectric(COSINES, 1.5), (3, COSINES.size)), atol=1e-9)


def test_all_is_reflected_beyond_the_substrates_critical_angle():
    """From glass of index 1.5 through a film of 1.33 into air.

    Beyond 41.8 degrees everything is reflected, whatever the film.
    """
    cosines = np.linspace(0.0, 0.745, 50)
    found = curve(1.33 / 1.5, 300.0, 1.0 / 1.5, exact_sensitivity())(cosines)
    np.testing.assert_allclose(found, 1.0, atol=2e-5)


def test_a_film_is_seen_alike_from_both_sides():
    """Reflectances of a lossless film are equal from both sides (Stokes).

    From inside the angle is the refracted one.
    """
    cosine = np.array([0.2, 0.5, 0.9])
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / 1.5**2)
    there = curve(1.8, 400.0, 1.5, exact_sensitivity())(cosine)
    back = curve(1.8 / 1.5, 400.0, 1.0 / 1.5, exact_sensitivity(), 1.5)(inside)
    np.testing.assert_allclose(there, back, atol=5e-5)


@pytest.mark.parametrize("substrate", SUBSTRATES)
def test_cycles_series_stays_near_the_integral(substrate):
    """The error is what is left out after the third order and between the table's entries.

    It is at most 2 % of white on metals, 0.4 % on dielectrics.
    """
    for index, thickness in FILMS:
        exact, series = (
            curve(index, thickness, substrate, to)(COSINES) for to in (exact_sensitivity(), cycles_sensitivity())
        )
        assert np.abs(series - exact).max() < (2e-2 if substrate.imag else 4e-3), (index, thickness)


@pytest.mark.parametrize("kind", ["conductor", "F82", "dielectric"])
def test_the_table_of_a_curve_is_the_curve(kind, rng):
    film = Film(np.float64(700.0), np.float64(1.6), exact_sensitivity())
    colors = np.array([[0.9], [0.5], [0.1]])
    made = {
        "conductor": FilmConductor(film, colors, 3.0 - colors),
        "F82": FilmF82(film, colors, 1.0 - colors),
        "dielectric": FilmDielectric(film, np.float64(1.5), 0.04 * colors),
    }[kind]
    tabulated, cosines = under_film(made), rng.random(2000)
    assert isinstance(tabulated, Tabulated)
    np.testing.assert_allclose(tabulated(cosines), made(cosines), atol=1e-5)
    np.testing.assert_array_equal(tabulated.average, made.average)


def test_the_mean_of_a_curve_is_its_integral(rng):
    film = Film(np.float64(300.0), np.float64(1.6), exact_sensitivity())
    made = FilmF82(film, np.array([[0.9], [0.5], [0.1]]), np.ones((3, 1)))
    cosines = (np.arange(20_000) + 0.5) / 20_000
    np.testing.assert_allclose(made.average[:, 0], (2.0 * cosines * made(cosines)).mean(axis=1), rtol=1e-5)
    np.testing.assert_array_equal(made.average_cycles, F82(made.f0, made.tint).average_cycles)


def test_a_film_over_the_horizon_of_a_texture_has_parts(rng):
    """Where thickness differs from point to point, each point has its own film.

    It has the reflectance of that film.
    """
    thickness, cosines = np.array([0.0, 250.0, 600.0]), np.array([0.3, 0.6, 0.9])
    metal = FilmConductor(
        Film(thickness, np.float64(1.4), exact_sensitivity()), np.full((3, 1), 0.2), np.full((3, 1), 3.0)
    )
    assert under_film(metal) is metal
    for k in range(3):
        one = metal.part(np.array([k]))
        np.testing.assert_allclose(one(cosines[k : k + 1]), metal(cosines)[:, k : k + 1], rtol=1e-12)
    np.testing.assert_allclose(metal(cosines)[:, 0], fresnel.conductor(0.3, 0.2, 3.0), rtol=1e-12)
