# SPDX-License-Identifier: GPL-3.0-or-later
"""Microfacet theory: one file per distribution, masking, Fresnel.

All directions are in the local frame, where +z is the normal.
"""
