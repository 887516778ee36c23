# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparisons with a scheduler and two workers on loopback, from the command line and from scripts."""

import json
import os
import signal
from dataclasses import replace

import bpy
import etalon
import numpy as np
import pytest
from etalon.addon.command.cli import main
from etalon.addon.cycles import spread
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.cycles.second_blender import AnotherBlender
from etalon.addon.cycles.spread import Order, end_order, render_cycles
from etalon.lib.cluster.client import connect
from etalon.lib.cluster.replicates import Request
from etalon.lib.cluster.sides import SpreadSide
from etalon.lib.cluster.worker import digest_of
from etalon.lib.errors import Cancelled, EtalonError, Refused
from etalon.lib.settings.common import Target
from etalon.lib.settings.comparison import Settings
from etalon.lib.version import VERSION
from etalon.reference_scenes import build

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def address():
    distributed = pytest.importorskip("distributed", reason="Dask is not installed; `pip install etalon[cluster]`")
    made = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0", "host": "127.0.0.1"}
    with distributed.LocalCluster(processes=True, protocol="tcp://", **made) as cluster:
        yield cluster.scheduler_address


def read(folder):
    told = json.loads((folder / "verdict.json").read_text(encoding="utf-8"))
    for look in told["bound"]["history"]:
        del look["seconds"]
    return {key: told[key] for key in ("verdict", "image", "bound", "regions")}


def compare(folder, *more):
    words = ["lambert_analytic", "--set=scene.render.resolution_percentage=15", "--samples=4", "--replicates=6"]
    return main(["compare", *words, "--threads=1", "--passes=none", "--quiet", f"--out={folder}", *more])


