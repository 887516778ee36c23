# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon compare --scheduler` with a scheduler and two workers on loopback."""

import json
import os
import signal
from dataclasses import replace

import bpy
import numpy as np
import pytest
from etalon.addon.command.cli import main
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.cycles.spread import Order, close_order, render_cycles
from etalon.lib.cluster.client import connect
from etalon.lib.cluster.sides import Request, SpreadSide
from etalon.lib.cluster.worker import digest_of
from etalon.lib.errors import EtalonError
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
            cluster.run_everywhere(close_order, key)


def test_a_worker_with_another_blender_is_refused_in_one_line(address):
    order = Order("key", VERSION, ("4.5.0", "abc"), Target("lambert_analytic"), Settings(threads=1), {})
    with (
        connect(address) as cluster,
        pytest.raises(EtalonError, match=r"^worker tcp.* has Blender .*; install Blender 4.5.0 abc there"),
    ):
        cluster.call(render_cycles, (order, None, (), Request(0, 1)), {}, bool)
