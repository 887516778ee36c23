# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that come with Blender.

Each ends in a scene, or in a message that names what is missing; nothing else happens.
"""

from pathlib import Path

import bpy
import pytest
from etalon.addon.command.opening import open_target
from etalon.addon.host.quiet import quiet
from etalon.addon.job import export
from etalon.lib.errors import EtalonError

ROOT = Path(bpy.utils.resource_path("LOCAL"))
FILES = sorted(ROOT.rglob("*.blend"))


def test_there_are_files():
    assert len(FILES) >= 10


def told(function, *arguments):
    """What the function's EtalonError says; '' where it has none to raise."""
    try:
        with quiet():
            function(*arguments)
    except EtalonError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_file_of_blenders(path):
    """The file as it is, then with a camera, then with something to see, where it lacks them.

    What is not simulated is named.
    """
    said = told(open_target, str(path))
    assert not said or "the scene has no camera" in said
    scene = bpy.context.scene
    if scene.camera is None:
        scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.collection.objects.link(scene.camera)
    said = told(export, scene)
    if "no faces to render" in said:
        mesh = bpy.data.meshes.new("sheet")
        mesh.from_pydata([(0, 0, -2), (1, 0, -2), (0, 1, -2)], [], [(0, 1, 2)])
        scene.collection.objects.link(bpy.data.objects.new("sheet", mesh))
        said = told(export, scene)
    assert not said or "is not simulated" in said
