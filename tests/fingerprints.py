# SPDX-License-Identifier: GPL-3.0-or-later
"""Record the fingerprint of the Blender at hand: python tests/fingerprints.py

It renders the probes of tests/probes with three seeds, checks that the noise is below 1e-5, says what changed since the newest older
fingerprint, and writes tests/fingerprints/<release>.json.
"""

import sys

import bpy
import numpy as np
from etalon.lib.blender_versions import format_release
from etalon.tests.probes import cycles, fingerprint
from etalon.tests.probes.definitions import LIGHTS, probes_of


def show_all(seed=0):
    """Rows of all probes of the Blender at hand, key -> (tilts, 3)."""
    rows, every = {}, probes_of(bpy.app.version)
    for light in LIGHTS:
        probes = [probe for probe in every if probe.light == light]
        if probes:
            rows |= dict(zip([probe.key for probe in probes], cycles.shown(probes, seed), strict=True))
    return {probe.key: rows[probe.key] for probe in every}


def noise(runs):
    """Relative standard deviation of each row among runs, its largest entry; key -> value."""
    found = {}
    for key in runs[0]:
        stack = np.array([run[key] for run in runs])
        scale = np.maximum(np.abs(stack[0]), max(fingerprint.FLOOR * np.abs(stack[0]).max(), 1e-12))
        found[key] = float((stack.std(axis=0, ddof=1) / scale).max())
    return found


def main():
    """Record; the exit code is 1 where the noise is too large."""
    release = bpy.app.version[:2]
    runs = [show_all(seed) for seed in range(3)]
    found = noise(runs)
    worst = max(found, key=found.get)
    print(f"noise: at most {found[worst]:.1e} (at '{worst}')")
    if found[worst] > fingerprint.NOISE:
        print(f"that is above {fingerprint.NOISE:g}: nothing was written; raise the samples in tests/probes/cycles.py")
        return 1
    fingerprint.write(release, bpy.app.version_string, runs[0])
    print(f"wrote {fingerprint.path_of(release)}")
    older = [known for known in fingerprint.releases() if known < release]
    if older:
        print(f"against Blender {format_release(older[-1])}:")
        for change in fingerprint.changes(runs[0], fingerprint.read(older[-1]), older[-1]).values():
            if abs(change.size) > fingerprint.LEAST_CHANGE:
                print(f"  {change}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
