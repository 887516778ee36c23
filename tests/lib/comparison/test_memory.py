# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory of a comparison, said in advance."""

import pytest
from etalon.lib.comparison import memory
from etalon.lib.errors import EtalonError


def test_more_pixels_than_memory_are_refused_with_the_need_and_the_remedy(monkeypatch):
    monkeypatch.setattr(memory, "usable_memory", lambda: 16 * 10**9)
    memory.require_memory(1920, 1080)
    with pytest.raises(EtalonError) as caught:
        memory.require_memory(16384, 16384)
    assert str(caught.value) == (
        "16384 x 16384 pixels: about 99.3 GB to compare at full size; this machine has 16.0 GB; "
        "lower the resolution, or give a time and let a smaller image be compared"
    )


def test_light_passes_need_memory_of_their_own(monkeypatch):
    """Eight passes of a picture that needs 4 of 5 GB without them."""
    monkeypatch.setattr(memory, "usable_memory", lambda: 5 * 10**9)
    memory.require_memory(3840, 2160)
    with pytest.raises(EtalonError, match="about 12\\.6 GB"):
        memory.require_memory(3840, 2160, 8)


def test_where_the_memory_is_not_known_nothing_is_refused(monkeypatch):
    monkeypatch.setattr(memory, "usable_memory", lambda: None)
    memory.require_memory(16384, 16384)
