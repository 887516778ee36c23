# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon audit` on scenes whose truth is known without it.

The truth is a closed form, or neutral renders clipped sample by sample.
"""

import json
import math
import re

import bpy
import numpy as np
import pytest
from etalon.addon.command import cli
from etalon.addon.command.audit import NEUTRAL_BESIDES, settings
from etalon.addon.cycles.audit_settings import CATALOGUE, MOST_BOUNCES, kept
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.cycles.settings import CyclesWith
from etalon.addon.host.quiet import quiet
from etalon.lib.audit.measure import audit
from etalon.lib.audit.setting import Setting
from etalon.lib.comparison.compare import CompareOptions
from etalon.lib.film.exr import read_exr
from etalon.lib.verdict.outcome import Outcome
from etalon.reference_scenes import building
from scipy.integrate import quad

WIDTH, HEIGHT = 32, 16


def as_neutral(scene):
    """Give every setting of the catalogue its neutral value for good."""
    for entry in CATALOGUE:
        for path, value in entry.neutral.items():
            name = path.rpartition(".")[2]
            for owner, of, _ in entry.of_file(scene):
                if of == name:
                    setattr(owner, name, value)


def halves(left=1.0, right=0.5):
    """Two half planes of constant radiance that meet in the middle column of the image."""
    scene = building.start("halves", WIDTH, HEIGHT, 0)
    building.world((right, right, right))
    glow = bpy.data.materials.new("Glow")
    if bpy.app.version < (5, 0):
        glow.use_nodes = True
    tree = glow.node_tree
    tree.nodes.clear()
    emission, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Strength"].default_value = left
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    building.rectangle("Half", glow, (-2.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 8.0, 0.0))
    building.camera((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), ortho_scale=2.0)
    as_neutral(scene)
    return scene


def lamp():
    """A diffuse floor under a point light without size.

    Each sample has one contribution, of direct light.
    """
    scene = building.start("lamp", WIDTH, HEIGHT, 0)
    building.rectangle(
        "Floor", building.diffuse("Paper", (0.8, 0.8, 0.8)), (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)
    )
    building.sphere_light("Lamp", (0.1, 0.1, 0.5), 0.1, (10.0, 10.0, 10.0))
    bpy.data.lights["Lamp"].shadow_soft_size = 0.0
    bpy.data.lights["Lamp"].energy = 40.0
    building.camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), ortho_scale=3.0)
    as_neutral(scene)
    return scene


def made(scene, assignments, seed=0, of=CyclesWith):
    """Cycles with these assignments."""
    return of(scene, {}, seed=seed, threads=1, others=assignments)


def audited(scene, rounds=12, samples=4, factory=False):
    """An audit of so many rounds of what the scene sets, and its findings by key."""
    asked, stays = settings(scene, factory), kept(scene)
    with quiet(), neutral(scene, max_bounces=MOST_BOUNCES, threads=1) as changes:
        changes.set_all("cycles", [scene.cycles], NEUTRAL_BESIDES)
        plain = made(scene, stays)
        candidates = [(s, made(scene, stays + v)) for s, v in asked.values]
        options = CompareOptions(time=1e6, samples=samples, replicates=rounds)
        found = audit("Test", plain, candidates, options, 4096, tuple(asked.same))
    return found, {f.setting.key: f for f in found.findings}


def holds(finding, region, truth):
    """Whether the interval of a region holds the true relative difference, in every channel."""
    return (finding.low[region] - 1e-6 <= truth).all() and (truth <= finding.high[region] + 1e-6).all()


def test_a_scene_at_the_neutral_state_has_nothing_to_report():
    scene = lamp()
    found, _ = audited(scene)
    assert found.findings == ()
    assert found.rounds == 0
    assert {s.key for s in found.same} >= {
        "clamp-direct",
        "clamp-indirect",
        "denoiser",
        "pixel-filter",
        "terminator-geometry",
        "adaptive",
    }


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_cycles_against_itself_with_other_random_numbers_is_not_biased():
    """Six times the same state under seeds of its own.

    Differences are noise, of the same size on both sides.
    """
    scene = gallery()
    as_neutral(scene)
    with quiet(), neutral(scene, max_bounces=8, threads=1):
        others = [(Setting(f"seed-{k}", "", "", "", ""), made(scene, [], seed=k)) for k in range(1, 7)]
        options = CompareOptions(time=1e6, samples=4, replicates=16)
        found = audit("Test", made(scene, []), others, options, 4096)
    assert all(f.outcome is not Outcome.DIFFERENT for f in found.findings)
    assert all(holds(f, k, 0.0) for f in found.findings for k in range(len(found.boxes)))
    assert all(0.5 < f.noise.value < 2.0 for f in found.findings)


@pytest.mark.compares_with_cycles
def test_a_clamp_on_what_the_camera_sees_is_its_closed_form():
    """Radiance 5 clamped at 2 is 2; on the other half 0.5 stays.

    So the left blocks lose 60 %, the image 3 of 5.5.
    """
    scene = halves(5.0, 0.5)
    scene.cycles.sample_clamp_direct = 2.0
    _, found = audited(scene)
    clamp = found["clamp-direct"]
    assert list(found) == ["clamp-direct"]
    assert clamp.outcome is Outcome.DIFFERENT
    for region, truth in ((0, -3.0 / 5.5), (1, -0.6), (2, 0.0)):
        np.testing.assert_allclose(clamp.difference[region], truth, atol=1e-5)
    assert clamp.worst[0] == 1
    np.testing.assert_allclose(clamp.map[:, :15], -0.6, atol=1e-5)
    np.testing.assert_array_equal(clamp.map[:, 17:], 0.0)


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_a_clamp_on_light_is_what_clipping_each_sample_by_hand_gives():
    """Independent neutral renders of one sample a pixel, clipped at the clamp's value.

    Each sample is a single contribution.
    """
    scene = lamp()
    limit = 1.0
    with quiet(), neutral(scene, max_bounces=MOST_BOUNCES, threads=1):
        renderer = CyclesRenderer(scene, seed=99, threads=1)
        samples = np.stack([renderer.render(k, 1).radiance for k in range(64)])
    scene.cycles.sample_clamp_direct = limit
    found, by_key = audited(scene, rounds=16, samples=8)
    clamp = by_key["clamp-direct"]
    truth = np.minimum(samples, limit).mean() / samples.mean() - 1.0
    error = np.abs((np.minimum(samples, limit) - samples).mean(axis=(1, 2, 3))).std() / 8 / samples.mean()
    assert truth < -0.1
    assert clamp.outcome is Outcome.DIFFERENT
    assert clamp.low[0].max() - 5 * error < truth < clamp.high[0].min() + 5 * error
    # It buys noise: what was above the limit varies no more.
    assert clamp.noise.high < 1.0
    assert found.neutral.mean() == pytest.approx(samples.mean(), rel=0.01)


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_the_light_threshold_costs_noise_and_no_bias():
    scene = lamp()
    bpy.data.lights["Lamp"].energy = 0.2
    scene.cycles.use_light_tree = False  # with it Cycles ignores the threshold
    scene.cycles.light_sampling_threshold = 0.3
    _, found = audited(scene, rounds=24, samples=64)
    light = found["light-threshold"]
    assert list(found) == ["light-threshold"]
    assert light.outcome is not Outcome.DIFFERENT
    assert holds(light, 0, 0.0)
    assert (light.high[0] - light.low[0]).max() < 0.2
    assert light.noise.low > 2.0


@pytest.mark.compares_with_cycles
def test_a_wide_filter_moves_light_over_an_edge_as_its_window_says():
    """The blocks beside the edge exchange what the Gaussian's window carries across.

    That is the sum over columns of P(offset > distance).
    """
    scene = halves(1.0, 0.5)
    width = 4.0
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", width
    _, found = audited(scene, rounds=24, samples=64)
    finding = found["pixel-filter"]

    def window(t):
        return math.exp(-8.0 * t * t / (width * width))

    end = 1.5 * width
    whole = quad(window, -end, end)[0]
    carried = sum(quad(window, x + 0.5, end)[0] / whole for x in range(math.ceil(end)) if x + 0.5 < end)
    left, right = -0.5 * carried / WIDTH * 2.0 / 1.0, 0.5 * carried / WIDTH * 2.0 / 0.5
    for block, truth in ((1, left), (2, right)):
        assert finding.low[block].max() - 1e-3 < truth < finding.high[block].min() + 1e-3
        np.testing.assert_allclose(finding.difference[block], truth, rtol=0.1)
    assert finding.outcome is Outcome.DIFFERENT
    assert np.abs(finding.difference[0]).max() < 1e-3
    assert found["pixel-filter"].setting.value == "GAUSSIAN, 4"


def gallery():
    """One of everything that a setting of the catalogue belongs to.

    All have the values that Blender starts with.
    """
    scene = building.start("gallery", WIDTH, HEIGHT, 4)
    building.world((0.3, 0.2, 0.1))
    glossy = building.glossy("Brass", "GGX", 0.1, (0.9, 0.7, 0.4))
    building.rectangle(
        "Floor", building.diffuse("Paper", (0.8, 0.8, 0.8)), (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)
    )
    building.sphere("Ball", glossy, (0.0, 0.0, 0.5), 0.5, 12, 7).data.polygons.foreach_set("use_smooth", [True] * 144)
    building.sphere_light("Lamp", (1.0, 0.5, 2.0), 0.3, (30.0, 30.0, 30.0))
    bpy.data.lights["Lamp"].use_soft_falloff = True
    building.camera((0.0, -4.0, 2.0), (0.0, 0.0, 0.3))
    scene.cycles.samples = 512
    return scene


def state(scene):
    """All values of all settings of the catalogue."""
    return {entry.key: [value for _, _, value in entry.of_file(scene)] for entry in CATALOGUE}


@pytest.mark.compares_with_cycles
def test_every_setting_is_in_force_for_itself_alone_and_leaves_no_trace():
    scene = gallery()
    scene.cycles.use_denoising = False
    before = state(scene)
    asked, stays = settings(scene, True), kept(scene)
    seen = []

    class Watched(CyclesWith):
        def _call(self, *arguments):
            seen.append(state(scene))
            return super()._call(*arguments)

    with quiet(), neutral(scene, max_bounces=MOST_BOUNCES, threads=1) as changes:
        changes.set_all("cycles", [scene.cycles], NEUTRAL_BESIDES)
        plain = made(scene, stays, of=Watched)
        image = plain.render(0, 4).radiance
        neutral_state = seen[-1]
        for setting, values in asked.values:
            made(scene, stays + values, of=Watched).render(0, 4)
            changed = {key for key, found in seen[-1].items() if found != neutral_state[key]}
            key = setting.key.removesuffix("-factory")
            assert setting.together or changed == {key}, setting
            np.testing.assert_array_equal(plain.render(0, 4).radiance, image, err_msg=setting.key)
    assert state(scene) == before
    entries = {entry.key: entry for entry in CATALOGUE}
    for key, found in neutral_state.items():
        first = next(iter(entries[key].neutral.values()))
        assert not found or first in found, key


def test_what_blender_starts_with_is_asked_only_where_it_is_not_what_the_file_has():
    scene = gallery()
    scene.cycles.sample_clamp_indirect, scene.cycles.blur_glossy = 3.0, 0.0
    of_file = {s.key: s for s, _ in settings(scene, False).values}
    everything = {s.key: s for s, _ in settings(scene, True).values}
    assert of_file.keys() < everything.keys()
    assert {"clamp-indirect", "max-bounces", "soft-falloff", "terminator-geometry", "together-file"} <= of_file.keys()
    assert {"clamp-indirect-factory", "filter-glossy-factory", "together-factory"} <= everything.keys()
    assert "soft-falloff-factory" not in everything
    assert of_file["clamp-indirect"].value == "3"
    assert everything["clamp-indirect-factory"].value == "10"
    assert of_file["adaptive"].needs == 81


@pytest.mark.compares_with_cycles
def test_adaptive_sampling_stops_where_it_would_in_a_whole_render(tmp_path):
    """A part of a sequence makes Cycles' threshold stricter, which is compensated.

    As many pixels stop as in F12.
    """

    def differing(full, adaptive):
        return np.mean(np.abs(adaptive - full) > 1e-5 * full)

    scene = gallery()
    as_neutral(scene)
    threshold, samples = 0.03, 128

    def whole(adaptive):
        cycles = scene.cycles
        cycles.use_adaptive_sampling, cycles.adaptive_threshold, cycles.samples = adaptive, threshold, samples
        cycles.use_sample_subset, cycles.sample_offset = False, 0
        with quiet():
            bpy.ops.render.render(write_still=True)
        return read_exr(tmp_path / "whole.exr")["R"]

    scene.render.filepath = str(tmp_path / "whole.exr")
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    stopped = differing(whole(False), whole(True))
    on = [(scene.cycles, "use_adaptive_sampling", True), (scene.cycles, "adaptive_threshold", threshold)]
    with quiet(), neutral(scene, threads=1):
        images = [made(scene, values).render(0, samples).radiance[..., 0] for values in ([], on)]
    assert 0.1 < stopped < 0.95
    assert differing(*images) == pytest.approx(stopped, abs=0.1)


def run(capfd, *words):
    """Exit code, standard output and the lines on standard error, without progress."""
    capfd.readouterr()
    code = cli.main(["audit", *map(str, words), "--quiet"])
    out, err = capfd.readouterr()
    return code, out, err.splitlines()


def test_whole_command(capfd, tmp_path):
    scene = gallery()
    path = tmp_path / "gallery.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    words = ("--replicates=2", "--samples=1", "--threads=1", "--all", "--set=scene.cycles.use_denoising=false")
    code, out, err = run(capfd, path, *words, f"--out={tmp_path / 'out'}")
    assert (code, err) == (0, [])
    assert re.match("gallery: (The setting that costs most is |No setting )", out)
    assert "Clamp Indirect" in out
    assert "Noise Threshold on, 0.01: not measured, it takes 81 samples per pixel, and these were 1" in out
    assert "as neutral: Clamp Direct, " in out
    figures = json.loads((tmp_path / "out" / "audit.json").read_text(encoding="utf-8"))
    assert figures["stopped"] == "replicates"
    assert figures["rounds"] == 2
    assert figures["samples_of_file"] == 512
    keys = {entry["key"] for entry in figures["settings"]}
    assert {"clamp-indirect", "denoiser-factory", "together-file", "together-factory"} <= keys
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        *("audit.html", "audit.json", "neutral.png"),
        *(f"map-{key}.png" for key in keys),
    }
    scene = bpy.context.scene
    assert (scene.cycles.samples, scene.cycles.sample_clamp_indirect, scene.cycles.max_bounces) == (512, 10.0, 4)
    assert bpy.data.lights["Lamp"].use_soft_falloff


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("scene.npz",), "give the .blend"),
        (("glossy_spheres", "--tolerance=2"), "more than 0 and less than 1"),
        (("glossy_spheres", "--confidence=0.3"), "at least 0.5"),
        (("nowhere.blend",), "no such file"),
        (("glossy_spheres", "--camera=Nobody"), "cameras there"),
    ],
)
def test_bad_input_is_one_line(words, told, capfd, tmp_path):
    code, out, err = run(capfd, *words, f"--out={tmp_path / 'audit'}")
    assert (code, out, len(err)) == (2, "", 1)
    assert told in err[0]
    assert not (tmp_path / "audit").exists()


def test_pictures_of_an_older_audit_are_known_by_its_figures(tmp_path):
    from etalon.lib.audit.write import old_pictures

    assert old_pictures(tmp_path) == []
    (tmp_path / "audit.json").write_text('{"settings": [{"key": "clamp-indirect"}]}')
    assert old_pictures(tmp_path) == ["neutral.png", "map-clamp-indirect.png"]
    for text in ("", "[]", '{"settings": 3}', '{"settings": [{}]}', '{"settings": ["x"]}'):
        (tmp_path / "audit.json").write_text(text)
        assert old_pictures(tmp_path) == []
