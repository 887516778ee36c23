# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification: which model, with which parameters, explains a measured BRDF or a picture of a sphere."""
