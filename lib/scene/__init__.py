# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as frozen, checked arrays: what the exporter writes and all the rest reads.

mesh.py triangles, camera.py, lights.py, world.py, materials.py closures, expressions.py the values
that feed their sockets, sky.py skies, images.py, scene.py the whole, checks.py validation, archive.py save and replay as .npz.
"""
