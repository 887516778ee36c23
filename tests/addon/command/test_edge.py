# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes at the edge show the radiance that closed forms give them.

What costs seconds runs in CI.
"""

import dataclasses

import numpy as np
import pytest
from etalon.addon.command import edge
from etalon.reference_scenes.edge import CASES

QUICK = [case for case in CASES if case.samples <= 64]
LONG = [case for case in CASES if case.samples > 64]


def only(monkeypatch, *cases):
    monkeypatch.setattr(edge, "CASES", cases)
    return list(edge.edge_cases())


def test_names_are_distinct():
    assert len({case.name for case in CASES}) == len(CASES) >= 15


@pytest.mark.grid(6)
@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.name)
def test_radiance(case, monkeypatch):
    (found,) = only(monkeypatch, case)
    assert found.passed, found
    assert np.isfinite(found.cycles)


@pytest.mark.slow
@pytest.mark.parametrize("case", LONG, ids=lambda case: case.name)
def test_radiance_of_what_takes_long(case, monkeypatch):
    (found,) = only(monkeypatch, case)
    assert found.passed, found
    assert np.isfinite(found.cycles)


def test_a_wrong_expectation_is_seen(monkeypatch):
    wrong = dataclasses.replace(QUICK[0], radiance=QUICK[0].radiance * 1.001)
    assert not only(monkeypatch, wrong)[0].passed


def test_far_away_cycles_itself_is_off(monkeypatch):
    """Hard case 17: vertices in float32 at 100 km; the reference loses nothing there."""
    far = next(case for case in CASES if case.name.startswith("100 km"))
    (found,) = only(monkeypatch, far)
    assert found.worst < 1e-5
    assert found.cycles > 1e-3
