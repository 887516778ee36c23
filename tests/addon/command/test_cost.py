# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon cost` as a user meets it, and Cycles with settings of its user's."""

import json

import bpy
import numpy as np
import pytest
from etalon.addon.command import cli
from etalon.addon.command.opening import open_target
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.cycles.settings import CyclesWith, cycles_ways, traded
from etalon.addon.host.quiet import quiet

SMALL = ("--set", "scene.render.resolution_percentage=10", "--threads", "1")


def run(capfd, *words):
    capfd.readouterr()
    code = cli.main(["cost", *map(str, words), "--quiet"])
    out, err = capfd.readouterr()
    return code, out, err.splitlines()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("scene.npz",), "give the .blend"),
        (("glossy_spheres", "--verify"), "--target"),
        (("glossy_spheres", *SMALL, "--ways", "mis,cycels"), "did you mean 'cycles'?"),
        (("glossy_spheres", "--target", "0"), "more than 0 and less than 1"),
    ],
)
def test_bad_input_is_one_line(words, told, capfd, tmp_path):
    code, out, err = run(capfd, *words, "--out", tmp_path / "cost")
    assert (code, out) == (2, "")
    assert len(err) == 1
    assert told in err[0]
    assert not (tmp_path / "cost").exists()


@pytest.mark.slow
def test_whole_command(capfd, tmp_path):
    """Forecast and check on a real scene.

    Tested are the table, the sentence, the folder, and that the scene's settings are as they were.
    """
    open_target("sigma_sweep")
    before = traded(bpy.context.scene)
    words = ("sigma_sweep", *SMALL, "--target", "20%", "--verify", "--time", "1", "--ways", "mis,cycles")
    code, out, err = run(capfd, *words, "--out", tmp_path)
    assert (code, err) == (0, [])
    assert out.startswith("sigma_sweep: The cheapest unbiased way to 20 % is ")
    assert out.splitlines()[2].split() == ["to", "20", "%"]
    assert "it took" in out
    assert traded(bpy.context.scene) == before
    assert {p.name for p in tmp_path.iterdir()} == {
        *("cost.html", "cost.json", "cost.csv", "cost.png", "cost.svg", "stages.png", "stages.svg")
    }
    figures = json.loads((tmp_path / "cost.json").read_text(encoding="utf-8"))
    found = {way["key"]: way for way in figures["ways"]}
    assert list(found) == ["mis", "cycles"]
    assert found["mis"]["points"]
    # The command's clock holds the opening and the export, rendering's own does not.
    for way in figures["ways"]:
        for point in way["points"]:
            assert point["command_seconds"] > point["seconds"]["value"]
    assert sum(stage["share"] for stage in found["mis"]["stages"]) == pytest.approx(1.0)
    assert any("GGX" in stage["effects"] for stage in found["mis"]["stages"])
    assert figures["verification"]["key"] in found


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_settings_of_the_user():
    """What the user trades for time is in force for that way alone.

    The denoiser smooths, and the neutral state renders as before.
    """
    open_target("glossy_spheres")
    scene = bpy.context.scene
    scene.render.resolution_percentage = 10
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0.1
    users = traded(scene)
    assert users["sample_clamp_direct"] == pytest.approx(0.1)
    with neutral(scene, threads=1), quiet():
        ways = {way.key: way.make() for way in cycles_ways(scene, users, 0, 1, 0.0)}
        assert type(ways["cycles"]) is CyclesRenderer
        images = {key: ways[key].render(0, 4).radiance for key in ways}
        again = ways["cycles"].render(0, 4).radiance
    np.testing.assert_array_equal(images["cycles"], again)
    assert images["cycles-user"].mean() < 0.9 * images["cycles"].mean()

    def roughness(key):
        return np.abs(np.diff(images[key], axis=0)).mean()

    assert roughness("cycles-denoised") < 0.7 * roughness("cycles")
    assert traded(scene) == users
    assert ways["cycles-user"].settings["cycles.sample_clamp_direct"] == pytest.approx(0.1)


@pytest.mark.compares_with_cycles
def test_replicates_with_settings_are_independent_images():
    open_target("glossy_spheres")
    scene = bpy.context.scene
    scene.render.resolution_percentage = 10
    with neutral(scene, threads=1), quiet():
        renderer = CyclesWith(scene, {"use_adaptive_sampling": True}, seed=0, threads=1)
        one, two, same = (renderer.render(k, 4).radiance for k in (0, 1, 0))
    assert np.mean(one != two) > 0.5
    np.testing.assert_array_equal(one, same)
