# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates expressions (lib.scene.expressions) at shading points.

There is one file per family of nodes.

evaluate.py walks a tree; math_node.py, mix.py, ramp.py, mapping.py, checker.py, angles.py are the nodes; images.py
samples images, sky.py skies; color_spaces.py; fold.py turns what is constant into constants; requirements.py says
which coordinates a scene needs.

A value comes as shape () where it is the same everywhere, else (n,); a colour or vector as (3, 1) or (3, n).
"""
