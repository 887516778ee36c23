# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured materials: readers of MERL and RGL files.

The files give the BRDF for pairs of directions.
"""
