# SPDX-License-Identifier: GPL-3.0-or-later
"""Targets with a name: how closely and for how long a comparison looks."""

from __future__ import annotations

from typing import Any

PRESETS: dict[str, dict[str, Any]] = {
    "Quick look": {"tolerance": 0.05, "time": 30.0, "size": "auto"},
    "Review": {"tolerance": 0.02, "time": 120.0, "size": "auto"},
    "Proof": {"tolerance": 0.01, "time": 1200.0, "size": "full"},
}
"""Options of a comparison, by the name of the preset; the others stay as they are."""
