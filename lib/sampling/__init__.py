# SPDX-License-Identifier: GPL-3.0-or-later
"""Low-discrepancy points, warps of the unit square, tables, and MIS heuristics.

The heuristics combine strategies.
"""
