# SPDX-License-Identifier: GPL-3.0-or-later
"""Microfacets as they are: height fields of known statistics, traced, beside what masking formulas say of them."""
