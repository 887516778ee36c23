# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon fit`: from files and from spheres that Cycles renders, and what it refuses."""

import json
import math

import bpy
import numpy as np
import pytest
from etalon.addon.command.cli import main
from etalon.addon.sphere import observe_sphere
from etalon.lib.errors import EtalonError
from etalon.lib.fit.identify import identify
from etalon.lib.fit.measured import DEFAULT_NOISE, observe_brdf, scatter
from etalon.lib.fit.observations import plain_observations
from etalon.lib.measured.merl import SHAPE
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.settings.fit import FitSettings
from etalon.tests.lib.measured.files import wavy_fields, write_tensors

pytestmark = pytest.mark.filterwarnings("ignore:.*use_nodes.*:DeprecationWarning")


def sphere(roughness, distribution="GGX", size=32, segments=128):
    """A smooth sphere with a Glossy BSDF under a sun, seen by an orthographic camera."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2, radius=1.0)
    ball = bpy.context.object
    for face in ball.data.polygons:
        face.use_smooth = True
    material = bpy.data.materials.new("Glossy")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output, glossy = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeBsdfAnisotropic")
    glossy.distribution = distribution
    for name, value in (("Color", (0.9, 0.7, 0.5, 1.0)), ("Roughness", roughness)):
        glossy.inputs[name].default_value = value
    tree.links.new(glossy.outputs[0], output.inputs["Surface"])
    ball.data.materials.append(material)
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.0
    lamp, camera = bpy.data.objects.new("Sun", sun), bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    lamp.rotation_euler = 0.7, 0.3, 0.2
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 2.05, (0.0, 0.0, 5.0)
    for item in (lamp, camera):
        scene.collection.objects.link(item)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    return scene


def observe(scene, **changes):
    """Its observations from few samples."""
    return observe_sphere(scene, FitSettings(threads=1, samples=16, replicates=8, **changes), NO_PROGRESS, "test")


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(
    ("distribution", "roughness", "width", "size"),
    [("GGX", 0.1, 0.3, 32), ("GGX", 0.8, 0.02, 32), ("MULTI_GGX", 0.8, 0.02, 16)],
)
def test_the_model_and_alpha_of_a_glossy_sphere_are_found_in_cycles_image(distribution, roughness, width, size):
    found = identify(observe(sphere(roughness, distribution, size)))
    low, high = found.intervals["alpha"]
    assert found.fits
    name = distribution.lower().replace("_", "-")
    assert name in [one.candidate.distribution for one in found.equivalent]
    assert low <= roughness**2 <= high
    assert high - low < width * roughness**2
    # The highlight's total goes with alpha squared, so the colour is known no better than twice alpha is.
    assert found.reflectances() == pytest.approx([0.7], rel=0.01 + 2.0 * (high - low) / roughness**2)


def spoil_sun(scene):
    """A sun with a width."""
    bpy.data.lights["Sun"].angle = 0.1


def spoil_sphere(scene):
    """An ellipsoid."""
    scene.objects[0].scale[2] = 0.5


def spoil_world(scene):
    """A grey world."""
    scene.world = bpy.data.worlds.new("World")


def spoil_camera(scene):
    """A view from behind, where no light falls."""
    bpy.data.objects["Sun"].rotation_euler = math.pi, 0.0, 0.0


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (spoil_sun, "a sun of angle 0"),
        (spoil_sphere, "not a sphere with smooth faces"),
        (spoil_world, "the world gives light"),
        (spoil_camera, "nothing lit to fit"),
    ],
)
def test_a_scene_that_is_no_sphere_under_a_sun_is_refused_in_one_line(spoil, message):
    scene = sphere(0.5, size=8, segments=32)
    spoil(scene)
    with pytest.raises(EtalonError, match=message) as refused:
        observe(scene)
    assert "\n" not in str(refused.value)


def test_the_command_refuses_bad_files_in_one_line(tmp_path, capfd):
    broken = write_tensors(tmp_path / "nan.bsdf", {**wavy_fields([0.0], [0.0, 1.0]), "ndf": np.full((5, 8), np.nan)})
    for words in ([str(broken)], [str(tmp_path / "none.binary")], [str(broken), "--object", "Ball"]):
        assert main(["fit", *words, "--quiet"]) == 2
        error = capfd.readouterr().err
        assert error.startswith("etalon: ")
        assert error.count("\n") == 1


@pytest.mark.slow
def test_the_command_prints_its_answer_as_json(tmp_path, capfd, monkeypatch):
    path = write_tensors(tmp_path / "waves.bsdf", wavy_fields([0.0], [0.0, 0.7, 1.4]))
    whole = observe_brdf(path)
    assert (whole.noise, whole.colors, whole.anisotropic) == (DEFAULT_NOISE, 3, False)
    assert whole.values.shape[1] > 1000
    part = plain_observations(whole.wi[:, ::20], whole.wo[:, ::20], whole.values[:1, ::20], 0.02, False, str(path))
    monkeypatch.setattr("etalon.addon.command.fit.observe_file", lambda *_: part)
    assert main(["fit", str(path), "--json", "--quiet"]) == 0
    figures = json.loads(capfd.readouterr().out)
    assert figures["fits"] is False  # waves are no lobe
    assert figures["noise"] == 0.02


def test_the_scatter_of_a_merl_table_is_its_noise(rng):
    k, d, p = np.meshgrid(*(np.arange(n) + 0.5 for n in SHAPE), indexing="ij", sparse=True)
    smooth = np.exp(-0.003 * k * k) * (1.0 + 0.3 * np.cos(np.radians(2.0 * p)) * d / 90.0)
    noisy = smooth * (1.0 + 0.02 * rng.standard_normal((1, *SHAPE)))
    assert scatter(noisy) == pytest.approx(0.02, rel=0.03)
    assert scatter(smooth[None]) == 1e-3
