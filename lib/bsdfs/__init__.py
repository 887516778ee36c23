# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures in the local frame: evaluate (with the cosine), pdf (per steradian of wi), sample."""
