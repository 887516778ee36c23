# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as the reference sees it.

Commands that read it need Blender only where it is not saved as .npz.
"""

from __future__ import annotations

from pathlib import Path

from ...lib.scene import archive
from ...lib.scene.scene import Scene
from ...lib.settings.common import Target
from ..host.blender import load_blender
from ..host.quiet import quiet
from .console import ended_by_interrupt


def read_scene(target: Target) -> Scene:
    """Read the scene that `target` names, from a saved .npz or through Blender.

    Raises EtalonError or Refused.
    """
    if target.scene is not None and target.is_archive:
        return archive.load(Path(target.scene))
    with ended_by_interrupt():
        load_blender()
        import bpy

        from .. import job
        from .opening import open_asked
    open_asked(target)
    with quiet():
        return job.export(bpy.context.scene)
