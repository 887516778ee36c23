# SPDX-License-Identifier: GPL-3.0-or-later
"""Metropolis light transport in the space of the random numbers (Kelemen et al. 2002)."""
