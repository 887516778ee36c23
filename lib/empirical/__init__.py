# SPDX-License-Identifier: GPL-3.0-or-later
"""Empirical BRDF models from before microfacets, as lobes, and what each gets wrong.

They are the models that the documents name.
"""
