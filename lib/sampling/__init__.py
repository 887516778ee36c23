# SPDX-License-Identifier: GPL-3.0-or-later
"""Low-discrepancy points, warps of the unit square, tables, and the heuristics that combine strategies."""
