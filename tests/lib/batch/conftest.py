# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests of batches."""

import json
import sys

import pytest
from etalon.lib.batch import asked
from etalon.lib.batch import run as batch
from etalon.lib.report.document import FORMAT, VERSION
from etalon.tests.lib.batch.stand_in import STAND_IN


@pytest.fixture
def folder(tmp_path, monkeypatch, verdict_json):
    """A folder with a plan's surroundings, in which `etalon` is the stand-in."""
    (tmp_path / "stand_in.py").write_text(STAND_IN)
    (tmp_path / "verdict.json").write_text(verdict_json)
    monkeypatch.chdir(tmp_path)
    for module in (batch, asked):
        monkeypatch.setattr(module, "etalon_command", lambda: [sys.executable, str(tmp_path / "stand_in.py")])
    return tmp_path


@pytest.fixture
def verdict_json():
    """What a comparison leaves behind, as far as the tables read it."""
    return json.dumps(
        {
            "format": FORMAT,
            "version": VERSION,
            "image": {"difference": 0.0012, "interval": [-0.001, 0.003]},
            "bound": {"value": 0.0042},
            "regions": [{"outcome": "EQUIVALENT"}] * 3 + [{"outcome": "DIFFERENT"}],
            "tolerance": 0.01,
            "confidence": 0.99,
            "versions": {"etalon": "0.1.0"},
            "blender": {"version": "5.3.0"},
        }
    )
