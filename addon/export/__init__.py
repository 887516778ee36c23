# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's evaluated depsgraph to lib.scene: one file per kind of data, materials node by node."""
