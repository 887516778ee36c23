# SPDX-License-Identifier: GPL-3.0-or-later
"""A scheduler and two workers on loopback.

Images and batches are those of one machine. Workers that die or differ are survived or reported.
"""

import json
import os
import signal
import sys
from pathlib import Path

import etalon.lib.batch as batch_package
import numpy as np
import pytest
from etalon.lib.batch import asked, remote
from etalon.lib.batch.plan import read_plan
from etalon.lib.batch.prepare import How
from etalon.lib.batch.run import run_plan
from etalon.lib.cluster import client
from etalon.lib.cluster.client import connect
from etalon.lib.cluster.replicates import render_film_on_cluster
from etalon.lib.errors import EtalonError
from etalon.lib.progress import Progress
from etalon.lib.rendering.replicates import render_film
from etalon.lib.report.document import FORMAT, VERSION
from etalon.lib.settings.reference import RenderOptions
from etalon.tests.scenes import cube, diffuse, floor, orthographic, scene
from jsonschema import Draft202012Validator

CAMERA = orthographic(12, 8, 1.0, (0.0, 0.0, 2.0))
SCENE = scene((floor(), cube(0.2, (0.0, 0.0, 0.4))), diffuse(0.5, 0.6, 0.7), CAMERA, world=1.0, bounces=2)
SCHEMA = json.loads((Path(batch_package.__file__).parent / "batch.schema.json").read_text(encoding="utf-8"))
VERDICT = {
    "format": FORMAT,
    "version": VERSION,
    "image": {"difference": 0.0, "interval": [0.0, 0.0]},
    "bound": {"value": 0.004},
    "regions": [{"outcome": "EQUIVALENT"}],
    "tolerance": 0.01,
    "confidence": 0.99,
    "versions": {"etalon": "0.1.0"},
    "blender": {"version": "5.3.0"},
}
# Stands in for `etalon`: reports what it read of the scene's files, found from the scene's place.
STAND_IN = """
import json, sys
from pathlib import Path
if sys.argv[1] == "plan":
    said = Path(sys.argv[2]).read_text()
    print(json.dumps({"files": [said if "wood" in said else str(Path(sys.argv[2]).parent.parent / "textures" / "wood.png")]}))
    sys.exit(0)
scene = Path(sys.argv[2])
out = Path(next(word[6:] for word in sys.argv if word.startswith("--out=")))
out.mkdir()
found = [scene.read_text(), (scene.parent.parent / "textures" / "wood.png").read_text()]
(out / "verdict.json").write_text(json.dumps(VERDICT | {"found": found, "at": str(scene)}))
"""

