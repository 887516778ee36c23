# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles as the renderer under test.

It has the neutral state, settings, replicates, and a second Blender.
"""
