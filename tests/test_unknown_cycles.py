# SPDX-License-Identifier: GPL-3.0-or-later
"""In an unchecked Blender, comparisons with Cycles skip.

They say which command checks it.
"""

import bpy
import pytest
from etalon.lib.blender_versions import NEWEST_CHECKED
from etalon.tests import conftest


def test_the_blender_at_hand_is_known_or_newer_than_the_newest_checked():
    assert bool(conftest.unknown_cycles()) == (bpy.app.version[:2] > NEWEST_CHECKED)


@pytest.mark.compares_with_cycles
def test_the_sentence_names_the_release_and_the_command(monkeypatch):
    monkeypatch.setattr(conftest, "NEWEST_CHECKED", (4, 0))
    monkeypatch.setattr(conftest.fingerprint, "FOLDER", conftest.fingerprint.FOLDER / "nowhere")
    assert "has no fingerprint" in conftest.unknown_cycles()
    assert "`python tests/fingerprints.py`" in conftest.unknown_cycles()
