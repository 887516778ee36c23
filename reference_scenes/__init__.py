# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes with a known answer; one file each builds its scene with bpy and states the expectation and its origin."""