# Before it stands in, it dies with the first scene as often as the file beside it says.
MORTAL = """
import os, signal, sys
from pathlib import Path
deaths = Path(__file__).with_name("deaths")
if sys.argv[1] == "compare" and sys.argv[2].endswith("a.blend") and int(deaths.read_text()):
    deaths.write_text(str(int(deaths.read_text()) - 1))
    print("loading", file=sys.stderr)
    print("out of luck", file=sys.stderr, flush=True)
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture(scope="module")
def address():
    """A scheduler with two workers of one thread each.

    They run in threads of this process, which talk over loopback.
    """
    distributed = pytest.importorskip("distributed", reason="Dask is not installed; `pip install etalon[cluster]`")
    made = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0"}
    with distributed.LocalCluster(processes=False, protocol="tcp://", host="127.0.0.1", **made) as cluster:
        yield cluster.scheduler_address


def test_an_image_from_two_workers_is_that_of_one_machine_bit_for_bit(address, seed):
    options = RenderOptions(samples=2, replicates=5, seed=seed, threads=1)
    with connect(address) as cluster:
        assert cluster.slots == 2
        cluster.check()
        spread = render_film_on_cluster(cluster, SCENE, options)
        ended = render_film_on_cluster(cluster, SCENE, options, Progress(is_cancelled=lambda: True))
    alone = render_film(SCENE, options)
    assert spread.moments.n == alone.moments.n == 5
    assert np.array_equal(spread.moments.mean, alone.moments.mean)
    assert np.array_equal(spread.moments.m2, alone.moments.m2)
    assert (spread.rays, spread.camera_samples) == (alone.rays, alone.camera_samples)
    assert alone.moments.m2.any()
    assert ended.moments.n == 0


def test_an_estimator_that_states_its_bias_is_not_spread(address):
    with connect(address) as cluster, pytest.raises(EtalonError, match="photon-mapping states its bias on one machine"):
        render_film_on_cluster(cluster, SCENE, RenderOptions(strategy="photon-mapping"))


@pytest.fixture
def plan(tmp_path, monkeypatch):
    """A batch of two scenes that share a texture, with a stand-in for `etalon`."""
    for name in ("scenes", "textures"):
        (tmp_path / name).mkdir()
    for name in ("a", "b"):
        (tmp_path / "scenes" / f"{name}.blend").write_text(name)
    (tmp_path / "textures" / "wood.png").write_text("wood")
    (tmp_path / "stand_in.py").write_text(f"VERDICT = {VERDICT}\n{STAND_IN}")
    for module in (asked, remote):
        monkeypatch.setattr(module, "etalon_command", lambda: [sys.executable, str(tmp_path / "stand_in.py")])
    (tmp_path / "plan.toml").write_text('out = "out"\nscenes = ["scenes/*.blend"]\n')
    return read_plan(tmp_path / "plan.toml")


def reports(plan):
    return [json.loads(path.read_text()) for path in sorted(plan.out.glob("*/verdict.json"))]


def test_a_batch_reaches_workers_by_path_or_by_content(address, plan, monkeypatch):
    with connect(address) as cluster:
        assert run_plan(plan, How("5.3.0", cluster=cluster), [].append) == 0
        assert [one["found"] for one in reports(plan)] == [["a", "wood"], ["b", "wood"]]
        assert [one["at"] for one in reports(plan)] == [plan.target(name) for name in plan.scenes]
        Draft202012Validator(SCHEMA).validate(json.loads((plan.out / "batch.json").read_text()))
        # A path at which a worker has another file, or none, counts for nothing.
        monkeypatch.setattr("etalon.lib.cluster.worker._digest_at", lambda *file: "another")
        assert run_plan(plan, How("5.3.0", cluster=cluster, force=True), [].append) == 0
    assert [one["found"] for one in reports(plan)] == [["a", "wood"], ["b", "wood"]]
    assert not {one["at"] for one in reports(plan)} & {plan.target(name) for name in plan.scenes}


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
@pytest.mark.parametrize(("deaths", "code"), [(1, 0), (2, 2)])
def test_a_comparison_that_dies_in_a_living_worker_begins_again_once(address, plan, deaths, code):
    program, told = plan.folder / "stand_in.py", []
    program.write_text(MORTAL + program.read_text())
    (plan.folder / "deaths").write_text(str(deaths))
    with connect(address) as cluster:
        assert run_plan(plan, How("5.3.0", cluster=cluster), told.append) == code
    assert (plan.folder / "deaths").read_text() == "0"
    assert len(reports(plan)) == 3 - deaths
    assert any("failed: it was ended by signal 9 (loading; out of luck)" in line for line in told) == (code != 0)


def test_files_at_absolute_paths_that_a_worker_has_not_are_refused(address, plan, monkeypatch):
    scene = plan.folder / "scenes" / "a.blend"
    scene.write_text(str(plan.folder / "textures" / "wood.png"))
    told = []
    monkeypatch.setattr("etalon.lib.cluster.worker._digest_at", lambda *file: "another")
    with connect(address) as cluster:
        assert run_plan(plan, How("5.3.0", cluster=cluster), told.append) == 2
    says = f"{scene} refers to {scene.read_text()} by an absolute path; make it relative, or share the file"
    assert sum(says in line for line in told) == 1
    assert len(reports(plan)) == 1


def test_a_worker_that_differs_is_one_line(address, monkeypatch):
    with connect(address) as cluster:
        monkeypatch.setattr(client, "describe_blender", lambda: "4.5.0 abc")
        with pytest.raises(
            EtalonError, match=r"^worker tcp://127.* has Blender 4.5.0 abc; install Blender 5.3.0 def there"
        ):
            cluster.check("5.3.0 def")
        done = cluster.call(remote.run_on_worker, ("0.0", [], {}, None, None), {}, bool)
        assert done.status == "ended"
        assert done.message.endswith("; install Étalon 0.0 there, and run the batch again")
        monkeypatch.setattr(client, "VERSION", "0.0")
        with pytest.raises(EtalonError, match=r"^worker tcp://127.* has Étalon .*; install Étalon 0.0 there, as here$"):
            cluster.check()


@pytest.mark.slow
def test_a_worker_that_dies_while_it_is_asked_is_left_out(monkeypatch):
    distributed = pytest.importorskip("distributed", reason="Dask is not installed; `pip install etalon[cluster]`")
    made = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0", "host": "127.0.0.1"}
    with distributed.LocalCluster(processes=True, **made) as own, connect(own.scheduler_address) as cluster:
        first = min(cluster._client.run(os.getpid).values())

        def describe():
            if os.getpid() == first:
                os._exit(1)
            return "same"

        monkeypatch.setattr(client, "describe_blender", describe)
        cluster.check("same")


def test_a_scheduler_that_does_not_answer_is_one_line(address, monkeypatch):
    monkeypatch.setattr(client, "_CONNECT", "0.2s")
    for nobody in ("tcp://127.0.0.1:9", "nonsense://x"):
        with (
            pytest.raises(EtalonError, match=r"no scheduler answers there; start one with `dask scheduler`"),
            connect(nobody),
        ):
            pass


def test_without_dask_a_scheduler_is_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(EtalonError, match=r"needs Dask; install it by `pip install etalon\[cluster\]`"),
        connect("tcp://h:1"),
    ):
        pass


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_nothing(seed):
    distributed = pytest.importorskip("distributed", reason="Dask is not installed; `pip install etalon[cluster]`")
    options = RenderOptions(samples=4, replicates=8, seed=seed, threads=1)
    made = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0"}
    with (
        distributed.LocalCluster(processes=True, host="127.0.0.1", **made) as own,
        connect(own.scheduler_address) as cluster,
    ):
        killed = []

        def kill(share):
            if not killed:
                killed.append(next(iter(cluster._client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        film = render_film_on_cluster(cluster, SCENE, options, Progress(kill))
    assert killed
    assert np.array_equal(film.moments.mean, render_film(SCENE, options).moments.mean)
