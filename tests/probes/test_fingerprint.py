# SPDX-License-Identifier: GPL-3.0-or-later
"""Fingerprints: their files, and what a change is called."""

import re

import numpy as np
import pytest
from etalon.lib.blender_versions import NEWEST_CHECKED
from etalon.tests.probes import fingerprint
from etalon.tests.probes.definitions import PROBES, probes_of, tilts

RELEASES = fingerprint.releases()


def test_the_newest_checked_release_has_a_fingerprint():
    assert NEWEST_CHECKED in RELEASES


@pytest.mark.parametrize("release", RELEASES)
def test_a_fingerprint_has_every_probe_and_is_small(release):
    rows = fingerprint.read(release)
    assert {key: row.shape for key, row in rows.items()} == {
        p.key: (len(tilts(p.light)), 3) for p in probes_of(release)
    }
    assert all(row.any() for row in rows.values())
    assert fingerprint.path_of(release).stat().st_size < 100_000


def test_keys_are_unique():
    assert len({probe.key for probe in PROBES}) == len(PROBES)


def test_a_change_is_reported_by_its_fact_size_and_place():
    recorded = fingerprint.read(NEWEST_CHECKED)
    shown = {key: row.copy() for key, row in recorded.items()}
    shown["Principled coat 0.4, front"][2] *= 1.057
    found = fingerprint.changes(shown, recorded, NEWEST_CHECKED)
    assert str(found["coat albedo"]) == (
        "Cycles changed: coat albedo, +5.7 % (largest, at 'Principled coat 0.4, front', tilt -0.5)"
    )
    assert {fact for fact, change in found.items() if abs(change.size) > fingerprint.LEAST_CHANGE} == {"coat albedo"}


def test_a_missing_row_is_named():
    recorded = fingerprint.read(NEWEST_CHECKED)
    shown = dict(recorded)
    del shown["Diffuse, front"]
    with pytest.raises(KeyError, match=re.escape("no row 'Diffuse, front'")):
        fingerprint.changes(shown, recorded, NEWEST_CHECKED)


def test_a_release_without_a_fingerprint_says_how_to_record_one():
    assert not fingerprint.missing(NEWEST_CHECKED)
    assert "Blender 99.1 has no fingerprint" in fingerprint.missing((99, 1))
    assert "`python tests/fingerprints.py`" in fingerprint.missing((99, 1))


def test_a_fingerprint_is_read_back_to_seven_digits(tmp_path, monkeypatch, rng):
    monkeypatch.setattr(fingerprint, "FOLDER", tmp_path)
    rows = {"one": rng.random((7, 3)), "two": 1e-9 * rng.random((7, 3))}
    fingerprint.write((5, 9), "5.9.1", rows)
    assert fingerprint.releases() == [(5, 9)]
    for key, row in fingerprint.read((5, 9)).items():
        np.testing.assert_allclose(row, rows[key], rtol=5.1e-7)
