# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles as one side of a comparison.

Its neutral state comes and goes without a trace, its pixels are linear floats, its replicates independent.
"""

import warnings

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.neutral import SEQUENCE
from etalon.addon.cycles.renderer import CHUNK, CyclesRenderer, neutral
from etalon.lib.errors import EtalonError
from etalon.lib.film.windows import Windows
from etalon.lib.progress import Progress
from etalon.reference_scenes import building

RADIANCE = (0.25, 1.5, 3000.0)


def restless():
    """A scene that has little of the neutral state.

    It has one of everything that `neutral` touches.
    """
    scene = building.start("restless", 12, 10, 3)
    building.world((0.3, 0.2, 0.1))
    paper = building.diffuse("Paper", (0.5, 0.6, 0.7))
    plane = building.rectangle("Plane", paper, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    building.sphere_light("Ball", (0.5, 0.5, 2.0), 0.3, (5.0, 4.0, 3.0))
    building.area_light("Panel", (0.0, 0.0, 3.0), (0.0, 0.0, 0.0), (1.0, 1.0), (1.0, 1.0, 1.0))
    building.camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), ortho_scale=2.0)
    scene.view_layers.new("Second")
    plane.modifiers.new("Subdivide", "SUBSURF")
    odd = {
        scene.cycles: {
            "samples": 17,
            "seed": 5,
            "sample_clamp_indirect": 2.5,
            "blur_glossy": 1.0,
            "pixel_filter_type": "BLACKMAN_HARRIS",
            "film_exposure": 0.7,
            "caustics_reflective": False,
            "use_adaptive_sampling": True,
            "time_limit": 3.0,
            "transparent_max_bounces": 8,
        },
        scene.render: {
            "engine": "BLENDER_WORKBENCH",
            "film_transparent": True,
            "use_simplify": True,
            "dither_intensity": 1.0,
            "threads_mode": "AUTO",
            "filepath": "//elsewhere",
        },
        scene.render.image_settings: {"file_format": "JPEG", "quality": 31},
        bpy.data.lights["Ball"]: {"use_soft_falloff": True},
        bpy.data.lights["Ball"].cycles: {"max_bounces": 2, "use_multiple_importance_sampling": False},
        paper.cycles: {"use_bump_map_correction": True},
        scene.world.cycles: {"max_bounces": 3},
    }
    for owner, values in odd.items():
        for name, value in values.items():
            if hasattr(owner, name):
                setattr(owner, name, value)
    return scene


def properties(owner):
    """Every plain property that can be written, by name."""
    found = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of properties that a later Blender drops
        for rna in owner.bl_rna.properties:
            if not rna.is_readonly and rna.type not in ("POINTER", "COLLECTION"):
                value = getattr(owner, rna.identifier)
                found[rna.identifier] = tuple(value) if getattr(rna, "is_array", False) else value
    return found


def snapshot(scene):
    """All of the scene that a render setting could live in."""
    owners = {"scene": scene, "render": scene.render, "cycles": scene.cycles, "image": scene.render.image_settings}
    for kind in ("objects", "materials", "lights", "worlds", "meshes", "cameras"):
        for item in getattr(bpy.data, kind):
            owners[f"{kind} {item.name}"] = item
            if hasattr(item, "cycles"):
                owners[f"{kind} {item.name} cycles"] = item.cycles
    for item in bpy.data.objects:
        owners |= {f"modifier {item.name} {m.name}": m for m in item.modifiers}
    for layer in scene.view_layers:
        owners |= {f"layer {layer.name}": layer, f"layer {layer.name} cycles": layer.cycles}
    # Blender stamps the time of the last render and redraw on nothing else than these.
    return {name: properties(owner) for name, owner in owners.items()}


def test_neutral_changes_much_and_gives_all_of_it_back():
    scene = restless()
    before = snapshot(scene)
    with neutral(scene, max_bounces=1, threads=1) as changes:
        inside = snapshot(scene)
        assert changes.refused == []
        assert scene.render.engine == "CYCLES"
        assert scene.cycles.sample_clamp_indirect == 0.0
        assert scene.render.image_settings.file_format == "OPEN_EXR"
        assert bpy.data.lights["Ball"].use_soft_falloff is False
    changed = {name for name in before if before[name] != inside[name]}
    assert {"render", "cycles", "image", "lights Ball", "materials Paper cycles", "worlds World cycles"} <= changed
    assert snapshot(scene) == before


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_neutral_gives_back_after_an_exception_and_when_nested(error):
    scene = restless()
    before = snapshot(scene)

    def fail():
        with neutral(scene), neutral(scene, max_bounces=0):
            scene.cycles.sample_clamp_indirect = 9.0  # a value that somebody else leaves behind
            raise error

    with pytest.raises(error):
        fail()
    assert snapshot(scene) == before


def test_rendering_leaves_no_trace():
    scene = restless()
    before = snapshot(scene)
    CyclesRenderer(scene, threads=2).render(0, 2)
    assert snapshot(scene) == before


def glowing(width=8, height=6):
    """A camera in a world of one radiance: every pixel is known."""
    scene = building.start("glow", width, height, 0)
    building.world(RADIANCE)
    building.camera((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    return scene


@pytest.mark.compares_with_cycles
def test_pixels_are_linear_floats_of_the_emission():
    scene = glowing()
    scene.view_settings.exposure = 2.0
    scene.cycles.film_exposure = 0.5
    done = []
    found = CyclesRenderer(scene, threads=2).render(0, 3, Progress(done.append))
    assert found.radiance.shape == (6, 8, 3)
    assert found.radiance.dtype == np.float64
    np.testing.assert_allclose(found.radiance, np.broadcast_to(RADIANCE, (6, 8, 3)), rtol=1e-6)
    assert found.nonfinite.sum() == 0
    assert found.camera_samples == 8 * 6 * 3
    assert done == sorted(done)
    assert done[-1] == 1.0
    assert found.seconds > 0


def lit():
    """A plane under a lamp: noise in every pixel."""
    scene = building.start("lit", 16, 16, 0)
    building.world((0.0, 0.0, 0.0))
    paper = building.diffuse("Paper", (0.8, 0.8, 0.8))
    building.rectangle("Paper", paper, (0.0, 0.0, 0.0), (9.0, 0.0, 0.0), (0.0, 9.0, 0.0))
    building.area_light("Lamp", (0.2, 0.1, 1.0), (0.2, 0.1, 0.0), (1.0, 1.0), (5.0, 5.0, 5.0))
    building.camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), ortho_scale=2.0)
    return scene


@pytest.mark.compares_with_cycles
def test_replicates_are_independent_and_repeatable():
    """Noise of 24 replicates: pairs correlate as independent ones do.

    So the mean is as much better as its standard error says.
    """
    scene = lit()
    renderer = CyclesRenderer(scene, seed=3, threads=2)
    with neutral(scene, threads=2):
        images = np.stack([renderer.render(k, 1).radiance[..., 0] for k in range(24)])
        again = renderer.render(5, 1).radiance[..., 0]
        other = CyclesRenderer(scene, seed=4, threads=2).render(5, 1).radiance[..., 0]
    np.testing.assert_allclose(again, images[5], rtol=1e-6)
    assert not np.allclose(other, images[5], rtol=1e-3)
    noise = (images - images.mean(axis=0)).reshape(24, -1)
    correlation = np.corrcoef(noise)[np.triu_indices(24, 1)]
    # About the common mean, pairs of n independent replicates correlate by -1 / (n - 1), with deviation 1 / sqrt(256 pixels).
    assert abs(correlation.mean() + 1 / 23) < 0.02
    assert np.abs(correlation).max() < 6 / 16


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("bordered", [False, True])
def test_a_part_is_the_image_in_that_part(bordered):
    """Exactly the same samples of the same pixels.

    This holds also where the file has a border of its own.
    """
    scene = lit()
    if bordered:
        edges = {"min_x": 0.25, "max_x": 0.9, "min_y": 0.2, "max_y": 0.8}
        scene.render.use_border = True
        for name, value in edges.items():
            setattr(scene.render, f"border_{name}", value)
    before = snapshot(scene)
    renderer = CyclesRenderer(scene, seed=3, threads=2)
    whole = renderer.render(2, 2)
    windows = Windows(whole.nonfinite.shape, ((0, 1, 2, 3), (4, 2, 6, 2), (5, 2, 9, 8)))
    part = renderer.render(2, 2, windows=windows)
    assert whole.radiance.shape == ((9, 10, 3) if bordered else (16, 16, 3))
    np.testing.assert_array_equal(part.radiance, np.where(windows.mask[..., None], whole.radiance, 0.0))
    assert part.camera_samples == 2 * windows.pixels
    assert snapshot(scene) == before


@pytest.mark.compares_with_cycles
def test_a_replicate_of_many_samples_is_drawn_in_chunks():
    scene = glowing(4, 4)
    told, asked = [], []
    renderer = CyclesRenderer(scene, threads=2)

    def cancelled():
        asked.append(scene.cycles.seed)
        return False

    found = renderer.render(0, CHUNK + 3, Progress(told.append, cancelled))
    assert len(told) == len(asked) == 2
    assert told[-1] == 1.0
    np.testing.assert_allclose(found.radiance, np.broadcast_to(RADIANCE, (4, 4, 3)), rtol=1e-5)
    assert found.camera_samples == 16 * (CHUNK + 3)


def test_cancelled_gives_nothing_and_leaves_no_trace():
    scene = glowing()
    before = snapshot(scene)
    with pytest.raises(EtalonError, match="cancelled before the image was finished"):
        CyclesRenderer(scene).render(0, 4, Progress(is_cancelled=lambda: True))
    assert snapshot(scene) == before


@pytest.mark.compares_with_cycles
def test_pixels_that_are_not_finite_are_counted():
    scene = building.start("broken", 4, 4, 0)
    building.world((3e38, 3e38, 3e38)).node_tree.nodes["Background"].inputs["Strength"].default_value = 1e6
    building.camera((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    found = CyclesRenderer(scene, threads=1).render(0, 2)
    assert ((found.nonfinite > 0) == ~np.isfinite(found.radiance).all(axis=2)).all()


def test_scenes_that_cannot_be_rendered_are_refused_by_name():
    scene = glowing()
    scene.camera = None
    with pytest.raises(EtalonError, match="glow: the scene has no camera"):
        CyclesRenderer(scene)
    scene = glowing()
    scene.view_layers[0].use = False
    with pytest.raises(EtalonError, match="glow: no view layer"):
        CyclesRenderer(scene)


@pytest.mark.compares_with_cycles
def test_the_first_layer_in_use_is_rendered_and_all_stay_in_use():
    """Of three layers the first is off.

    Only the second shows the black sheet before the sky.
    """
    scene = glowing()
    sheet = building.rectangle("Sheet", building.diffuse("Black", (0, 0, 0)), (0, 0, 0), (8, 0, 0), (0, 8, 0))
    shown = bpy.data.collections.new("shown")
    scene.collection.children.link(shown)
    for collection in sheet.users_collection:
        collection.objects.unlink(sheet)
    shown.objects.link(sheet)
    scene.view_layers[0].layer_collection.children["shown"].exclude = True
    for name, exclude in (("middle", False), ("last", True)):
        scene.view_layers.new(name).layer_collection.children["shown"].exclude = exclude
    scene.view_layers[0].use = False
    cycles = CyclesRenderer(scene, threads=1)
    for replicate in range(2):
        assert not cycles.render(replicate, 1).radiance.any()
    assert [layer.use for layer in scene.view_layers] == [False, True, True]


def evaluated(scene, *names):
    """The named settings of Cycles as a depsgraph has them."""
    scene.frame_set(scene.frame_current)
    cycles = scene.evaluated_get(bpy.context.evaluated_depsgraph_get()).cycles
    return [getattr(cycles, name) for name in names]


@pytest.mark.skipif(bpy.app.version < (4, 4), reason="actions have no slots before Blender 4.4")
def test_animation_in_a_second_slot_of_an_action_is_muted_too():
    """The first slot belongs to the light."""
    scene = building.start("animated", 8, 8, 0)
    building.sphere_light("Ball", (0.0, 0.0, 2.0), 0.3, (1.0, 1.0, 1.0))
    action = bpy.data.actions.new("both")
    for owner, kind in ((bpy.data.lights["Ball"], "LIGHT"), (scene, "SCENE")):
        slot = action.slots.new(kind, owner.name)
        owner.animation_data_create().action = action
        owner.animation_data.action_slot = slot
    bpy.data.lights["Ball"].keyframe_insert("energy", frame=1)
    scene.cycles.samples = 16
    scene.keyframe_insert("cycles.samples", frame=1)
    with neutral(scene):
        assert evaluated(scene, "samples") == [SEQUENCE]
    assert evaluated(scene, "samples") == [16]


def test_animation_and_drivers_of_what_must_hold_are_muted_and_come_back():
    scene = building.start("animated", 8, 8, 0)
    building.sphere_light("Ball", (0.0, 0.0, 2.0), 0.3, (1.0, 1.0, 1.0))
    light = bpy.data.lights["Ball"]
    light.use_soft_falloff = True
    light.keyframe_insert("use_soft_falloff", frame=1)
    scene.cycles.samples = 16
    scene.keyframe_insert("cycles.samples", frame=1)
    driver = scene.driver_add("cycles.sample_clamp_indirect")
    driver.driver.expression = "3.0"
    names = "samples", "sample_clamp_indirect"
    assert evaluated(scene, *names) == [16, 3.0]
    for _ in range(2):
        with neutral(scene):
            assert evaluated(scene, *names) == [SEQUENCE, 0.0]
            assert not light.evaluated_get(bpy.context.evaluated_depsgraph_get()).use_soft_falloff
        assert evaluated(scene, *names) == [16, 3.0]
        assert light.use_soft_falloff
        assert not driver.mute
