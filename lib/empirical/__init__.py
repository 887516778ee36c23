# SPDX-License-Identifier: GPL-3.0-or-later
"""The empirical models that the documents name, as lobes: what was used before microfacets, and what each of them gets wrong."""
