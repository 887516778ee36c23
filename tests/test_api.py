# SPDX-License-Identifier: GPL-3.0-or-later
"""The public names.

They are lazy, documented by examples that run, and the same inside Blender as outside it.
"""

import doctest
import importlib
import subprocess
import sys
import textwrap
from pathlib import Path

import bpy
import etalon
import pytest
from etalon import api
from etalon.lib.scene import archive

ROOT = Path(__file__).resolve().parents[1]
FUNCTIONS = ("batch", "compare", "cost", "fit", "plan", "probe", "render")

# What a script inside Blender finds: the package below bl_ext, and no other of that name on any path.
LAYOUT = f"""
import importlib.util, sys
from importlib.machinery import PathFinder
from types import ModuleType
import bpy

sys.path[:] = [p for p in sys.path if PathFinder.find_spec("etalon", [p]) is None]
sys.path_importer_cache.clear()
sys.meta_path[:] = [f for f in sys.meta_path if f is PathFinder or f.find_spec("etalon", None) is None]
for name in ("bl_ext", "bl_ext.user_default"):
    sys.modules.setdefault(name, ModuleType(name)).__path__ = []
spec = importlib.util.spec_from_file_location(
    "bl_ext.user_default.etalon", {str(ROOT / "__init__.py")!r}, submodule_search_locations=[{str(ROOT)!r}]
)
extension = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(extension)
"""


def run_script(text, cwd, *, layout=LAYOUT):
    """Run a script in a process of its own; its output."""
    script = layout + textwrap.dedent(text)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_examples_of_the_public_functions_run():
    finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner()
    for name in FUNCTIONS:
        tests = finder.find(getattr(etalon, name), name, globs={})
        assert sum(len(test.examples) for test in tests) >= 1, name
        for test in tests:
            runner.run(test)
    assert runner.summarize().failed == 0


@pytest.mark.parametrize("name", ["lib.settings.comparison", "lib.settings.words", "lib.errors"])
def test_examples_of_settings_run(name):
    found = doctest.testmod(importlib.import_module(f"etalon.{name}"))
    assert found.attempted
    assert found.failed == 0


def test_every_public_name_is_there_and_documented():
    for name in etalon.__all__:
        assert name == "__version__" or getattr(etalon, name).__doc__, name
    assert {name for name in dir(etalon) if not name.startswith("_")} >= set(etalon.__all__) - {"__version__"}
    with pytest.raises(AttributeError, match="no attribute 'compair'"):
        etalon.compair  # noqa: B018


def test_importing_the_package_imports_neither_blender_nor_numpy(tmp_path):
    run_script("import etalon, sys; assert not {'bpy', 'numpy'} & sys.modules.keys()", tmp_path, layout="")


def test_lib_and_render_work_without_blender(tmp_path):
    """As on Python 3.12, for which there is no bpy.

    A saved scene is rendered, and what needs Blender says what to install.
    """
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = 8
    from etalon.addon import job

    archive.save(job.export(bpy.context.scene), tmp_path / "cube.npz")
    script = """
    import sys
    sys.modules["bpy"] = None
    import etalon
    film = etalon.render("cube.npz", etalon.RenderOptions(samples=1, replicates=2, threads=1))
    assert film.shape == (8, 8)
    assert etalon.plan("cube.npz").needs("indirect light") in (True, False)
    try:
        etalon.compare("glossy_spheres")
    except etalon.EtalonError as error:
        print(error)
    """
    assert "pip install bpy" in run_script(script, tmp_path, layout="")


def test_one_import_serves_scripts_inside_blender_too(tmp_path):
    script = """
    assert importlib.util.find_spec("etalon") is None
    extension.register()
    import etalon
    assert sorted(dir(etalon)) == sorted(extension.__all__)
    assert etalon.Settings is extension.Settings
    assert etalon.__version__ == extension.__version__
    assert etalon.EtalonError is sys.modules["bl_ext.user_default.etalon.lib.errors"].EtalonError
    print(etalon.plan("lambert_analytic").needs("Lambert"))
    try:
        import etalon.lib
    except ImportError:
        print("not a package")
    extension.unregister()
    assert "etalon" not in sys.modules
    assert not any(name.startswith("etalon.") for name in sys.modules)
    """
    assert run_script(script, tmp_path).split("\n")[-3:-1] == ["True", "not a package"]


@pytest.mark.slow
def test_a_package_installed_by_pip_keeps_its_name(tmp_path):
    (tmp_path / "etalon.py").write_text("OTHER = True\n")
    script = """
    sys.path.insert(0, "")
    importlib.invalidate_caches()
    extension.register()
    import etalon
    assert etalon.OTHER
    extension.unregister()
    assert "etalon" in sys.modules
    """
    run_script(script, tmp_path)


def test_api_gives_every_name_that_the_root_promises():
    assert set(etalon.__all__) - {"__version__"} <= vars(api).keys()


PLAN = """
scenes = ["lambert_analytic"]
[options]
{options}
"""


@pytest.fixture
def nobody(monkeypatch):
    """The address of a scheduler that is not there."""
    pytest.importorskip("distributed", reason="Dask is not installed; `pip install etalon[cluster]`")
    monkeypatch.setattr("etalon.lib.cluster.client._CONNECT", "0.2s")
    return "tcp://127.0.0.1:9"


def test_a_scheduler_that_does_not_answer_is_no_comparison_here(nobody, tmp_path):
    says = r"^--scheduler tcp://127.0.0.1:9: no scheduler answers there; start one with `dask scheduler`"
    (tmp_path / "plan.toml").write_text(PLAN.format(options="time = 5"))
    target = etalon.Target("lambert_analytic", assignments=("scene.render.resolution_percentage=5",))
    with pytest.raises(etalon.EtalonError, match=says):
        etalon.compare(target, etalon.Settings(scheduler=nobody))
    with pytest.raises(etalon.EtalonError, match=says):
        etalon.render(target, etalon.RenderOptions(scheduler=nobody))
    with pytest.raises(etalon.EtalonError, match=says):
        etalon.batch(tmp_path / "plan.toml", scheduler=nobody)


def test_a_scheduler_that_is_no_text_is_one_line():
    with pytest.raises(etalon.EtalonError, match=r"^scheduler: 8786 is not a text$"):
        etalon.Settings(scheduler=8786)


def test_a_plan_names_no_scheduler(tmp_path):
    (tmp_path / "plan.toml").write_text(PLAN.format(options='scheduler = "tcp://h:1"'))
    with pytest.raises(etalon.EtalonError, match=r"\[options\]: unknown option 'scheduler'"):
        etalon.batch(tmp_path / "plan.toml")
