# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's evaluated scene to lib.scene.

scene.py the whole, mesh.py one mesh, placements.py its instances in the world, camera.py, lights.py, refusals.py objects
and settings that are not simulated; materials.py with nodes*.py closures and the world, images.py textures, sky.py skies.
"""

from .nodes.sky import render_skies
from .scene import export_scene

__all__ = ["export_scene", "render_skies"]
