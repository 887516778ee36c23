# SPDX-License-Identifier: GPL-3.0-or-later
"""Every equation of the reference against 50 digits over its whole domain.

A fixed number of places by default, many in CI.
"""

from dataclasses import replace

import pytest
from etalon.lib.stability.closed_forms import closed_forms
from etalon.lib.stability.identities import identities
from etalon.lib.stability.inversions import inversions
from etalon.lib.stability.lights import lights_and_factors
from etalon.lib.stability.lobes import lobes
from etalon.lib.stability.measure import measure
from etalon.lib.stability.volumes import volumes

FUNCTIONS = {
    function.name: function
    for function in (*closed_forms(), *lobes(), *lights_and_factors(), *volumes(), *inversions())
}
EVERY = pytest.mark.parametrize("name", FUNCTIONS)
# Where float32 as Cycles writes it has at most one digit left at some place of the domain (1.7e7 ulp are an error of 100 %).
CYCLES_LOSES_ALL = (
    "Beckmann D",
    "GGX lobe",
    "Beckmann lobe",
    "Fresnel, dielectric",
    "GGX visible normals",
    "power heuristic",
)


# Of the other functions more places are tried below.
@pytest.mark.parametrize("name", list(FUNCTIONS)[::6])
def test_last_digits(name):
    case = measure(FUNCTIONS[name], 30)
    assert case.passed, case


@EVERY
@pytest.mark.slow
def test_last_digits_at_many_places(name):
    # Of the float32 forms, which take as long, nothing is claimed here.
    case = measure(replace(FUNCTIONS[name], printed=None, cycles=None), 300)
    assert case.passed, case


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if "lobe" in name else ()) for name in CYCLES_LOSES_ALL]
)
def test_float32_as_cycles_writes_it_loses_its_digits_somewhere(name):
    """Hard cases 1, 3, 5, 8, 10.

    The reference's arrangement of the same equations serves for them.
    """
    assert measure(FUNCTIONS[name], 150).cycles > 1e6


def test_bounds_are_those_of_the_atlas():
    assert {f.bound for f in closed_forms()} == {8.0}
    assert {f.bound for f in inversions()} == {32.0}
    assert {f.bound for f in lobes()} == {8.0, 32.0}
    assert {f.bound for f in (*lights_and_factors(), *volumes())} == {8.0}
    excused = [name for name, f in FUNCTIONS.items() if f.excuse]
    assert set(excused) == {
        "Fresnel, F82",
        "mean of F82",
        "GGX visible normals",
        "GGX bounded visible normals",
        "Beckmann visible normals",
        "place on a rectangle light",
    }


@pytest.mark.slow
def test_identities():
    broken = [case for case in identities() if not case.passed]
    assert not broken
