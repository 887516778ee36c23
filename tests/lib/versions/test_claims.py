# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of two images is nearer to the truth: claims about means that are known."""

import numpy as np
import pytest
from etalon.lib.versions.claims import p_nearer

ROUNDS, TRIALS, LEVEL = 8, 4000, 0.05


def series(rng, first, second, shared=0.3, own=(0.2, 0.2)):
    """Differences to the truth of two versions with these means, in TRIALS regions.

    They have noise that they share and noise of their own.
    """
    common = shared * rng.standard_normal((ROUNDS, TRIALS, 1))
    return [
        mean + common + s * rng.standard_normal((ROUNDS, TRIALS, 1))
        for mean, s in zip((first, second), own, strict=True)
    ]


@pytest.mark.parametrize(
    ("first", "second"),
    [(3.0, 1.0), (-3.0, 1.0), (-3.0, -1.0), (3.0, -1.0)],
    ids=["above", "across", "below", "down across"],
)
def test_the_nearer_one_is_found_on_every_side_of_the_truth(rng, first, second):
    of_first, of_second = p_nearer(*series(rng, first, second))
    assert (of_second <= LEVEL).mean() > 0.9
    assert (of_first <= LEVEL).mean() < 0.01
    of_second, of_first = p_nearer(*series(rng, second, first))
    assert (of_second <= LEVEL).mean() > 0.9


@pytest.mark.parametrize(
    ("first", "second", "own"),
    [(2.0, 2.0, (0.2, 0.2)), (2.0, -2.0, (0.2, 0.2)), (0.0, 0.0, (0.2, 0.2)), (0.0, 0.0, (1.0, 0.01))],
    ids=["the same", "opposite", "both true", "both true, one noisier"],
)
def test_neither_is_claimed_nearer_more_often_than_the_level_where_both_are_as_near(rng, first, second, own):
    wrong = (p_nearer(*series(rng, first, second, shared=0.5, own=own)) <= LEVEL).any(axis=0).mean()
    # Both claims together, so twice the level, and three standard errors of so many trials.
    assert wrong <= 2 * LEVEL + 3 * np.sqrt(2 * LEVEL / TRIALS)


def test_images_that_are_equal_bit_for_bit_are_as_near(rng):
    same = rng.standard_normal((ROUNDS, 5, 3))
    assert (p_nearer(same, same) == 1.0).all()


def test_one_replicate_claims_nothing(rng):
    first, second = rng.standard_normal((2, 1, 5, 3))
    assert (p_nearer(first, second) == 1.0).all()
