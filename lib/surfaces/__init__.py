# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces at the points that rays hit, and the lobes built from materials there."""
