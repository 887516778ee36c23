# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene check: what in a scene is likely not meant, and what it does to a comparison.

check.py the list of checks; geometry.py those of faces and objects, materials.py those of colours and textures, shadows.py those of
shadows. What only Blender knows is found by the export and travels in Scene.findings.
"""
