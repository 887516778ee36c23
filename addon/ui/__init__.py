# SPDX-License-Identifier: GPL-3.0-or-later
"""Étalon in Blender's window: settings kept with the scene, operators, panels."""
