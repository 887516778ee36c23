# SPDX-License-Identifier: GPL-3.0-or-later
"""From two films to EQUIVALENT, DIFFERENT, UNDECIDED or EXPLAINED, region by region.

outcome.py the words, claims.py p-values, intervals and bounds of one look, boundaries.py looks and what they spend, sequential.py
all regions under one error level, rare.py light that no sample has met, forecast.py what a bound would cost, verdict.py the whole,
allocation.py how a time budget is shared, attribution.py which named departures explain what differs.

What is assumed: replicates are independent, and a region's mean over one replicate is near enough to normal for Student's t. For light in
rare samples every claim leaves room, up to what docs/statistics.md calls the blind spot.
"""
