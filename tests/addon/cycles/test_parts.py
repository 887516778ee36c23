# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of bounces and light groups in Cycles.

They are the same parts as the reference's, and the user's own settings are restored.
"""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from etalon.addon.cycles import renderer as renderer_of_cycles
from etalon.addon.cycles.light_groups import read_emitter
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.job import compare_here, export
from etalon.lib.film.parts import WORLD, BounceLimit, EmitterLight
from etalon.lib.report.read import read_verdict
from etalon.lib.settings.comparison import Settings
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.reference_scenes import building

BOUNCES = 3
LATER = BounceLimit(2), BounceLimit(3)


def room():
    """Two walls that light each other under a lamp, a panel that shines and a sky."""
    scene = building.start("parts", 8, 4, BOUNCES)
    building.world((0.05, 0.1, 0.2))
    paper, shine = (building.diffuse(name, (0.8, 0.6, 0.4)) for name in ("Paper", "Shine"))
    tree = shine.node_tree
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (0.5, 0.8, 1.0, 1.0), 4.0
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    building.rectangle("Floor", paper, (0.0, 0.0, 0.0), (8.0, 0.0, 0.0), (0.0, 8.0, 0.0))
    building.rectangle("Wall", paper, (0.0, 1.0, 1.0), (8.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    building.rectangle("Panel", shine, (-1.0, 0.0, 2.0), (0.5, 0.0, 0.0), (0.0, 0.5, 0.0))
    building.sphere_light("Key", (1.0, -0.5, 2.0), 0.2, (5.0, 4.0, 3.0))
    building.camera((0.0, -4.0, 1.5), (0.0, 0.5, 0.3))
    return scene


def rendered(scene, parts, replicates, samples, seed):
    """Both sides' means (parts, 3) over the left and right half, of one export.

    They come with their standard errors.
    """
    reference = ReferenceRenderer(export(scene), Options(threads=1, seed=seed)).with_passes(parts)
    cycles = CyclesRenderer(scene, seed=seed, threads=1).with_passes(parts)
    found = []
    for renderer in (reference, cycles):
        rows = [renderer.render(k, samples) for k in range(replicates)]
        parted = [
            [[part[:, half].mean(axis=(0, 1)) for half in (slice(0, 4), slice(4, 8))] for part in row.passes.values()]
            for row in rows
        ]
        found.append(np.array(parted))
        assert tuple(rows[0].passes) == parts
    return found


def errors(found):
    """The difference of both sides' means, in its standard errors."""
    means = [side.mean(axis=0) for side in found]
    square = sum(side.var(axis=0, ddof=1) / len(side) for side in found) + (1e-5 * means[0]) ** 2
    return (means[1] - means[0]) / np.sqrt(square)


@pytest.mark.compares_with_cycles
def test_limits_of_bounces_mean_the_same_on_both_sides(seed):
    scene = room()
    limits = tuple(map(BounceLimit, range(BOUNCES + 1)))
    found = rendered(scene, limits, 16, 32, seed)
    assert np.abs(errors(found)).max() < 5.0
    # Each bounce adds light that is far more than the noise.
    assert (np.diff(found[1].mean(axis=0), axis=0) > 0.0).all()
    assert scene.cycles.max_bounces == BOUNCES


@pytest.mark.compares_with_cycles
def test_light_groups_are_the_reference_s_emitters(seed):
    scene = room()
    names = ReferenceRenderer(export(scene), Options(threads=1)).with_passes((WORLD,)).kernel.emitters.names
    assert set(names) == {EmitterLight("Key"), EmitterLight("Panel"), WORLD}
    found = rendered(scene, names, 16, 32, seed)
    assert np.abs(errors(found)).max() < 5.0
    whole = CyclesRenderer(scene, seed=seed, threads=1).with_passes(names).render(0, 16)
    np.testing.assert_allclose(sum(whole.passes.values()), whole.radiance, rtol=2e-6, atol=1e-6 * whole.radiance.max())


def test_the_user_s_light_groups_come_back(seed):
    """Also of an object in a group that the layer does not have, and where the render fails."""
    scene = room()
    layer = scene.view_layers[0]
    for name in ("Warm", "Cold"):
        layer.lightgroups.add(name=name)
    scene.objects["Key"].lightgroup, scene.objects["Floor"].lightgroup = "Cold", "Gone"
    scene.world.lightgroup = "Warm"

    def state():
        things = [*scene.objects, scene.world]
        return [group.name for group in layer.lightgroups], {one.name: one.lightgroup for one in things}

    before = state()
    renderer = CyclesRenderer(scene, threads=1)
    renderer.with_passes((EmitterLight("Key"), WORLD)).render(0, 1)
    assert state() == before
    with pytest.raises(Exception, match="no object has this name"):
        renderer.with_passes((EmitterLight("Nobody"),)).render(0, 1)
    assert state() == before


def test_groups_that_the_user_set_do_not_change_the_image(seed):
    scene = room()
    plain = CyclesRenderer(scene, seed=seed, threads=1).render(0, 4).radiance
    scene.objects["Key"].lightgroup = "Gone"
    bpy.context.view_layer.update()
    np.testing.assert_array_equal(CyclesRenderer(scene, seed=seed, threads=1).render(0, 4).radiance, plain)
    assert export(scene).lights


@pytest.mark.compares_with_cycles
def test_the_lamp_and_the_bounce_of_a_planted_fault_are_named(monkeypatch, tmp_path):
    """Two faults are planted in what is read of Cycles.

    They are 20 % less light of the lamp, and 20 % less light from the second bounce on.
    """
    scene, limited = room(), CyclesRenderer._with_limits
    place = []

    def dimmed(channels, number):
        return read_emitter(channels, number) * (0.8 if number == place[0] else 1.0)

    def fewer(self, *args):
        whole = limited(self, *args)
        return replace(
            whole, passes={part: light * (0.8 if part in LATER else 1.0) for part, light in whole.passes.items()}
        )

    names = ReferenceRenderer(export(scene), Options(threads=1)).with_passes((WORLD,)).kernel.emitters.names
    place.append(names.index(EmitterLight("Key")))
    monkeypatch.setattr(renderer_of_cycles, "read_emitter", dimmed)
    monkeypatch.setattr(CyclesRenderer, "_with_limits", fewer)
    settings = Settings(0.05, time=None, samples=64, replicates=16, bounces="0..3", lights=True, threads=1)
    comparison = compare_here(scene, settings, tmp_path / "out")
    said = read_verdict(tmp_path / "out" / "verdict.json")["sentences"]
    assert any(one.startswith("The light of 'Key' differs by -2") for one in said)
    assert any(one.startswith("All other lights agree to within") for one in said)
    assert any(one.startswith("The renderers part at bounce 2: with fewer the images agree") for one in said)
    assert comparison.verdict.outcome is Outcome.EQUIVALENT
