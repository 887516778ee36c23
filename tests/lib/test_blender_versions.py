# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranges of Blender releases."""

import doctest

import pytest
from etalon.lib import blender_versions
from etalon.lib.blender_versions import Versions


def test_examples():
    assert doctest.testmod(blender_versions).failed == 0


@pytest.mark.parametrize(("first", "last", "inside", "outside"), [
    ("5.0", "5.3", [(5, 0), (5, 0, 1), (5, 3, 9)], [(4, 5), (5, 4), (6, 0)]),
    (None, "5.2", [(4, 2), (5, 2, 3)], [(5, 3)]),
    ("5.3", None, [(5, 3), (5, 10), (6, 0)], [(5, 2)]),
    (None, None, [(4, 2), (9, 9)], []),
])  # fmt: skip
def test_both_ends_belong_to_the_range(first, last, inside, outside):
    versions = Versions(first, last)
    assert all(version in versions for version in inside)
    assert not any(version in versions for version in outside)
