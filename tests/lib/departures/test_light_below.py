# SPDX-License-Identifier: GPL-3.0-or-later
"""Light below the face, lobe by lobe: what samples are held against, and the weight of what light sampling finds there."""

import numpy as np
import pytest
from etalon.lib.bsdfs.lambert import Lambert, LambertTransmission
from etalon.lib.bsdfs.mixture import Mixture
from etalon.lib.departures.light_below import hold_against_face
from etalon.lib.lights.light import LightSample
from etalon.lib.scene.materials import Diffuse, Glossy, Sheen, Translucent, Velvet
from etalon.lib.wavefront.light_choice import LightChoice, LightSampling, weigh_light

COUNT = 200_000


def leaning(turn):
    """The normal that leans by `turn` from the common one, as a column."""
    return np.array([[np.sin(turn)], [0.0], [np.cos(turn)]])


def held(closure, turn, face, inner=None):
    """`inner`, or white diffuse reflection, about a normal that leans by `turn`, over a face that leans by `face`."""
    t, s = np.array([[np.cos(turn)], [0.0], [-np.sin(turn)]]), np.array([[0.0], [1.0], [0.0]])
    rows = np.repeat(np.stack([t, s, leaning(turn)]), COUNT, axis=2)
    return hold_against_face(inner or Lambert(), rows, np.repeat(leaning(face), COUNT, axis=1), closure)


def shared(turn):
    """The part of the cosine's hemisphere about one of two normals, `turn` apart, that both see."""
    return 0.5 * (1.0 + np.cos(turn))


@pytest.mark.parametrize(
    ("closure", "inner", "face", "share"),
    [
        (Diffuse(), None, 0.3, shared(0.7)),
        (Diffuse(), None, -0.4, shared(1.1)),
        (Sheen(), None, 0.3, shared(0.7)),
        (Velvet(), None, 0.3, shared(0.4)),
        (Glossy("GGX"), None, 0.3, shared(0.4)),
        (Glossy("GGX"), None, -0.4, shared(1.1)),
        (Translucent(), LambertTransmission(), 0.3, shared(0.4)),
    ],
    ids=["diffuse", "diffuse, far", "sheen", "velvet", "glossy", "glossy, far", "translucent"],
)
def test_samples_are_held_against_the_face_and_those_of_diffuse_reflection_against_the_common_normal(
    closure, inner, face, share, rng
):
    """The lobe's normal leans by 0.7 from the common one.

    Where the face leans by 0.3, light between its horizon and that of the common normal counts for glossy and for translucent
    lobes.
    """
    _, weight, _ = held(closure, 0.7, face, inner).sample(*rng.random((2, COUNT)))
    assert weight.mean() == pytest.approx(share, abs=4.5 * np.sqrt(share * (1.0 - share) / COUNT))


def test_a_sample_below_the_face_brings_nothing_of_any_lobe(rng):
    """Of two equal lobes about the common normal, over a face that leans by 0.5, as much is left as of one."""
    lobes = [held(closure, 0.0, 0.5) for closure in (Diffuse(), Glossy("GGX"))]
    half = np.full((3, 1), 0.5)
    _, weight, _ = Mixture(lobes, [half, half], COUNT).sample(*rng.random((3, COUNT)))
    share = shared(0.5)
    assert weight.mean() == pytest.approx(share, abs=4.5 * np.sqrt(share * (1.0 - share) / COUNT))


def test_evaluation_asks_the_common_normal_alone(rng):
    wi = rng.standard_normal((3, COUNT))
    wi /= np.linalg.norm(wi, axis=0)
    value, _ = held(Diffuse(), 0.7, -0.4).evaluate(wi)
    cosine = (leaning(0.7) * wi).sum(axis=0)
    np.testing.assert_allclose(value[0], np.maximum(cosine, 0.0) / np.pi * (wi[2] > 0.0), atol=1e-12)


def test_light_samples_below_the_face_have_the_weight_of_the_power_heuristic():
    """Densities of 1 and 10: p^2 / (p^2 + q^2) is 1/101, where the cutoff leaves none."""
    one = np.ones(2)
    sample = LightSample(np.ones((3, 2)), one, np.ones((3, 2)), one)
    light = LightChoice(sample, np.zeros(2, np.intp), one, np.asarray(False))
    sampling = LightSampling(runs=True, selects=False, weighs=True, by_lobes=False, below_faces=True)
    found = weigh_light(sampling, light, 10.0 * one, np.array([True, False]))
    np.testing.assert_allclose(found, [1.0 / 101.0, 0.0], rtol=1e-12)
