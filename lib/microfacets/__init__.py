# SPDX-License-Identifier: GPL-3.0-or-later
"""Microfacet theory: one file per distribution, masking, Fresnel; all directions in the local frame, +z the normal."""
