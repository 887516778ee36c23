# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles as the renderer under test: neutral state, settings, replicates, a second Blender."""
