# SPDX-License-Identifier: GPL-3.0-or-later
"""One comparison of each kind."""

import numpy as np
import pytest
from etalon.tests.lib.report.comparisons import CASES, made


@pytest.fixture(params=CASES)
def comparison(request):
    with np.errstate(invalid="ignore"):
        return made(**CASES[request.param])
