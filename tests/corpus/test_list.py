# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of real files is well formed, and fetching trusts nothing that it gets.

No test here uses the network.
"""

import importlib.util
import io
import re
import sys
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path, PureWindowsPath

import pytest
from etalon.lib.batch.plan import read_plan


@contextmanager
def script(name):
    """A script of this folder as a module; it is not part of the package."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    try:
        yield module
    finally:
        del sys.modules[spec.name]


@pytest.fixture(scope="module")
def corpus():
    with script("fetch") as module:
        yield module


@pytest.fixture(scope="module")
def drawing(corpus):
    with script("draw") as module:
        yield module


def test_the_list_has_a_hundred_scenes_of_twenty_repositories(corpus):
    scenes = [file for file in corpus.read_list() if file.path.lower().endswith(".blend")]
    assert len(scenes) >= 100
    assert len({file.repository for file in scenes}) >= 20


def test_every_row_is_an_address_and_stays_below_the_folder(corpus):
    files = corpus.read_list()
    for file in files:
        assert re.fullmatch(r"[\w.-]+/[\w.-]+", file.repository), file
        assert re.fullmatch(r"[0-9a-f]{40}", file.commit), file
        assert re.fullmatch(r"[0-9a-f]{64}", file.sha256), file
        assert not file.place.is_absolute(), file
        assert not PureWindowsPath(file.place).drive, file
        assert not {"..", ""} & set(file.place.parts), file
    assert len({file.place for file in files}) == len(files)


def test_a_file_with_another_hash_is_not_kept(corpus, monkeypatch, tmp_path):
    file = corpus.Listed(
        "owner/name", "0" * 40, "a b/c.blend", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
    )
    monkeypatch.setattr(corpus.urllib.request, "urlopen", lambda url, timeout: io.BytesIO(b""))
    assert file.url.endswith("/a%20b/c.blend")
    assert corpus.fetch(replace(file, sha256="0" * 64), tmp_path) == "other content than listed; not kept"
    assert not list(tmp_path.iterdir())
    assert corpus.fetch(file, tmp_path) is None
    assert (tmp_path / file.place).is_file()


def test_a_draw_of_fewer_begins_a_draw_of_more(drawing):
    listed = [str(file.place) for file in drawing.read_list()]
    drawn = drawing.draw(30)
    assert len(set(drawn)) == 30
    assert set(drawn) <= set(listed)
    assert drawn != sorted(drawn)
    assert drawing.draw(12) == drawn[:12]


def test_a_batch_reads_the_plan_of_a_draw(drawing, tmp_path):
    scenes = drawing.draw(3)
    for scene in scenes:
        (tmp_path / scene).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / scene).touch()
    drawing.write_plan(scenes, tmp_path / "drawn.toml")
    plan = read_plan(tmp_path / "drawn.toml")
    plan.require_scenes(())
    assert [*plan.scenes] == scenes
    assert plan.options == ("--time=60",)
    assert [v.values for v in plan.variations] == [(480,), (270,), (100,)]
