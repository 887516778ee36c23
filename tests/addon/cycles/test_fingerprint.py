# SPDX-License-Identifier: GPL-3.0-or-later
"""The Cycles at hand against the fingerprint of its release.

A failure is news of Cycles, not a fault of the reference.
"""

import bpy
import pytest
from etalon.tests.fingerprints import show_all
from etalon.tests.probes import fingerprint
from etalon.tests.probes.definitions import facts_of

RELEASE = bpy.app.version[:2]


@pytest.fixture(scope="module")
def changes():
    """Fact -> its largest change."""
    if fingerprint.missing(RELEASE):
        pytest.skip(fingerprint.missing(RELEASE))
    return fingerprint.changes(show_all(), fingerprint.read(RELEASE), RELEASE)


@pytest.mark.parametrize("fact", facts_of(RELEASE))
def test_cycles_shows_its_fingerprint(changes, fact):
    if abs(changes[fact].size) > fingerprint.LEAST_CHANGE:
        pytest.fail(str(changes[fact]))
