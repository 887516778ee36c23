# SPDX-License-Identifier: GPL-3.0-or-later
"""Every lobe answers in the same shapes.

What wraps a lobe passes on what it does not change.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.ashikhmin_shirley import AshikhminShirley
from etalon.lib.bsdfs.compensated import Compensated
from etalon.lib.bsdfs.dielectric import Interface, RoughDielectric, SmoothInterface
from etalon.lib.bsdfs.films import Film, FilmF82
from etalon.lib.bsdfs.fresnels import F82, Dielectric
from etalon.lib.bsdfs.lambert import Lambert, LambertTransmission
from etalon.lib.bsdfs.lobe import Lobe, to_rgb
from etalon.lib.bsdfs.microfacet import MicrofacetReflection
from etalon.lib.bsdfs.oren_nayar import OrenNayar
from etalon.lib.bsdfs.reflected import Reflected
from etalon.lib.bsdfs.rotated import Rotated
from etalon.lib.bsdfs.sheen import Sheen
from etalon.lib.bsdfs.specular import Mirror, SmoothDielectric
from etalon.lib.bsdfs.tilted import Tilted
from etalon.lib.bsdfs.toon import Toon
from etalon.lib.bsdfs.velvet import Velvet
from etalon.lib.departures.closures import Misstated
from etalon.lib.departures.light_below import HeldAgainstFace
from etalon.lib.empirical.models import EMPIRICAL
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.microfacets.thin_film import cycles_sensitivity
from etalon.lib.sampling.warps import uniform_sphere

COUNT = 40
WO = np.repeat(np.array([[0.48], [0.36], [0.8]]), COUNT, axis=1)
ALPHA = np.float64(0.3)
ETA = np.full(COUNT, 1.5)
WHITE = np.ones((3, 1))
GLASS = Interface(Dielectric(ETA), WHITE, WHITE)
ROWS = np.repeat(np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]])[:, :, None], COUNT, axis=2)
TURN = np.full(COUNT, 0.6), np.full(COUNT, 0.8)
FILM = FilmF82(Film(np.float64(300.0), np.float64(1.5), cycles_sensitivity()), np.full((3, 1), 0.5), WHITE)
CURVE = F82(np.full((3, 1), 0.5), WHITE)
UP = np.repeat([[0.0], [0.0], [1.0]], COUNT, axis=1)
LAFORTUNE = (), (-1.0, -0.9, 0.8)


def glossy(strategy):
    return MicrofacetReflection(WO, ALPHA, ALPHA, GGX(), "correlated", strategy)


LOBES = {
    "Lambert": Lambert(),
    "transmission": LambertTransmission(),
    "Oren-Nayar": OrenNayar(WO, np.float64(0.5), 0.5 * WHITE),
    "Ashikhmin-Shirley": AshikhminShirley(WO, ALPHA, ALPHA),
    **{strategy: glossy(strategy) for strategy in ("visible", "bounded", "d_cos", "cosine", "uniform")},
    "rough glass": RoughDielectric(WO, ALPHA, ALPHA, ETA, Beckmann(), GLASS),
    "smooth tinted glass": SmoothInterface(WO, ETA, GLASS),
    "mirror": Mirror(WO),
    "smooth glass": SmoothDielectric(WO, ETA, True),
    "smooth refraction": SmoothDielectric(WO, ETA, False),
    "compensated": Compensated(glossy("visible"), np.full((3, COUNT), 1.1)),
    "reflected": Reflected(glossy("visible"), WO, CURVE),
    "grey reflected": Reflected(glossy("visible"), WO, Dielectric(ETA)),
    "reflected mirror": Reflected(Mirror(WO), WO, CURVE),
    "under a film": Reflected(glossy("visible"), WO, FILM),
    "rotated": Rotated(glossy("visible"), *TURN),
    "sheen": Sheen(WO, ALPHA),
    "velvet": Velvet(WO, ALPHA),
    **{name: make(*LAFORTUNE[name == "lafortune"])(WO, ALPHA, ALPHA) for name, make in EMPIRICAL.items()},
    "toon": Toon(WO, ALPHA, ALPHA, False),
    "glossy toon": Toon(WO, np.full(COUNT, 0.2), np.full(COUNT, 0.1), True),
    "tilted": Tilted(Lambert(), ROWS),
    "tilted mirror": Tilted(Mirror(WO), ROWS),
    "held against the face": HeldAgainstFace(Lambert(), ROWS, UP, True),
    "mirror held against the face": HeldAgainstFace(Mirror(WO), ROWS, UP, False),
    "misstated": Misstated(glossy("visible"), np.full(COUNT, 1.01)),
}
EACH = pytest.mark.parametrize("lobe", LOBES.values(), ids=LOBES)


def lobe_classes(base=Lobe):
    return {base, *(found for child in base.__subclasses__() for found in lobe_classes(child))}


@EACH
def test_values_and_weights_are_colours_and_densities_numbers(lobe, rng):
    wi, weight, pdf = lobe.sample(*rng.random((2, COUNT)))
    assert wi.shape == weight.shape == (3, COUNT)
    assert pdf.shape == (COUNT,)
    value, density = lobe.evaluate(wi)
    assert value.shape == (3, COUNT)
    assert density.shape == (COUNT,)
    assert bool(np.isinf(pdf).all()) == lobe.delta
    if lobe.delta:
        assert not value.any()
        assert not density.any()
        assert lobe.widening(wi).shape == (COUNT,)


@EACH
def test_a_part_keeps_the_shapes_and_the_estimate(lobe, rng):
    index = np.array([3, 0, 17])
    part = lobe.part(index)
    wi, weight, pdf = part.sample(*rng.random((2, 3)))
    assert wi.shape == weight.shape == (3, 3)
    assert pdf.shape == (3,)
    assert type(part) is type(lobe)
    assert part.delta == lobe.delta
    whole = np.broadcast_to(lobe.estimate, COUNT)
    np.testing.assert_array_equal(np.broadcast_to(part.estimate, 3), whole[index])


@pytest.mark.grid(3)
@pytest.mark.parametrize("name", [name for name, lobe in LOBES.items() if not lobe.delta])
def test_samples_carry_the_energy_of_the_values(name, rng):
    """The mean weight is the integral of f |cos| over the sphere.

    That is found by uniform directions: both within five standard errors.
    """
    lobe = LOBES[name].part(rng.integers(COUNT, size=80_000))
    _, weight, pdf = lobe.sample(*rng.random((2, 80_000)))
    weight = np.where(pdf > 0.0, weight, 0.0)
    value = 4.0 * np.pi * lobe.evaluate(uniform_sphere(*rng.random((2, 80_000))))[0]
    error = np.sqrt((weight.var(axis=1) + value.var(axis=1)) / 80_000)
    assert np.all(np.abs(weight.mean(axis=1) - value.mean(axis=1)) < 5.0 * error)
    assert np.all(error < 0.05)


@pytest.mark.parametrize(
    "wrap",
    [
        lambda x: Tilted(x, ROWS),
        lambda x: HeldAgainstFace(x, ROWS, UP, False),
        lambda x: Rotated(x, *TURN),
        lambda x: Misstated(x, TURN[0]),
    ],
)
def test_a_wrapped_lobe_is_picked_and_widened_as_it_would_be_alone(wrap, rng):
    np.testing.assert_array_equal(wrap(LOBES["reflected"]).estimate, LOBES["reflected"].estimate)
    # From wo to wi beyond the interface: cos_o / (eta^2 cos_i), in the frame of the lobe itself.
    bent = SmoothDielectric(WO, ETA, False)
    wi, *_ = wrap(bent).sample(*rng.random((2, COUNT)))
    cosine = np.sqrt(1.0 - (1.0 - 0.8**2) / 1.5**2)
    np.testing.assert_allclose(wrap(bent).widening(wi), 0.8 / (1.5**2 * cosine), rtol=1e-12)


def test_no_class_of_lobes_is_left_out():
    base = {"Lobe", "DeltaLobe", "Wrapper", "StrayAshikhminShirley", "MirrorPower", "HalfVector", "_OfDistribution"}
    made = {kind.__name__ for kind in lobe_classes() if kind.__module__.startswith("etalon.lib")}
    assert made - base == {type(lobe).__name__ for lobe in LOBES.values()}


def test_a_grey_value_is_shown_in_three_colours_without_a_copy():
    value = np.arange(4.0)
    shown = to_rgb(value)
    assert np.shares_memory(shown, value)
    np.testing.assert_array_equal(shown, np.stack([value] * 3))
    with pytest.raises(ValueError, match="read-only"):
        shown[0, 0] = 1.0
