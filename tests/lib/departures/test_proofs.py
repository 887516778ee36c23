# SPDX-License-Identifier: GPL-3.0-or-later
"""Which side is right: proofs of departures.

Each is tested against quadrature, a closed form or a law of conservation, never against a renderer.
"""

from pathlib import Path
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from etalon.lib.bsdfs.ashikhmin_shirley import AshikhminShirley
from etalon.lib.bsdfs.compensated import EXACT, albedos_of, multiple_scattering
from etalon.lib.bsdfs.dielectric import Interface, RoughDielectric
from etalon.lib.bsdfs.films import Film, FilmConductor
from etalon.lib.bsdfs.fresnels import Dielectric
from etalon.lib.bsdfs.layered import beneath_layer
from etalon.lib.bsdfs.oren_nayar import OrenNayar
from etalon.lib.departures.closures import StrayAshikhminShirley
from etalon.lib.departures.scene import narrow_factor
from etalon.lib.lights.spread import Spread
from etalon.lib.microfacets import albedo, masking, thin_film
from etalon.lib.microfacets.beckmann import Beckmann, smith_lambda_rational
from etalon.lib.microfacets.cycles_tables import COARSE, FINE
from etalon.lib.microfacets.fresnel import dielectric
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.scene.expressions import (
    Constant,
)
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.materials import Glass
from etalon.lib.settings.reference import Options
from etalon.lib.surfaces.lobes import _dielectric
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests import scenes
from scipy.special import roots_legendre


def towards(cos):
    cos = np.atleast_1d(np.asarray(cos, float))
    return np.stack([np.sqrt(1.0 - cos * cos), np.zeros_like(cos), cos])


@pytest.mark.parametrize("angle", [36.0, 60.0, 78.0])
def test_what_microfacets_show_of_themselves_is_what_there_is_to_see(angle):
    """The visible part of all facets projects onto wo as the surface itself does.

    The integral of D max(o.m, 0) is (1 + Lambda) o.n (Heitz 2014, eq. 5 and 14). Over slopes x, y of a Beckmann
    surface of alpha 1 it is a Gaussian integral, here to 30 digits.
    """
    theta = mpmath.radians(angle)
    cos, sin = mpmath.cos(theta), mpmath.sin(theta)
    seen = mpmath.quad(
        lambda x: mpmath.exp(-x * x) / mpmath.sqrt(mpmath.pi) * (cos - sin * x), [-mpmath.inf, 0, cos / sin]
    )
    projected = float(seen / cos)
    wo = towards(float(cos))
    assert 1.0 + Beckmann().smith_lambda(wo, 1.0, 1.0)[0] == pytest.approx(projected, rel=1e-14)
    fit = 1.0 + smith_lambda_rational(wo, 1.0, 1.0)[0]
    assert 1e-4 < abs(fit / projected - 1.0) < 3.2e-3


def test_masking_and_shadowing_share_the_height_of_the_facet():
    """On Smith's surface a ray leaves unhindered with probability u^Lambda.

    It starts at the height that a share u of the surface lies below. Both directions leave from one height: the mean
    over u is 1 / (1 + sum), not the product of two means.
    """
    both, each = (np.array([0.3]), np.array([1.7])), [1.0 / 1.3, 1.0 / 2.7]
    mean = float(mpmath.quad(lambda u: u ** mpmath.mpf("0.3") * u ** mpmath.mpf("1.7"), [0, 1]))
    assert masking.height_correlated(*both)[0] == pytest.approx(mean, rel=1e-12)
    assert masking.separable(*both)[0] == pytest.approx(each[0] * each[1], rel=1e-12)
    assert masking.separable(*both)[0] < mean - 0.04


