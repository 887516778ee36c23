# SPDX-License-Identifier: GPL-3.0-or-later
"""Sky Textures: the exported sky against Cycles at other directions, and refusals."""

import bpy
import numpy as np
import pytest
from etalon.addon.export.materials import read_material, read_world
from etalon.addon.export.nodes.images import ImageTable
from etalon.addon.job import export
from etalon.lib.effects.plan import make_plan
from etalon.lib.textures.evaluate import Evaluator
from etalon.lib.textures.images import ImageSet
from etalon.lib.textures.sky import toward
from etalon.lib.wavefront.direction import Directions
from etalon.tests.addon.export.conftest import camera_rays
from etalon.tests.addon.export.nodes.node_cells import glowing, node, prepare, quad, rendered, through_emission
from mathutils import Vector

EXACT = bpy.app.version >= (5, 0)
"""Before, the ground below a sky is a formula, and not part of its table."""
SINGLE, MULTIPLE = ("SINGLE_SCATTERING", "MULTIPLE_SCATTERING") if EXACT else ("NISHITA", "NISHITA")
SUN = {"sun_elevation": 0.3, "sun_rotation": 0.7}
AZIMUTH = 0.5 * np.pi - 0.7


def world_of(scene, **properties):
    """A world of one Sky Texture, and its node."""
    world = scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    world.cycles.sampling_method = "NONE"
    tree = world.node_tree
    tree.nodes.clear()
    sky = node(tree, "TexSky", **properties)
    glow = node(tree, "Background", {"Color": sky})
    tree.links.new(glow, tree.nodes.new("ShaderNodeOutputWorld").inputs["Surface"])
    return sky.node


def look(direction, angle, **properties):
    """A scene of a quad behind a camera that looks along `direction` at a sky."""
    scene = prepare("PERSP", 64, 48)
    quad("quad", -100.0 * Vector(direction), 0.0, False)
    scene.camera.rotation_euler = Vector(direction).to_track_quat("-Z", "Y").to_euler()
    scene.camera.data.sensor_width, scene.camera.data.angle = 3.0, angle
    return scene, world_of(scene, **properties)


def both(scene, folder):
    """The exported world along the pixels' rays, and what Cycles shows there, (3, n) each."""
    shown = rendered(scene, folder)[:, ::-1].reshape(3, -1)
    exported = export(scene)
    direction = camera_rays(exported.camera)[1].reshape(3, -1)
    got = Evaluator(Directions(direction), ImageSet(exported.images))(exported.world.radiance)
    return got, shown


def errors(got, shown):
    """Relative to the shown and, where that is dark, to a hundredth of its mean."""
    return np.abs(got - shown) / (np.abs(shown) + 0.01 * shown.mean())


# Right at the horizon a sky changes by half from one float32 to the next.
@pytest.mark.grid(2)
@pytest.mark.parametrize(
    ("kind", "elevation", "along"), [(SINGLE, 0.3, 0.9), (MULTIPLE, -0.04, 0.01), (MULTIPLE, 2.6, -0.4)]
)
def test_a_sky_is_that_of_cycles(kind, elevation, along, tmp_path):
    scene, _ = look(toward(along, 1.0), 1.6, sky_type=kind, sun_disc=False, sun_elevation=elevation, sun_rotation=-4.0)
    error = errors(*both(scene, tmp_path))
    assert np.quantile(error, 0.99) < (5e-5 if EXACT else 5e-3)
    assert np.mean(error) < (2e-4 if EXACT else 5e-4)


@pytest.mark.parametrize("kind", ["PREETHAM", "HOSEK_WILKIE"])
def test_a_sky_of_formulas_is_that_of_cycles(kind, tmp_path):
    scene, sky = look((0.5, 0.4, 0.1), 1.6, sky_type=kind, sun_direction=(0.5, 0.3, 0.4), turbidity=4.0)
    tree = sky.id_data
    turned = node(tree, "Mapping", {"Vector": node(tree, "TexCoord", output="Generated"), "Rotation": (0.1, 0.0, 0.5)})
    tree.links.new(turned, sky.inputs[0])
    error = errors(*both(scene, tmp_path))
    assert error.max() < 0.01
    assert np.quantile(error, 0.99) < 3e-4


@pytest.mark.grid(3)
@pytest.mark.parametrize(
    ("kind", "size", "elevation"), [(SINGLE, 0.0095, 0.3), (MULTIPLE, 0.0012, 1.45), (MULTIPLE, 1.2, 2.0)]
)
def test_the_disc_of_the_sun_is_that_of_cycles(kind, size, elevation, tmp_path):
    sun = {"sun_elevation": elevation, "sun_rotation": 0.7, "sun_size": size, "sun_intensity": 0.4}
    # Not quite centred, so that no two pixels are alike.
    scene, _ = look(toward(elevation + 0.2 * size, AZIMUTH), 1.5 * size, sky_type=kind, **sun)
    got, shown = both(scene, tmp_path)
    # A pixel's ray is known to a float32: at the very limb that is in or out.
    error = errors(got, shown)
    assert np.quantile(error, 0.99) < 2e-3
    assert got.mean() == pytest.approx(shown.mean(), rel=1e-3)
    assert shown.max() > 10.0 * shown.min()


def test_a_sun_below_the_horizon_is_none(tmp_path):
    scene, _ = look(toward(-0.03, AZIMUTH), 0.04, sky_type=SINGLE, sun_elevation=-0.03, sun_rotation=0.7)
    got, shown = both(scene, tmp_path)
    assert np.quantile(errors(got, shown), 0.99) < 1e-3


def test_nothing_is_left_behind_and_the_plan_says_what_it_is(seed):
    scene, _ = look(toward(0.3, 0.0), 1.0, sky_type=SINGLE, sun_elevation=0.3, sun_rotation=seed % 1000 / 1000)
    kept = {thing.name for thing in bpy.data.user_map()}
    exported = export(scene)
    assert {thing.name for thing in bpy.data.user_map()} - {"Render Result"} == kept
    (fact,) = (d.fact for d in make_plan(exported).decisions if d.effect == "environment world")
    assert fact == "the world is lit by a sky, as Blender renders it, its sun's disc apart"


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"sun_elevation": 0.004}, "Sun Disc cut by the horizon"),
        ({"sun_size": 0.0005}, "Sun Size below 0.06 degrees"),
    ],
)
def test_suns_that_are_not_simulated_are_refused(change, named):
    scene = prepare("PERSP", 8, 8)
    world_of(scene, **{"sky_type": SINGLE, **SUN, **change})
    refusals = []
    read_world(scene.world, ImageTable(), refusals)
    (refusal,) = map(str, refusals)
    assert named in refusal
    assert "add a sun lamp" in refusal


def test_a_sun_disc_on_a_surface_is_refused():
    prepare("PERSP", 8, 8)
    refusals = []
    read_material(glowing("glow", through_emission(lambda tree: node(tree, "TexSky"))), ImageTable(), refusals)
    (refusal,) = map(str, refusals)
    assert "(Sky Texture), Sun Disc outside of a world" in refusal
