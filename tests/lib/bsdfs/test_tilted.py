# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes about a normal of their own.

Light counts only where the face and the turned normal see it on the same side.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.lambert import Lambert, LambertTransmission
from etalon.lib.bsdfs.tilted import Tilted
from scipy.special import roots_legendre

TURNS = [0.2, 0.7, 1.3]


def tilted(inner, turn, count):
    """`inner` about the normal (sin turn, 0, cos turn)."""
    t, s, n = (np.cos(turn), 0.0, -np.sin(turn)), (0.0, 1.0, 0.0), (np.sin(turn), 0.0, np.cos(turn))
    return Tilted(inner, np.repeat(np.array([t, s, n])[:, :, None], count, axis=2))


def sphere(turn, nodes=120):
    """Directions and weights of a quadrature over the whole sphere.

    Polar coordinates are about the y axis. About y both horizons, of the face and of the turned normal, are arcs of
    constant longitude: the rule has a break at each.
    """
    x, w = roots_legendre(nodes)
    half = 0.5 * np.pi
    breaks = np.array([-np.pi, -half - turn, -half, -half + turn, half - turn, half, half + turn, np.pi])
    low, width = breaks[:-1, None], np.diff(breaks)[:, None]
    phi = (low + 0.5 * width * (x + 1.0)).ravel()
    phi_weight = (0.5 * width * w).ravel()
    y, phi = (grid.ravel() for grid in np.meshgrid(x, phi, indexing="ij"))
    ring = np.sqrt(1.0 - y * y)
    # Longitude 0 is the face's normal; the turned normal has longitude `turn`.
    return np.stack([ring * np.sin(phi), y, ring * np.cos(phi)]), np.outer(w, phi_weight).ravel()


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("inner", [Lambert(), LambertTransmission()], ids=["reflected", "transmitted"])
def test_a_turned_lambert_lobe_keeps_what_both_sides_see(inner, turn):
    """The integral of cos / pi about n' over directions that n and n' see alike.

    It is (1 + cos turn) / 2.
    """
    wi, weight = sphere(turn)
    value, _ = tilted(inner, turn, wi.shape[1]).evaluate(wi)
    assert value @ weight == pytest.approx(0.5 * (1.0 + np.cos(turn)), rel=1e-6)


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("inner", [Lambert(), LambertTransmission()], ids=["reflected", "transmitted"])
def test_samples_weigh_what_both_sides_see(inner, turn, rng):
    """Sampling loses the same part as evaluation."""
    count = 200_000
    _, weight, _ = tilted(inner, turn, count).sample(*rng.random((2, count)))
    share = 0.5 * (1.0 + np.cos(turn))
    assert weight.mean() == pytest.approx(share, abs=4.5 * np.sqrt(share * (1.0 - share) / count))


def test_light_below_the_face_does_not_reach_a_turned_normal_above_it():
    """Light below the face and above the turned normal's horizon is not reflected.

    It lies 0.2 below the face and 0.6 above the horizon of a normal turned by 0.8. Its mirror image is not transmitted
    either.
    """
    below = np.array([[np.cos(0.2)], [0.0], [-np.sin(0.2)]])
    turned = np.sin(0.8) * below[0] + np.cos(0.8) * below[2]
    assert turned[0] == pytest.approx(np.sin(0.6))
    assert tilted(Lambert(), 0.8, 1).evaluate(below)[0][0] == 0.0
    assert tilted(LambertTransmission(), 0.8, 1).evaluate(-below)[0][0] == 0.0
    # On the side that both see it is the plain cosine.
    above = np.array([[np.cos(0.2)], [0.0], [np.sin(0.2)]])
    assert tilted(Lambert(), 0.8, 1).evaluate(above)[0][0] == pytest.approx(np.sin(1.0) / np.pi)
