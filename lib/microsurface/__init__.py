# SPDX-License-Identifier: GPL-3.0-or-later
"""Microfacets as they are, compared with masking formulas.

Height fields of known statistics are traced, beside what the formulas say of them.
"""