def test_through_facets_seen_from_behind_glass_would_make_light():
    """A density holds at most 1, and scattering gives back at most what arrives.

    Both are over the sphere, for single scattering; by quadrature, at 80 degrees.
    """
    mu, weight = roots_legendre(600)
    phi = np.arange(400) * 2 * np.pi / 400
    sin = np.sqrt(1 - mu * mu)[:, None]
    wi = np.stack([sin * np.cos(phi), sin * np.sin(phi), np.broadcast_to(mu[:, None], (600, 400))]).reshape(3, -1)
    measure = np.repeat(weight * 2 * np.pi / 400, 400)
    wo = np.repeat(towards(np.cos(np.radians(80.0))), measure.size, axis=1)
    plain = Interface(Dielectric(np.full(measure.size, 1.5)), np.ones((3, 1)), np.ones((3, 1)))
    held, given = {}, {}
    for backs in (False, True):
        lobe = RoughDielectric(
            wo, np.float64(0.64), np.float64(0.64), np.float64(1.5), GGX(), plain, "correlated", backs
        )
        value, pdf = lobe.evaluate(wi)
        held[backs], given[backs] = pdf @ measure, value[0] @ measure
    assert held[False] < 1.0
    assert given[False] < 1.0
    assert held[True] > 1.6
    assert given[True] > 1.3


def hemisphere(nodes, around):
    """Directions (3, n) of the upper hemisphere, and their solid angles.

    They lie at Gauss-Legendre nodes in the cosine.
    """
    mu, weight = roots_legendre(nodes)
    mu, phi = np.meshgrid(0.5 + 0.5 * mu, 2.0 * np.pi * (np.arange(around) + 0.5) / around, indexing="ij")
    sine = np.sqrt(1.0 - mu * mu)
    measure = np.repeat(0.5 * weight * 2.0 * np.pi / around, around)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu]).reshape(3, -1), measure


@pytest.mark.slow
@pytest.mark.parametrize(
    ("roughness", "least"),
    [(0.5, 0.06), *(pytest.param(*case, marks=pytest.mark.slow) for case in ((0.7, 0.35), (0.9, 0.6)))],
)
def test_half_vectors_that_face_away_from_the_viewer_give_no_light(roughness, least):
    """In a uniform world the mean weight of samples is the integral of the lobe.

    That is over directions (Ashikhmin and Shirley 2000, eq. 4). The departure adds the half vectors h of eq. 5 with
    h.o < 0, each by n.d / max(n.o, n.d) for d = -o - 2 (h.o) h. Both integrals are written out here; at 80 degrees.
    """
    n, cos_o = 2.0 / roughness**4 - 2.0, np.cos(np.radians(80.0))
    o = towards(cos_o)
    wi, measure = hemisphere(400, 400)
    h = (wi + o) / np.linalg.norm(wi + o, axis=0)
    lobe = (n + 1.0) / (8.0 * np.pi) * h[2] ** n / ((o * h).sum(axis=0) * np.maximum(cos_o, wi[2]))
    right = (lobe * wi[2]) @ measure
    h, measure = hemisphere(1500, 1500)
    c = (o * h).sum(axis=0)
    up = np.where(c < 0.0, -cos_o - 2.0 * c * h[2], 0.0)
    density = (n + 1.0) / (2.0 * np.pi) * h[2] ** n
    stray = (density * np.maximum(up, 0.0) / np.maximum(cos_o, up)) @ measure
    u = (np.arange(1000) + 0.5) / 1000
    u1, u2 = (one.ravel() for one in np.meshgrid(u, u))
    wo = np.repeat(o, u1.size, axis=1)
    how = wo, np.float64(roughness**2), np.float64(roughness**2)
    assert AshikhminShirley(*how).sample(u1, u2)[1].mean() == pytest.approx(right, rel=2e-5)
    wi, weight, _ = StrayAshikhminShirley(*how).sample(u1, u2)
    assert weight.mean() == pytest.approx(right + stray, rel=2e-5)
    assert np.linalg.norm(wi, axis=0) == pytest.approx(1.0, abs=1e-12)
    assert stray / right > least


