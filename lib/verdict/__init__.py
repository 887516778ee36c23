# SPDX-License-Identifier: GPL-3.0-or-later
"""From two films to EQUIVALENT, DIFFERENT, UNDECIDED or EXPLAINED, region by region.

outcome.py the words, claims.py p-values and intervals of one look, sequential.py looks and regions under one error level,
forecast.py what deciding would cost, verdict.py the whole, allocation.py how a time budget is shared,
attribution.py which named departures explain what differs.

What is assumed: replicates are independent, and a region's mean over one replicate is near enough to normal for Student's t. Equal
noise with fireflies on both sides is covered by a test; light that one side finds so rarely that none of its replicates has
seen it is invisible to any test of the data alone.
"""
