# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures shared by all tests."""

import zlib

import numpy as np
import pytest


@pytest.fixture
def seed(request: pytest.FixtureRequest) -> int:
    """A seed that derives from the test's name, so that nobody can choose a lucky one."""
    return zlib.crc32(request.node.nodeid.split("::", 1)[1].encode())


@pytest.fixture
def rng(seed: int) -> np.random.Generator:
    """A generator seeded by the test's name."""
    return np.random.default_rng(seed)
