# SPDX-License-Identifier: GPL-3.0-or-later
"""Planted materials are identified, and intervals hold the truth.

A material that is no candidate is reported as such.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.fit.candidates import MULTI_GGX, Candidate
from etalon.lib.fit.identify import identify
from etalon.lib.fit.observations import plain_observations
from etalon.lib.fit.solve import search, solve_from
from etalon.lib.fit.words import fit_figures, fit_lines, untold
from etalon.tests.lib.fit.planted import ISOTROPIC_GGX, planted


@pytest.mark.slow
def test_beckmann_and_ggx_are_told_apart_and_their_parameters_found(rng):
    for distribution in ("ggx", "beckmann"):
        truth = Candidate(distribution, "correlated", "schlick", False)
        found = identify(planted(rng, truth, 0.3, colors=1))
        assert found.fits
        assert {one.candidate.distribution for one in found.equivalent} == {distribution, "student-t"}
        assert truth in [one.candidate for one in found.equivalent]
        assert found.best.candidate.distribution == distribution
        low, high = found.intervals["alpha"]
        assert (
            0.3 * 0.99 < low < high < 0.3 * 1.01
        )  # narrow, and about the truth: how often it is inside is a benchmark
        _, one, two = found.inverse_g
        assert {"ggx": one - 0.01 < 0.5 < two + 0.01, "beckmann": one < 0.01}[distribution]
        assert found.reflectances() == pytest.approx([0.9], rel=0.01)


@pytest.mark.slow
def test_two_lobes_in_one_are_called_none_of_these(seed):
    """A broad one and a narrow one, at the same directions."""
    broad, narrow = (
        planted(np.random.default_rng(seed), ISOTROPIC_GGX, alpha, count=100, colors=1) for alpha in (0.3, 0.05)
    )
    found = identify(replace(broad, values=broad.values + narrow.values))
    assert not found.fits
    assert "none of these models explains the data" in fit_lines(found)[1]
    assert fit_figures(found)["fits"] is False


def test_noise_that_hides_the_masking_leaves_it_untold(rng):
    found = identify(planted(rng, Candidate("ggx", "correlated", "none", False), 0.05, noise=0.05, count=100, colors=1))
    assert found.fits
    assert {"correlated", "separable"} <= set(untold(found)["masking"])
    assert any("cannot tell the masking" in line for line in fit_lines(found))


def test_a_descent_from_one_start_ends_in_a_false_minimum_that_the_search_leaves(rng):
    truth = Candidate("beckmann", "correlated", "none", False)
    seen = planted(rng, truth, 0.01, count=300, colors=1)
    broad, found = solve_from(truth, seen, [np.log([0.9])]), search(truth, seen)
    assert broad.named["alpha"] > 0.3
    assert found.named["alpha"] < 0.02
    assert broad.chi2 > 10.0 * found.chi2


def test_nothing_lit_is_one_line():
    wi = np.tile([[0.0], [0.0], [1.0]], 100)
    with pytest.raises(EtalonError, match="nothing lit to fit"):
        identify(plain_observations(wi, wi, np.zeros((3, 100)), 0.01, False, "black.binary"))


def test_multiscatter_ggx_is_told_from_ggx_where_it_gives_much_back(rng):
    """At alpha 0.6 more than a tenth of the light is reflected again.

    A single lobe of any alpha lacks its shape.
    """
    truth = Candidate(MULTI_GGX, "correlated", "none", False)
    found = identify(planted(rng, truth, 0.6, noise=0.002, count=300, colors=1))
    assert found.fits
    assert found.best.candidate == truth
    low, high = found.intervals["alpha"]
    assert 0.6 * 0.97 < low < high < 0.6 * 1.03
    assert "multi-ggx, correlated Smith masking, no Fresnel term" in fit_lines(found)[1]
