# SPDX-License-Identifier: GPL-3.0-or-later
"""Both sides of a comparison on two workers: the verdict is that of one machine."""

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Event

import numpy as np
import pytest
from etalon.lib.cluster.client import connect
from etalon.lib.cluster.replicates import Request, ask_reference, render_replicate
from etalon.lib.cluster.sides import SpreadSide
from etalon.lib.comparison.compare import compare
from etalon.lib.errors import Cancelled, EtalonError
from etalon.lib.film.rendering import Rendering
from etalon.lib.film.windows import Windows
from etalon.lib.progress import Progress
from etalon.lib.sampling.streams import COUNTED, FIRST_CALLS
from etalon.lib.settings.comparison import CompareOptions
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import cube, diffuse, floor, orthographic, scene

CAMERA = orthographic(12, 8, 1.0, (0.0, 0.0, 2.0))
SCENE = scene((floor(), cube(0.2, (0.0, 0.0, 0.4))), diffuse(0.5, 0.6, 0.7), CAMERA, world=1.0, bounces=2)


@contextmanager
def cluster_of_two(processes):
    distributed = pytest.importorskip("distributed", reason="Dask is not installed; `pip install etalon[cluster]`")
    made = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0", "host": "127.0.0.1"}
    with (
        distributed.LocalCluster(processes=processes, protocol="tcp://", **made) as own,
        connect(own.scheduler_address) as cluster,
    ):
        yield cluster


def renderers(seed):
    return tuple(ReferenceRenderer(SCENE, Options(seed=one, threads=1)) for one in (seed, seed + 1))


def assert_same(found, expected):
    for one, other in ((found.reference, expected.reference), (found.candidate, expected.candidate)):
        assert one.film.moments.n == other.film.moments.n
        assert np.array_equal(one.film.moments.mean, other.film.moments.mean)
        assert np.array_equal(one.film.moments.m2, other.film.moments.m2)
        assert np.array_equal(one.regions.moments.mean, other.regions.moments.mean)
    assert [bound.bound for bound in found.history] == [bound.bound for bound in expected.history]
    assert found.verdict.outcome is expected.verdict.outcome
    assert found.stopped is expected.stopped


def compare_spread(cluster, sides, options, progress):
    with ThreadPoolExecutor() as pool:
        asks = [ask_reference(cluster, side.scene, side.options, side.passes) for side in sides]
        spread = [SpreadSide(side, ask, pool, 3) for side, ask in zip(sides, asks, strict=True)]
        try:
            return compare(SCENE, *spread, {}, options, progress)
        finally:
            for side in spread:
                side.close()


def test_a_comparison_on_two_workers_is_that_of_one_machine_bit_for_bit(seed):
    sides, options = renderers(seed), CompareOptions(samples=2, replicates=6, time=None, seed=seed)
    with cluster_of_two(processes=False) as cluster:
        found = compare_spread(cluster, sides, options, Progress())
    expected = compare(SCENE, *sides, {}, options)
    assert expected.reference.film.moments.m2.any()
    assert_same(found, expected)


@pytest.mark.slow
def test_a_comparison_survives_a_worker_that_is_killed_amid_a_round(seed):
    sides, options = renderers(seed), CompareOptions(samples=64, replicates=8, time=None, seed=seed)
    with cluster_of_two(processes=True) as cluster:
        killed = []

        def kill(share):
            if share > 0.2 and not killed:
                killed.append(next(iter(cluster._client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        found = compare_spread(cluster, sides, options, Progress(kill))
    assert killed
    assert_same(found, compare(SCENE, *sides, {}, options))


def test_a_worker_with_another_version_is_refused_in_one_line():
    with (
        cluster_of_two(processes=False) as cluster,
        pytest.raises(EtalonError, match=r"^worker tcp://.* install Étalon 0\.0 there, as here$"),
    ):
        cluster.call(render_replicate, ("0.0", "", Options(), (), Request(0, 1)), {}, bool)


class Recorder:
    """Stands in for workers: it notes what is asked of it, and renders nothing."""

    name, settings = "recorder", {}

    def __init__(self):
        self.asked = []

    def ask(self, request, is_ending):
        self.asked.append(request)
        return Rendering(np.zeros((1, 1, 3)), np.zeros((1, 1), int), 0.0)


def test_what_will_be_asked_for_next_is_begun_once():
    recorder, windows = Recorder(), Windows((1, 1), ((0, 0, 0, 0),))
    with ThreadPoolExecutor(1) as pool:
        side = SpreadSide(recorder, recorder.ask, pool, 3)
        side.render(FIRST_CALLS.number(0), 4)
        for number in (0, 1):
            side.render(number, 8)
        side.render(2, 16, windows=windows)
        side.render(COUNTED.count - 1, 8)
    whole = [Request(number, 8) for number in (0, 1, 2, 3)]
    part = [Request(number, 16, windows) for number in (2, 4, 6)]
    assert recorder.asked == [Request(FIRST_CALLS.number(0), 4), *whole, *part, Request(COUNTED.count - 1, 8)]


def test_nothing_is_begun_that_the_number_of_replicates_rules_out():
    recorder = Recorder()
    with ThreadPoolExecutor(1) as pool:
        side = SpreadSide(recorder, recorder.ask, pool, 3, count=4)
        for number in range(5):
            side.render(number, 8)
    assert [one.replicate for one in recorder.asked] == [0, 1, 2, 3, 4]


def test_a_call_ends_when_the_user_cancels_and_its_worker_is_told():
    told = Event()

    def ask(request, is_ending):
        while not is_ending():
            told.wait(0.01)
        told.set()
        raise Cancelled("cancelled")

    with ThreadPoolExecutor(1) as pool:
        side = SpreadSide(Recorder(), ask, pool, 1)
        with pytest.raises(Cancelled):
            side.render(0, 1, Progress(is_cancelled=lambda: True))
    assert told.is_set()
