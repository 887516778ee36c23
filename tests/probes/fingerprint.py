# SPDX-License-Identifier: GPL-3.0-or-later
"""Fingerprints: what the Cycles of one release shows of all probes.

They lie in tests/fingerprints/<release>.json. Also what changed against one.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from etalon.lib.blender_versions import format_release, parse_release
from etalon.tests.probes.definitions import facts_of, probes_of, tilts

FOLDER = Path(__file__).parents[1] / "fingerprints"
NOISE = 1e-5
"""The most by which other seeds may change a row, relative; a recording that exceeds it is refused."""
LEAST_CHANGE = 3e-5
"""Relative differences from here on are reported as a change of Cycles: three times the noise."""
FLOOR = 1e-3
"""Values below this share of their row's largest are compared as if they were as large."""


@dataclass(frozen=True)
class Change:
    """The largest relative difference among the rows of a fact.

    It has its size (with sign), the probe's key and the tilt.
    """

    fact: str
    size: float
    key: str
    tilt: float

    def __str__(self) -> str:
        """The sentence of a failed test."""
        return f"Cycles changed: {self.fact}, {100.0 * self.size:+.2g} % (largest, at '{self.key}', tilt {self.tilt:g})"


def path_of(release):
    """Where the fingerprint of a release is kept."""
    return FOLDER / f"{format_release(release)}.json"


def releases():
    """The releases that have a fingerprint, oldest first."""
    return sorted(parse_release(path.stem) for path in FOLDER.glob("*.json"))


def missing(release):
    """Why tests that need the fingerprint of `release` cannot run, or '' where there is one."""
    if path_of(release).exists():
        return ""
    return (
        f"Blender {format_release(release)} has no fingerprint, so nobody has looked at what changed in its Cycles; "
        "`python tests/fingerprints.py` records one"
    )


def write(release, version, rows):
    """Keep `rows`, key -> (tilts, 3), as shown by Blender `version`."""
    lines = [f"    {json.dumps(key)}: {json.dumps(_rounded(row))}" for key, row in rows.items()]
    text = f'{{\n  "blender": {json.dumps(version)},\n  "rows": {{\n' + ",\n".join(lines) + "\n  }\n}\n"
    path_of(release).write_text(text, encoding="utf-8")


def read(release):
    """The rows of a release, key -> (tilts, 3)."""
    rows = json.loads(path_of(release).read_text(encoding="utf-8"))["rows"]
    return {key: np.array(row) for key, row in rows.items()}


def apart(shown, recorded):
    """Relative differences of two rows, (tilts, 3), small values against the row's largest."""
    return (shown - recorded) / np.maximum(np.abs(recorded), max(FLOOR * np.abs(recorded).max(), 1e-12))


def changes(shown, recorded, release):
    """The largest change of each fact between two sets of rows, fact -> Change.

    Those of the probes of `release`, the older of the two; a row that either lacks is an error.
    """
    largest = {}
    for probe in probes_of(release):
        for row in (shown, recorded):
            if probe.key not in row:
                raise KeyError(f"no row '{probe.key}': `python tests/fingerprints.py` records it")
        difference = apart(shown[probe.key], recorded[probe.key])
        tilt, channel = np.unravel_index(np.abs(difference).argmax(), difference.shape)
        size = float(difference[tilt, channel])
        if probe.fact not in largest or abs(size) > abs(largest[probe.fact].size):
            largest[probe.fact] = Change(probe.fact, size, probe.key, tilts(probe.light)[tilt])
    return {fact: largest[fact] for fact in facts_of(release)}


def _rounded(row):
    return [[float(f"{value:.7g}") for value in color] for color in row.tolist()]
