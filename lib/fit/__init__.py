# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of a model, with its parameters.

The model explains a measured BRDF or a picture of a sphere.
"""
