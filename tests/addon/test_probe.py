# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon probe`: from a pixel on the command line to its parts.

Lamps have the Power of Blender.
"""

import json
import math

import bpy
import numpy as np
import pytest
from etalon.addon.command import cli
from etalon.addon.job import export
from etalon.lib.lights.units import light_units
from etalon.reference_scenes import building


def lamp(kind, energy, **values):
    """A light object of a kind with so much Power."""
    data = bpy.data.lights.new(kind, kind)
    data.energy = energy
    for name, value in values.items():
        setattr(data, name, value)
    item = bpy.data.objects.new(kind, data)
    item.location = (0.0, 0.0, 3.0)
    bpy.context.scene.collection.objects.link(item)


@pytest.fixture
def scene():
    """A floor under one lamp of each kind."""
    scene = building.start("probe", 4, 4, 2)
    building.rectangle(
        "Floor", building.diffuse("Paper", (0.5, 0.5, 0.5)), (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)
    )
    lamp("POINT", 10.0, shadow_soft_size=0.2)
    lamp("SPOT", 20.0, shadow_soft_size=0.0, spot_size=1.0, spot_blend=0.2)
    lamp("AREA", 30.0, shape="ELLIPSE", size=2.0, size_y=1.0, spread=2.0)
    lamp("SUN", 0.4, angle=0.1)
    building.camera((0.0, -1.0, 5.0), (0.0, 0.0, 0.0))
    return scene


def test_power_is_that_of_blender_s_field(scene):
    """Watts of points, spots and areas, W/m2 of suns; a spot sends out less."""
    found = {light.name: light_units(light) for light in export(scene).lights}
    for name, power in (("POINT", 10.0), ("SPOT", 20.0), ("AREA", 30.0), ("SUN", 0.4)):
        np.testing.assert_allclose(found[name].power, power, rtol=1e-6)
    for name in ("POINT", "AREA"):
        np.testing.assert_allclose(found[name].flux, found[name].power, rtol=1e-12)
    half = 1.0 - math.cos(0.5)
    np.testing.assert_allclose(found["SPOT"].flux, 20.0 * 0.5 * half * (1.0 - 0.5 * 0.2), rtol=1e-6)


def run(capfd, *words):
    """Exit code, standard output and standard error."""
    capfd.readouterr()
    code = cli.main([str(word) for word in (*words, "--quiet")])
    out, err = capfd.readouterr()
    return code, out, err


@pytest.fixture
def blend(scene, tmp_path):
    path = tmp_path / "probe.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.mark.compares_with_cycles
def test_a_pixel_is_taken_apart_on_both_sides(capfd, blend):
    code, out, _ = run(capfd, "probe", blend, "--pixel", 1, 2, "--time=2s", "--bounces=0..1", "--threads=1", "--json")
    assert code == 0
    figures = json.loads(out)
    assert figures["box"] == [1, 2, 1, 2]
    by_kind = {}
    for one in figures["readings"]:
        by_kind.setdefault(one["kind"], []).append(one)
    assert [one["name"] for one in by_kind["bounce"]] == ["up to 0 bounces", "bounce 1", "beyond bounce 1"]
    assert {one["name"] for one in by_kind["light"]} == {
        f"light of '{kind}'" for kind in ("POINT", "SPOT", "AREA", "SUN")
    }
    # Each way of taking it apart has all of the light, on both sides; each part agrees within five errors of a small sample.
    for side in ("reference", "cycles"):
        whole = np.array(by_kind["image"][0][side])
        for kind in ("light pass", "bounce", "light"):
            np.testing.assert_allclose(sum(np.array(one[side]) for one in by_kind[kind]), whole, rtol=1e-5)
    for one in figures["readings"]:
        error = np.hypot(one["reference_error"], one["cycles_error"])
        assert (np.abs(np.subtract(one["reference"], one["cycles"])) <= 10.0 * error + 1e-5).all()
    assert {light["name"] for light in figures["lights"]} == {"POINT", "SPOT", "AREA", "SUN"}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--pixel", 4, 0], "--pixel 4 0: the image has 4 x 4 pixels, and 1 x 1 are to be read; give a pixel inside"),
        (["--pixel", 3, 3, "--block=2"], "and 2 x 2 are to be read"),
        (["--pixel", -1, 0], "pixel"),
        (["--pixel", 0, 0, "--bounces=0..3"], "the scene ends paths after 2; give 0..2"),
        ([], "--pixel"),
    ],
)
def test_a_wrong_pixel_is_one_line(capfd, blend, words, told):
    code, _, err = run(capfd, "probe", blend, *words)
    assert code == 2
    assert told in err
    assert len(err.strip().splitlines()) == 1