def test_what_glass_reflects_follows_its_index():
    """At normal incidence glass reflects ((n - 1) / (n + 1))^2 at the wavelength's index.

    That is by Fresnel's equations; the departure has n_d's.
    """
    wavelength = np.array([430.0, 587.56, 700.0])
    points = SimpleNamespace(backfacing=np.zeros(3, bool), wavelength=wavelength)
    glass = Glass(ior=Constant(1.5), dispersion=Constant(0.2))
    read = lambda socket: np.asarray(socket.value if np.ndim(socket.value) == 0 else np.array(socket.value)[:, None])  # noqa: E731
    shown = {}
    for departures in ((), ("undispersed reflectance",)):
        site = SimpleNamespace(points=points, read=read, options=Options(departures=frozenset(departures)))
        shown[departures] = np.broadcast_to(_dielectric(glass, site)[1](np.ones(3)), (3, 3))[0]
    steps = wavelength**-2.0 - 587.56**-2.0
    index = 1.5 + 0.5 * 0.2 * steps / (486.13**-2.0 - 656.27**-2.0)
    assert shown[()] == pytest.approx(((index - 1.0) / (index + 1.0)) ** 2, rel=1e-12)
    assert shown[("undispersed reflectance",)] == pytest.approx(0.04, rel=1e-12)
    assert shown[()][0] > 0.05


def test_a_film_looks_alike_from_both_sides():
    """A lossless film reflects as much from outside as from inside (Stokes).

    Inside the angle is the refracted one, and each wavelength is tested.
    """
    read = lambda socket: np.asarray(socket.value)  # noqa: E731
    glass = Glass(ior=Constant(1.5), film_thickness=Constant(300.0), film_ior=Constant(1.8))
    outside = np.array([0.3, 0.6, 0.95])
    inside = np.sqrt(1.0 - (1.0 - outside**2) / 1.5**2)

    def seen(cosine, backfacing, *departures):
        points = SimpleNamespace(backfacing=np.full(3, backfacing), wavelength=None)
        site = SimpleNamespace(points=points, read=read, options=Options(departures=frozenset(departures)))
        return _dielectric(glass, site)[1](cosine)

    front = seen(outside, False)
    np.testing.assert_allclose(seen(inside, True), front, atol=1e-4)
    assert np.abs(seen(inside, True, "thin film from inside") - front).max() > 0.05


def test_a_film_is_more_than_three_orders_of_interference():
    """Under equal light of all wavelengths, by the reflectance of a film at each.

    See Born and Wolf, sec. 1.6.4. The view is near grazing on a metal.
    """
    observer = np.loadtxt(Path(thin_film.__file__).with_name("observer.txt"))
    weights = thin_film._REC709 @ observer[:, 1:].T
    weights /= weights.sum(axis=1, keepdims=True)
    cosine, index, metal, thickness = 0.05, 1.33, 1.5 + 1.8j, 60.0
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    beyond = np.sqrt(1.0 - (1.0 - cosine**2) / metal**2)
    turn = np.exp(4j * np.pi * index * thickness * inside / observer[:, 0])
    total = 0.0
    for outer, inner in (
        (
            (cosine - index * inside) / (cosine + index * inside),
            (index * inside - metal * beyond) / (index * inside + metal * beyond),
        ),
        (
            (index * cosine - inside) / (index * cosine + inside),
            (metal * inside - index * beyond) / (metal * inside + index * beyond),
        ),
    ):
        total = total + 0.5 * np.abs((outer + inner * turn) / (1.0 + outer * inner * turn)) ** 2
    truth = weights @ total
    shown = {}
    for to in (thin_film.exact_sensitivity(), thin_film.cycles_sensitivity()):
        film = Film(np.float64(thickness), np.float64(index), to)
        curve = FilmConductor(film, np.full((3, 1), metal.real), np.full((3, 1), metal.imag))
        shown[to.orders] = curve(np.array([cosine]))[:, 0]
    assert shown[None] == pytest.approx(truth, abs=1e-4)
    assert np.abs(shown[3] - truth).max() > 5e-3


