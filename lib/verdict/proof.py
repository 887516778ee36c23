# SPDX-License-Identifier: GPL-3.0-or-later
"""What it would cost to prove a likely cause."""

from __future__ import annotations

import numpy as np
from scipy.special import stdtrit

from .attribution import Attribution, Names
from .boundaries import GROWTH
from .causes import BAND
from .claims import combine
from .shares import CHANNELS, Sides, less

_MOST_GROWTH = 1e6
# Standard errors by which each statistic is to pass, so that one that falls short of its mean still does.
_SPARE = 1.0


def growth_of_proof(search: Attribution, names: Names, sides: Sides) -> float:
    """The factor by which the data must grow until `names` are shown to explain every region.

    The data are replicates on both sides, and pairs.
    It is what the claims of `Attribution.explained` need if `names` are the cause: nothing is left over and every share
    is 1, so each statistic is the distance to its limit in standard errors, which shrink like 1 / sqrt(n). Infinite
    beyond a million.
    """
    effect = search.moments(names)
    rest = combine(sides.candidate, sides.reference, 1.0, shift=effect)
    wanted, different = search.wanted, search.different
    df = np.nan_to_num(rest.df, nan=np.inf).min()
    if not np.isfinite(df):
        return np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        agreement = (search.test.tolerance * sides.scale / rest.error)[wanted].min(axis=1)
        ends = [
            np.take_along_axis(np.abs((1 - 1 / end) * sides.gap) / less(sides, effect, end).error, sides.channel, 1)
            for end in BAND
        ]
    between = np.minimum(*ends)[different, 0]
    # Regions that have no pixel left need no proof.
    agreement, between = np.sort(agreement[np.isfinite(agreement)]), between[np.isfinite(between)]
    level = search.level_of(names) / 2.0
    for growth in np.geomspace(1.0, _MOST_GROWTH, 400):
        looks = search.spending.looks + max(1, round(np.log(growth) / np.log(GROWTH)))
        spent = search.spending.share_of(looks)
        p = level * spent
        holm = p / np.arange(1, agreement.size + 1)
        enough = -stdtrit(df * growth, holm) + _SPARE
        if (np.sqrt(growth) * agreement < enough[::-1]).any():
            continue
        enough = -stdtrit(df * growth, p / (CHANNELS * search.test.outcomes.size)) + _SPARE
        if (np.sqrt(growth) * between >= enough).all():
            return float(growth)
    return np.inf
