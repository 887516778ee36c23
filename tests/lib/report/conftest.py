# SPDX-License-Identifier: GPL-3.0-or-later
"""One comparison of each kind."""

import pytest
from etalon.tests.lib.report.comparisons import CASES, comparison_of

QUICK = ("different", "undecided", "passes", "partial", "non-finite", "one pixel")


@pytest.fixture(params=[pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in CASES])
def comparison(request):
    return comparison_of(request.param)
