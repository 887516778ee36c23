# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates expressions (lib.scene.expressions) at shading points, one file per family of nodes."""