def test_the_verdict_is_that_of_one_machine_bit_for_bit_though_a_worker_is_killed(address, tmp_path, monkeypatch):
    code = compare(tmp_path / "here")
    render, killed = SpreadSide.render, []
    with connect(address) as cluster:

        def render_and_kill(self, replicate, *rest):
            rendering = render(self, replicate, *rest)
            if self.name == "Cycles" and replicate == 2 and not killed:
                killed.append(next(iter(cluster._client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)
            return rendering

        monkeypatch.setattr(SpreadSide, "render", render_and_kill)
        assert compare(tmp_path / "spread", f"--scheduler={address}") == code
    assert killed
    assert read(tmp_path / "spread") == read(tmp_path / "here")


def test_a_file_reaches_workers_by_path_or_by_content(address, tmp_path, monkeypatch):
    path = tmp_path / "scene.blend"
    build("lambert_analytic")
    bpy.context.scene.render.resolution_percentage = 5
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    files, target = {str(path): digest_of(path.read_bytes())}, Target(str(path))
    cycles = CyclesRenderer(bpy.context.scene, threads=1)
    expected = cycles.render(1, 2).radiance
    moved = {str(tmp_path / "elsewhere.blend"): digest_of(path.read_bytes())}
    build_of = str(cycles.settings["version"]), str(cycles.settings["build"])
    with connect(address) as cluster:
        for key, where in (("by path", files), ("by content", moved)):
            order = Order(key, VERSION, build_of, replace(target, scene=next(iter(where))), Settings(threads=1), where)
            contents = {digest: path for digest in where.values()}
            found = cluster.call(render_cycles, (order, None, (), Request(1, 2)), contents, bool)
            assert np.array_equal(found.radiance, expected)
            cluster.run_everywhere(end_order, key)


def test_a_worker_with_another_blender_is_refused_in_one_line(address):
    order = Order("key", VERSION, ("4.5.0", "abc"), Target("lambert_analytic"), Settings(threads=1), {})
    with (
        connect(address) as cluster,
        pytest.raises(EtalonError, match=r"^worker tcp.* has Blender .*; install Blender 4.5.0 abc there"),
    ):
        cluster.call(render_cycles, (order, None, (), Request(0, 1)), {}, bool)


SMALL = "scene.render.resolution_percentage=10"


@pytest.fixture
def rendered(monkeypatch):
    """The replicates that workers rendered, by side."""
    found, render = [], SpreadSide.render

    def note(self, replicate, *rest):
        found.append((self.name, replicate))
        return render(self, replicate, *rest)

    monkeypatch.setattr(SpreadSide, "render", note)
    return found


def assert_same(found, expected):
    assert found.verdict.outcome is expected.verdict.outcome
    for one, other in ((found.reference, expected.reference), (found.candidate, expected.candidate)):
        assert one.film.moments.n == other.film.moments.n
        assert np.array_equal(one.film.moments.mean, other.film.moments.mean)
        assert np.array_equal(one.film.moments.m2, other.film.moments.m2)


def test_a_script_compares_on_workers_what_it_compares_here(address, rendered, tmp_path):
    """The open file has changed since it was saved: workers render it as it is."""
    build("lambert_analytic")
    bpy.context.scene.render.resolution_percentage = 10
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    for light in bpy.data.lights:
        light.energy *= 3.0
    for material in bpy.data.materials:
        for node in material.node_tree.nodes:
            if "Color" in node.inputs:
                node.inputs["Color"].default_value = (0.3, 0.2, 0.1, 1.0)
    settings = etalon.Settings(samples=4, replicates=3, threads=1, passes="none")
    expected = etalon.compare(None, settings)
    assert rendered == []
    found = etalon.compare(None, replace(settings, scheduler=address))
    assert len(rendered) == 6
    assert_same(found, expected)


def test_a_script_renders_on_workers_what_it_renders_here(address):
    target, options = etalon.Target("lambert_analytic", assignments=(SMALL,)), etalon.RenderOptions(replicates=3)
    options = replace(options, samples=2, threads=1)
    expected = etalon.render(target, options)
    found = etalon.render(target, replace(options, scheduler=address))
    assert expected.moments.m2.any()
    assert np.array_equal(found.moments.mean, expected.moments.mean)
    assert np.array_equal(found.moments.m2, expected.moments.m2)


def test_a_script_runs_a_batch_on_workers(address, rendered, tmp_path):
    options = f'samples = 4\nreplicates = 2\nthreads = 1\npasses = "none"\nset = ["{SMALL}"]\nseed = [1, 2]\n'
    (tmp_path / "plan.toml").write_text(f'scenes = ["lambert_analytic"]\n[options]\n{options}')
    expected = list(etalon.batch(tmp_path / "plan.toml"))
    found = list(etalon.batch(tmp_path / "plan.toml", scheduler=address))
    assert len(rendered) == 8
    assert [one.label for one in found] == ["lambert_analytic seed=1", "lambert_analytic seed=2"]
    for one, other in zip(found, expected, strict=True):
        assert_same(one.comparison, other.comparison)
    assert {path.name for path in tmp_path.iterdir()} == {"plan.toml"}


def test_what_is_refused_here_is_refused_on_workers(address):
    target, told = etalon.Target("lambert_analytic", assignments=(SMALL, "scene.render.use_multiview=true")), []
    for scheduler in ("local", address):
        with pytest.raises(Refused) as refused:
            etalon.compare(target, etalon.Settings(scheduler=scheduler, time=5))
        told.append((refused.value.refusals, str(refused.value)))
    assert told[0] == told[1]


@pytest.fixture
def one_worker():
    """A scheduler with a worker in this process, and the order of a small scene, with its replicate by Cycles."""
    distributed = pytest.importorskip("distributed", reason="Dask is not installed; `pip install etalon[cluster]`")
    build("lambert_analytic")
    bpy.context.scene.render.resolution_percentage = 5
    cycles = CyclesRenderer(bpy.context.scene, threads=1)
    build_of = str(cycles.settings["version"]), str(cycles.settings["build"])
    target = Target("lambert_analytic", assignments=("scene.render.resolution_percentage=5",))
    made = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0", "host": "127.0.0.1"}
    with (
        distributed.LocalCluster(processes=False, protocol="tcp://", **made) as own,
        connect(own.scheduler_address) as cluster,
    ):

        def ask(key):
            order = Order(key, VERSION, build_of, target, Settings(threads=1), {})
            try:
                return cluster.call(render_cycles, (order, None, (), Request(1, 2)), {}, bool).radiance
            finally:
                end_order(key)

        yield ask, cycles.render(1, 2).radiance


def test_a_process_that_dies_amid_a_render_is_replaced_once(one_worker, monkeypatch):
    ask, expected = one_worker
    send, died = AnotherBlender._send, []

    def send_and_kill(self, wanted):
        send(self, wanted)
        if len(died) < most:
            died.append(self._process.pid)
            self._process.kill()

    monkeypatch.setattr(AnotherBlender, "_send", send_and_kill)
    most = 1
    assert np.array_equal(ask("one death"), expected)
    most = 3
    with pytest.raises(EtalonError, match=r"^Blender of worker tcp://.* ended early \(signal 9"):
        ask("two deaths")
    assert len(died) == 3
    assert not spread._running


def test_the_last_words_of_a_process_that_dies_again_are_the_reason(one_worker, tmp_path, monkeypatch):
    ask, expected = one_worker
    deaths, mortal = tmp_path / "deaths", tmp_path / "mortal.py"
    mortal.write_text(
        f"import os, runpy, sys\nfrom pathlib import Path\ndeaths = Path({str(deaths)!r})\n"
        "left = int(deaths.read_text())\ndeaths.write_text(str(max(left - 1, 0)))\n"
        "if left:\n    sys.stderr.write('out of memory\\nin tile 7\\n')\n    sys.exit(1)\n"
        f"runpy.run_path({str(spread.WORKER)!r}, run_name='__main__')\n"
    )
    monkeypatch.setattr(spread, "WORKER", mortal)
    deaths.write_text("1")
    assert np.array_equal(ask("first"), expected)
    deaths.write_text("2")
    with pytest.raises(EtalonError, match=r"ended early \(out of memory; in tile 7\); compare from the command line"):
        ask("second")
    assert deaths.read_text() == "0"


def test_a_call_that_comes_after_the_end_opens_no_process(one_worker):
    ask, _ = one_worker
    end_order("late")
    with pytest.raises(Cancelled):
        ask("late")
    assert not spread._running
