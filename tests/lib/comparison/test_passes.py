# SPDX-License-Identifier: GPL-3.0-or-later
"""Light passes in a comparison.

A small pass that differs is named, and the claims on the image stay as they are.
"""

import numpy as np
import pytest
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.departures import Alternatives
from etalon.lib.departures.catalogue import Departure
from etalon.lib.film.light_passes import LightPass
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.renderers import Painter, blank, grey

SHARES = {LightPass.GLOSSY_INDIRECT: 0.05, LightPass.DIFFUSE_DIRECT: 0.65, LightPass.DIFFUSE_INDIRECT: 0.3}
LEFT = np.pad(np.ones((20, 12)), ((0, 0), (0, 12)))
OPTIONS = CompareOptions(time=None, samples=256, replicates=30)


def compared(factors, passes=tuple(SHARES), change=None, options=OPTIONS, among=None, sigma=0.05):
    """A comparison with a candidate whose passes are `factors` times the reference's.

    They are (height, width, 1) or numbers.
    """
    parts = {light: grey(share) for light, share in SHARES.items()}
    others = {light: part * factors.get(light, 1.0) for light, part in parts.items()}
    reference = Painter("the reference", grey(), sigma, passes=parts)
    candidate = Painter("Cycles", sum(others.values()), sigma, change=change, passes=others)
    return compare(blank(), reference, candidate, {"material": [("Left", LEFT)]}, options, among=among, passes=passes)


def test_a_difference_that_the_image_hides_is_found_in_its_pass():
    """5 % less of a pass that is a twentieth of the light.

    The image agrees to within 1 %, the pass does not.
    """
    comparison = compared({LightPass.GLOSSY_INDIRECT: 0.95})
    assert comparison.verdict.outcome is Outcome.EQUIVALENT
    found = comparison.passes
    k = found.passes.index(LightPass.GLOSSY_INDIRECT)
    assert (found.outcomes[k] == Outcome.DIFFERENT).all()
    assert (np.delete(found.outcomes, k, axis=0) == Outcome.EQUIVALENT).all()
    assert (found.low[k] < -0.05).all()
    assert (found.high[k] > -0.05).all()
    assert (found.high[k] < -0.045).all()
    np.testing.assert_allclose(found.shares[:, 0], list(SHARES.values()), rtol=0.01)


def test_a_pass_that_differs_in_one_material_alone_is_found_there():
    """Brighter on the left by as much as it is darker on the right."""
    comparison = compared({LightPass.GLOSSY_INDIRECT: 1.0 + 0.08 * (2.0 * LEFT - 1.0)[..., None]})
    k = comparison.passes.passes.index(LightPass.GLOSSY_INDIRECT)
    assert comparison.passes.outcomes[k].tolist() == [Outcome.EQUIVALENT, Outcome.DIFFERENT]


def test_without_passes_there_is_no_verdict_on_them():
    assert compared({}, passes=()).passes is None


@pytest.mark.parametrize("apply", [True, False])
def test_claims_on_the_image_keep_their_level(apply):
    """With departures to try or without, the image's level is the same with passes as without."""
    known = (Departure("a", "", ""),)
    among = Alternatives(known, lambda names: Painter("the reference", grey())) if apply else None
    levels = [compared({}, passes=passes, among=among).verdict.looks[-1].level for passes in ((), tuple(SHARES))]
    assert levels[0] == levels[1]


def test_pixels_that_are_not_finite_count_in_no_pass():
    """One pixel of Cycles turns bad in the fifth replicate; the passes go on without it."""

    def turn_bad(replicate, image):
        if replicate % 16 == 5:
            image[3, 4] = np.nan
        return image

    found = compared({LightPass.GLOSSY_INDIRECT: 0.95}, change=turn_bad).passes
    assert np.isfinite(found.difference).all()
    assert (found.outcomes[found.passes.index(LightPass.GLOSSY_INDIRECT)] == Outcome.DIFFERENT).all()


@pytest.mark.parametrize("runs", [4, pytest.param(40, marks=pytest.mark.slow)])
def test_equal_passes_are_seldom_called_different(runs):
    """Noise alone, at a tolerance far below it.

    There is no claim of a difference at 99 % confidence in `runs` comparisons.
    """
    for k in range(runs):
        options = CompareOptions(time=None, samples=1, replicates=12, tolerance=1e-4, seed=k)

        def shift(replicate, image, k=k):
            return image * (1.0 + 0.001 * np.random.default_rng([k, replicate]).standard_normal())

        found = compared({}, options=options, change=shift).passes
        assert not (found.outcomes == Outcome.DIFFERENT).any()
