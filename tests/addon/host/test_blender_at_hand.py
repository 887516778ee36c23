# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender that is too old, or older than the file: one line and exit code 2."""

import bpy
import pytest
from etalon.addon import job
from etalon.addon.command import cli
from etalon.addon.host import blender_at_hand
from etalon.lib.errors import EtalonError


class Pretended:
    """A bpy with other versions of itself and of the file."""

    def __init__(self, app, file):
        self.app = type("App", (), {"version": app, "version_string": ".".join(map(str, app))})
        self.data = type("Data", (), {"version": file, "filepath": "/kitchen.blend"})
        self.path = bpy.path


def test_a_blender_older_than_the_oldest_supported_ends_a_command_in_one_line(monkeypatch, capsys):
    monkeypatch.setattr(blender_at_hand, "bpy", Pretended((4, 1, 0), (4, 1, 0)))
    assert cli.main(["scenes"]) == 2
    assert capsys.readouterr().err == "etalon: Blender 4.1.0 is too old; Étalon needs Blender 4.2 or newer\n"


def test_a_file_of_a_newer_blender_is_refused_and_says_which_it_needs(monkeypatch):
    monkeypatch.setattr(blender_at_hand, "bpy", Pretended((4, 5, 3), (5, 3, 0)))
    with pytest.raises(EtalonError, match=r"kitchen\.blend: was saved by Blender 5\.3, and this is 4\.5\.3"):
        job.export(bpy.context.scene)


def test_a_file_of_another_patch_release_is_accepted(monkeypatch):
    monkeypatch.setattr(blender_at_hand, "bpy", Pretended((5, 3, 0), (5, 3, 9)))
    blender_at_hand.require_readable_file()
    blender_at_hand.require_supported_blender()