def test_a_white_surface_loses_nothing_by_the_exact_albedo_alone():
    """Single scattering, by quadrature, times the compensation is 1 in a white furnace."""
    cos, alpha = np.array([0.05, 0.3, 0.9]), np.array([0.21, 0.5, 0.9]) ** 2
    single = albedo.integrate_albedo(cos, alpha)
    white = np.ones((3, 1))
    exact = single * multiple_scattering(cos, alpha, white, EXACT)[0]
    assert exact == pytest.approx(1.0, abs=2e-5)
    for tables, least in ((COARSE, 5e-3), (FINE, 5e-4)):
        tabulated = single * multiple_scattering(cos, alpha, white, albedos_of(tables))[0]
        assert abs(tabulated[0] - 1.0) > least


def test_a_layer_and_what_it_leaves_make_up_all_the_light():
    """A layer without absorption and a white base reflect 1 together.

    The base gives back whatever it gets. What the layer reflects is integrated over the lobe itself: D G F / (4 cos),
    F of the dielectric at the facet.
    """
    cos, alpha = np.array([0.1, 0.3, 0.6, 0.9]), np.full(4, 0.6**2)
    white = np.ones((3, 1))
    reflected = albedo.integrate_albedo(cos, alpha, reflectance=lambda c: dielectric(c, 1.5))
    left, *estimated = (
        beneath_layer("GGX", 1.5, white, np.float64(0.6), np.ones(1), cos, tables) for tables in (None, COARSE, FINE)
    )
    assert reflected + left == pytest.approx(1.0, abs=2e-5)
    for below in estimated:
        assert (reflected + below < 1.0 - 5e-3).all()


@pytest.mark.parametrize("ior", [0.8, 0.9])
def test_a_layer_that_reflects_totally_leaves_nothing_there(ior):
    """As above for an index below 1, at grazing, where nearly all is reflected totally.

    By Cycles' table the base gets it once more.
    """
    cos, alpha = np.array([0.1, 0.2]), np.full(2, 0.1**2)
    white = np.ones((3, 1))
    reflected = albedo.integrate_albedo(cos, alpha, reflectance=lambda c: dielectric(c, ior))
    left, *estimated = (
        beneath_layer("GGX", ior, white, np.float64(0.1), np.ones(1), cos, tables) for tables in (None, COARSE, FINE)
    )
    assert reflected + left == pytest.approx(1.0, abs=1e-3)
    for below in estimated:
        assert (reflected + below > 1.3).all()


@pytest.mark.parametrize("roughness", [0.2, 0.4, 0.8])
def test_a_coat_takes_from_below_what_it_reflects(roughness):
    """A coat with its multiple scattering and a white base under it reflect 1 together.

    This holds by quadrature, to what its average costs. Multiple scattering gives back E + Fms (1 - E) of a layer that
    loses E; without that factor more is taken than is given.
    """
    cos, alpha, ior = np.array([0.1, 0.3, 0.6, 0.99]), roughness**2, 1.5
    white = np.ones((3, 1))
    lit = albedo.integrate_albedo(cos, np.full(4, alpha))
    single = albedo.integrate_albedo(cos, np.full(4, alpha), reflectance=lambda c: dielectric(c, ior))
    node, weight = roots_legendre(400)
    mu, weight = 0.5 + 0.5 * node, weight * (0.5 + 0.5 * node)
    mean = (weight * dielectric(mu, ior)).sum()
    average = (weight * albedo.integrate_albedo(mu, np.full(400, alpha))).sum()
    share = mean * average / (1.0 - mean * (1.0 - average))
    reflected = single * (1.0 + share * (1.0 - lit) / lit)
    how = "MULTI_GGX", ior, white, np.float64(roughness), np.ones(1), cos
    left, lossless = (1.0 - beneath_layer(*how, lossless=departs) for departs in (False, True))
    assert left == pytest.approx(reflected, abs=2e-5)
    assert lossless == pytest.approx(reflected / (lit + share * (1.0 - lit)), abs=5e-5)
    for tables in (COARSE, FINE):
        taken, much = (1.0 - beneath_layer(*how, tables, departs) for departs in (False, True))
        assert (np.abs(taken / reflected - 1.0) < 0.15).all()
        assert (much > taken).all()
    assert (lossless[2:] / reflected[2:] > {0.2: 1.001, 0.4: 1.03, 0.8: 1.4}[roughness]).all()


