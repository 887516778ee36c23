# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference with the departures of a release shows what the Cycles of that release showed. No Blender takes part.

Whether the reference itself is right is for the tests of lib/ to say; this says that the departures are all there is to say of Cycles.
"""

import numpy as np
import pytest
from etalon.tests.probes import fingerprint, reference
from etalon.tests.probes.definitions import FACTS, LIGHTS, PROBES

# The reference has no noise under a sun. Its furnace has some, and Cycles' sums in single precision drift.
EXACT = {**dict.fromkeys(LIGHTS, 3e-5), "furnace": 2e-4}
FURNACE_SAMPLES = 1 << 14


@pytest.fixture(scope="module", params=fingerprint.releases(), ids=lambda release: f"{release[0]}.{release[1]}")
def apart(request):
    """Probe's key -> largest relative difference, with the departures of a release."""
    recorded, found = fingerprint.read(request.param), {}
    for light in LIGHTS:
        probes = [probe for probe in PROBES if probe.light == light]
        samples = FURNACE_SAMPLES if light == "furnace" else 1
        rows = reference.shown(light, [reference.material(p) for p in probes], request.param, samples)
        for probe, row in zip(probes, rows, strict=True):
            found[probe.key] = np.abs(fingerprint.apart(row, recorded[probe.key])).max()
    return found


@pytest.mark.parametrize("fact", FACTS)
def test_reference_with_the_departures_of_a_release_shows_its_fingerprint(apart, fact):
    for probe in PROBES:
        if probe.fact == fact:
            assert apart[probe.key] < EXACT[probe.light], probe.key
