# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures shared by all tests."""

import gc
import os
import zlib
from collections import defaultdict
from collections.abc import Iterator

# Workers share the cores: threads of BLAS would wait for each other. The plan of a sphere of 20,480 faces took 10 s of CPU time, not 0.8.
# NumPy reads it when it is first imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# As the command line sets up its process (lib/wavefront/tuning.py), for the workers that start after this: glibc keeps what is freed.
# Tables by quadrature spend half of their time on page faults otherwise.
os.environ.setdefault("MALLOC_TRIM_THRESHOLD_", str(192 << 20))
os.environ.setdefault("MALLOC_MMAP_THRESHOLD_", str(8 << 20))

# Dask's profiler asks for the frames of all threads. In Python 3.11 before 3.11.9 that can wait for ever
# (https://github.com/python/cpython/issues/106883): here, and in the workers that tests start.
os.environ.setdefault("DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED", "False")

import numpy as np
import pytest
from etalon.lib.blender_versions import NEWEST_CHECKED
from etalon.tests.probes import fingerprint


@pytest.fixture
def seed(request: pytest.FixtureRequest) -> int:
    """A seed that derives from the test's name, so that nobody can choose a lucky one."""
    return zlib.crc32(request.node.nodeid.split("::", 1)[1].encode())


@pytest.fixture
def rng(seed: int) -> np.random.Generator:
    """A generator seeded by the test's name."""
    return np.random.default_rng(seed)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Collect without the garbage collector, which would look at thousands of tests again and again.

    It does not look at them, and at the modules that were imported, during the tests either: they stay to the end.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()


def pytest_unconfigure() -> None:
    """Let the process free everything at its end: nanobind reports what is left of OpenImageIO otherwise."""
    gc.unfreeze()


@pytest.hookimpl(tryfirst=True)  # before pytest chooses by marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Make slow tests of all cases of a grid but those that the default run takes.

    These are drawn by their names: one in so many as the mark `grid` says, and at least one.
    """
    cases = defaultdict(list)
    for item in items:
        mark = item.get_closest_marker("grid")
        if mark:
            cases[item.nodeid.split("[")[0], mark.args[0]].append(item)
    for (_, one_in), grid in cases.items():
        grid.sort(key=lambda item: zlib.crc32(item.nodeid.encode()))
        for item in grid[-(-len(grid) // one_in) :]:
            item.add_marker(pytest.mark.slow)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a comparison with Cycles in a Blender newer than every one that was checked.

    Comparisons are marked so.
    """
    if item.get_closest_marker("compares_with_cycles"):
        reason = unknown_cycles()
        if reason:
            pytest.skip(reason)


def unknown_cycles() -> str:
    """Why it is unknown what the Cycles at hand shows, '' where it is known.

    The marker and the fixture `studio` ask for it.
    """
    import bpy

    release = bpy.app.version[:2]
    return fingerprint.missing(release) if release > NEWEST_CHECKED else ""
