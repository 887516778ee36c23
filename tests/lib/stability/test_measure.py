# SPDX-License-Identifier: GPL-3.0-or-later
"""The ruler: known errors come out as they were put in."""

import math

import mpmath as mp
import numpy as np
import pytest
from etalon.lib.stability.measure import Function, Single, errors, measure


def exponential(x):
    return (mp.exp(x),)


def difference(x, y):
    return (x - y,)


def points(rng, count):
    return rng.uniform(1.0, 600.0, (1, count))


def test_a_correctly_rounded_function_is_within_half_an_ulp():
    at = np.linspace(1.0, 600.0, 50)[None]
    with mp.workdps(60):
        rounded = np.array([float(mp.exp(mp.mpf(float(x)))) for x in at[0]])
    found, _ = errors(rounded, at, exponential, 53)
    assert found.max() <= 0.5


@pytest.mark.parametrize("ulps", [3.0, 1000.0, 1e6])
def test_a_planted_error_comes_out_over_one_plus_the_condition(ulps):
    """The condition number of exp is |x|."""
    at = np.array([[2.0, 50.0, 500.0]])
    value = np.exp(at[0])
    wrong = value + ulps * np.spacing(value)
    found, _ = errors(wrong, at, exponential, 53)
    np.testing.assert_allclose(found, ulps / (1.0 + at[0]), rtol=0.3)


def test_cancellation_is_the_argument_not_the_kernel():
    """x - y loses nothing but what its arguments had lost; where the result is zero too."""
    at = np.array([[1.0, 1.0, 3.0], [1.0 - 2.0**-50, 1.0, 5.0]])
    found, _ = errors(at[0] - at[1], at, difference, 53)
    assert found.max() == 0.0
    shifted, _ = errors(at[0] - at[1] + 2.0**-52, at, difference, 53)
    assert shifted.max() < 1.0


def test_leeway_is_granted_only_where_it_is_said():
    at = np.array([[1e-8], [0.5]])
    exact = at[0] - at[1]
    wrong = exact + 1e-12
    found, judged = errors(wrong, at, difference, 53, sizes=np.array([[1e4], [0.5]]))
    assert found[0] > 1e3
    assert judged[0] < 1.0
    found, judged = errors(wrong, at, difference, 53, slack=1e5)
    assert found[0] > 1e3 > 1.0 > judged[0]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_a_number_is_infinitely_wrong(bad):
    found, judged = errors(np.array([bad]), np.array([[1.0]]), exponential, 53)
    assert math.isinf(found[0])
    assert math.isinf(judged[0])


def test_single_precision_is_measured_in_its_own_ulps_at_its_own_arguments():
    function = Function(
        "f", "exp", ("x",), points, lambda a: np.exp(a[0]), exponential, 8.0, Single(lambda a: np.exp(a[0]))
    )
    case = measure(function, 40)
    assert case.passed
    assert case.worst < 1.0
    assert case.printed == math.inf, "float32 overflows at 89"
    low = Function(
        "f",
        "exp, low",
        ("x",),
        lambda rng, count: rng.uniform(1.0, 80.0, (1, count)),
        lambda a: np.exp(a[0]),
        exponential,
        8.0,
        Single(lambda a: np.exp(a[0])),
    )
    assert measure(low, 40).printed < 1.0


def test_a_broken_kernel_fails():
    function = Function("f", "exp", ("x",), points, lambda a: np.exp(a[0]) * (1.0 + 1e-9), exponential, 8.0)
    assert not measure(function, 20).passed