@pytest.mark.parametrize("color", [0.1, 0.5, 0.8, 1.0])
def test_light_carries_the_colour_once_for_each_scattering(color):
    """A walk that leaves with probability E(o) at first and Eavg at every later scattering.

    The colour multiplies it each time.
    """
    roughness, cos_o = 1.0, 0.4
    a = 1.0 / (np.pi + roughness * (np.pi / 2.0 - 2.0 / 3.0))
    average = np.pi * a + roughness * a * (2.0 * np.pi - 5.6) / 3.0
    x, weight = roots_legendre(96)
    mu, phi = np.meshgrid(0.5 + 0.5 * x, np.pi * (1.0 + x), indexing="ij")
    weight = (0.5 * np.pi * np.outer(weight, weight)).ravel()
    mu, phi = mu.ravel(), phi.ravel()
    wi = np.stack([np.sqrt(1.0 - mu * mu) * np.cos(phi), np.sqrt(1.0 - mu * mu) * np.sin(phi), mu])
    wo = np.repeat(towards(cos_o), mu.size, axis=1)

    def reflected(shade, **how):
        return (OrenNayar(wo, roughness, np.full((3, 1), shade), **how).evaluate(wi)[0][0] * weight).sum()

    # Of the white surface nothing is lost, so what it does not give at once, 1 - E, is what small colours lack.
    first = reflected(1e-9) / 1e-9
    bounces = np.arange(400)
    later = (average * color**2 * (color * (1.0 - average)) ** bounces).sum()
    walk = color * first + (1.0 - first) * later
    assert reflected(color) == pytest.approx(walk, rel=2e-4)
    if color < 1.0:
        assert reflected(color, first=3) < walk * (1.0 - 1e-3)
    assert reflected(color, first=None) == pytest.approx(color * first, rel=2e-4)


@pytest.mark.parametrize("spread", [1e-3, 0.02, 0.1])
def test_a_narrow_light_sends_out_its_power(spread):
    """The flux through all angles is that of the light without spread, pi times its radiance.

    Cycles' series keeps one term.
    """
    h = mpmath.mpf(spread) / 2
    falloff = mpmath.quad(lambda x: (mpmath.tan(h) - mpmath.tan(x)) * mpmath.cos(x) * mpmath.sin(x), [0, h])
    exact = Spread(spread)(np.zeros(1))[0] / float(mpmath.tan(h)) * float(2 * falloff)
    assert exact == pytest.approx(1.0, rel=1e-12)
    assert float(3 / h**3 * 2 * falloff) == pytest.approx(narrow_factor(spread), rel=1e-9)
    assert narrow_factor(0.1) > 1.0009


@pytest.mark.parametrize("copies", [1, 2, 3])
def test_a_face_in_the_place_of_another_adds_nothing(copies):
    """A floor under a sun shows irradiance times albedo over pi, however often it exists.

    With the departure it shows nothing once it exists twice.
    """
    sun = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (np.pi,) * 3)
    camera = scenes.orthographic(1, 1, 1.0, (0.1, 0.0, 5.0))
    scene = scenes.scene([scenes.floor()] * copies, scenes.diffuse(0.8), camera, (sun,))
    for names, exact in (
        (frozenset(), 0.8 * 0.8),
        (frozenset({"faces in one plane"}), 0.8 * 0.8 if copies == 1 else 0.0),
    ):
        found = ReferenceRenderer(scene, Options(threads=1, departures=names)).render(0, 16).radiance
        assert found == pytest.approx(np.full((1, 1, 3), exact), rel=1e-12)
