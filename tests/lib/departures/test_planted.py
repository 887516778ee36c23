# SPDX-License-Identifier: GPL-3.0-or-later
"""Planted cases: a candidate that is the reference with one or two departures on, under other seeds. Attribution must name exactly those.

Each scene lets every departure act on cells of its own, well beyond the tolerance.
"""

import functools
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.departures import Alternatives, alternatives
from etalon.lib.comparison.run import Stop
from etalon.lib.departures.catalogue import DEPARTURES, SWITCHES, relevant
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.report.words import sentences
from etalon.lib.scene.converters import Curve, Curves
from etalon.lib.scene.expressions import (
    ONE,
    WHITE,
    BeneathLayer,
    ColorRamp,
    Constant,
    Coordinates,
    ImageTexture,
    LayerWeight,
    Math,
    ValueToColor,
)
from etalon.lib.scene.images import Image
from etalon.lib.scene.lights import AreaLight, SunLight
from etalon.lib.scene.materials import Diffuse, Emission, Glass, Material, Metallic, Subsurface, WeightedClosure
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.causes import Role, State
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.subsurface import SHORT_WALKS
from etalon.tests import scenes

ANGLES = np.radians([64.0, 78.0, 87.1])
# Most are done after 27; where the difference is not much more than the tolerance its share takes longer.
REPLICATES = 62
# Of the default run: these pairs and all alone, but for those that take longest; the others are slow tests.
PAIRS = (("multiple-scattering tables", "Oren-Nayar colour"),)
LONG = (
    ("layer albedo table",),
    ("light below the face",),
    ("narrow spread",),
    ("thin film series", "thin film from inside"),
    ("rational Beckmann density",),
    ("rational Beckmann Lambda",),
    ("texture interpolation",),
    ("thin film series",),
    ("thin film from inside",),
    ("multiple-scattering tables",),
    ("refraction from behind",),
    ("Oren-Nayar colour", "narrow spread"),
)


def furnace():
    """A white world over facets that see nothing of each other, and a sun that the middle ones mirror to the camera."""
    inside = (0.2, 0.2, 0.2, 1.0), (0.9, 0.9, 0.9, 1.0)
    ramp = ColorRamp(LayerWeight(Constant(0.5), output="FACING"), (0.5610, 0.5620), inside)
    checker = np.ones((2, 2, 4), np.float32)
    checker[[0, 1], [0, 1], :3] = 0.6
    materials = [
        scenes.glossy(0.36, distribution="BECKMANN"),
        scenes.glossy(0.21**2, 0.9, distribution="MULTI_GGX"),
        scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0),
        scenes.material(Diffuse(ramp)),
        scenes.material(Diffuse(ImageTexture(Coordinates("POSITION"), 0))),
        Material("coated", (WeightedClosure(Diffuse(), BeneathLayer(Constant(1.5), WHITE, Constant(0.6), ONE)),)),
    ]
    twice = 2.0 * ANGLES[1]
    sun = SunLight("sun", (np.sin(twice), 0.0, np.cos(twice)), 0.0, (0.5, 0.5, 0.5))
    count = len(materials)
    geometry, camera = scenes.fan(ANGLES, count), scenes.fan_camera(ANGLES, count)
    scene = scenes.scene(geometry, materials, camera, (sun,), 1.0, images=(Image("checker", checker, "SRGB"),))
    return replace(scene, blender=(5, 2))


def coats():
    """A rough coat over a white base, and a layer that is no coat, in a white world, as Blender 5.3 has them."""
    coat = BeneathLayer(Constant(1.5), WHITE, Constant(0.8), ONE, "MULTI_GGX", coat=True)
    layer = BeneathLayer(Constant(1.5), WHITE, Constant(0.6), ONE)
    materials = [
        Material(name, (WeightedClosure(Diffuse(), node),)) for name, node in (("coat", coat), ("layer", layer))
    ]
    scene = scenes.scene(scenes.fan(ANGLES, 2), materials, scenes.fan_camera(ANGLES, 2), world=1.0)
    return replace(scene, blender=(5, 3))


def early():
    """A rough diffuse floor under a sun, as Blender 4.2 has it."""
    sun = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (1.0, 1.0, 1.0))
    camera = scenes.orthographic(2, 2, 1.0, (0.0, 0.0, 5.0))
    scene = scenes.scene(scenes.floor(), scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0), camera, (sun,))
    return replace(scene, blender=(4, 2))


def slope():
    """Two floors: one smooth, under a sun below its face but above its normals, one rough, under another sun."""
    parts = [scenes.quad((x, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), k) for k, x in enumerate((-2.0, 0.0))]
    tilted = np.repeat(np.array([[np.sin(0.5)], [0.0], [np.cos(0.5)]]), 4, axis=1)
    parts[0] = scenes.Part(parts[0].vertices, parts[0].triangles, 0, tilted)
    suns = [((np.cos(0.2), 0.0, -np.sin(0.2)), 0.05), ((0.0, 0.6, 0.8), 0.0)]
    suns = [SunLight(f"sun {k}", place, angle, (1.0, 1.0, 1.0)) for k, (place, angle) in enumerate(suns)]
    materials = [scenes.diffuse(0.8), scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0)]
    return replace(
        scenes.scene(parts, materials, scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0)), suns), blender=(5, 2)
    )


def soft_box():
    """A floor under an area light whose slats let hardly anything pass aside."""
    edges = (3.0, 0.0, 0.0), (0.0, 3.0, 0.0)
    light = AreaLight("narrow", (0.0, 0.0, 4.0), *edges, (0.0, 0.0, -1.0), "RECTANGLE", (1.0, 1.0, 1.0), 0.1)
    camera = scenes.orthographic(2, 2, 1.0, (0.0, 0.0, 3.0))
    scene = scenes.scene(scenes.floor(), scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0), camera, (light,))
    return replace(scene, blender=(5, 2))


def documents():
    """Rough facets in a white world; the reference masks them as the documents do, each direction by itself."""
    return scenes.scene(scenes.fan(ANGLES[1:]), scenes.glossy(0.6, 0.9), scenes.fan_camera(ANGLES[1:]), world=1.0)


def phong():
    """Facets by Ashikhmin and Shirley under grazing angles in a white world, and rough ones beside them."""
    materials = [scenes.glossy(0.7**2, 0.9, distribution="ASHIKHMIN_SHIRLEY"), scenes.glossy(0.6, 0.9)]
    return scenes.scene(scenes.fan(ANGLES, 2), materials, scenes.fan_camera(ANGLES, 2), world=1.0)


def window():
    """Rough glass, a sun below it that only facets whose backs it sees refract to the camera, and a steep rough face without it."""
    low, steep = 0.2, np.radians(85.0)
    parts = [
        scenes.quad((-2.0, -1.0, 0.0), (2.0, 0.0, 2.0 * np.tan(low)), (0.0, 2.0, 0.0), 0),
        scenes.quad((0.0, -1.0, 0.0), (2.0, 0.0, -2.0 * np.tan(steep)), (0.0, 2.0, 0.0), 1),
    ]
    glass = Material("glass", (WeightedClosure(Glass(distribution="GGX", roughness=Constant(0.8), ior=Constant(1.5))),))
    sun = SunLight("sun", (-0.9, 0.0, -0.436), 0.0, (10.0, 10.0, 10.0))
    camera = scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0))
    return scenes.scene(parts, [glass, scenes.glossy(0.6, 0.9)], camera, (sun,), 1.0)


def prism():
    """Dispersive glass that mirrors a lamp above the camera and swallows what it refracts."""
    parts = [scenes.floor(5.0), scenes.floor(50.0, 9.0, 1)]
    glass = scenes.material(Glass(ior=Constant(1.5), dispersion=Constant(1.0 / 3.0), transmission=scenes.color(0.0)))
    camera = scenes.orthographic(2, 1, 1.0, (0.1, 0.0, 5.0))
    return scenes.scene(parts, [glass, scenes.emission(10.0)], camera)


def films():
    """A film on a steep metal, and one on glass seen from behind, in a white world; what glass refracts is swallowed."""
    eta, k = (Constant((value,) * 3) for value in (1.5, 1.8))
    film = {"film_thickness": Constant(60.0), "film_ior": Constant(1.33)}
    metal = scenes.material(Metallic("GGX", "CONDUCTOR", eta, k, Constant(0.1), **film))
    film = {"film_thickness": Constant(20.0), "film_ior": Constant(2.0)}
    glass = scenes.material(Glass(ior=Constant(1.5), roughness=Constant(0.1), transmission=scenes.color(0.0), **film))
    parts = [
        scenes.quad((-2.0, -1.0, 0.0), (2.0, 0.0, -2.0 * np.tan(ANGLES[1])), (0.0, 2.0, 0.0), 0),
        scenes.quad((0.0, -1.0, 0.0), (0.0, 2.0, 0.0), (2.0, 0.0, 0.0), 1),
    ]
    made = scenes.scene(parts, [metal, glass], scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 20.0)), world=1.0)
    return replace(made, blender=(5, 3))


def curved():
    """Facets whose colour a curve makes of values above its end, where its handle falls and its table is flat."""
    curve = Curve(0.0, 1.0, (0.2, *(0.9,) * 256), (0.2, 0.0), (0.9, -0.8))
    facing = Math("ADD", LayerWeight(Constant(0.5), output="FACING"), ONE, Constant(0.0))
    materials = scenes.material(Diffuse(Curves(ONE, ValueToColor(facing), (curve,) * 3)))
    return scenes.scene(scenes.fan(ANGLES), materials, scenes.fan_camera(ANGLES), world=1.0)


def decal():
    """A texture of even texels that cover half of what they lie on, shining and as a diffuse floor under a sun."""
    parts = [scenes.quad((x, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), k) for k, x in enumerate((-2.0, 0.0))]
    texture = ImageTexture(Coordinates("POSITION"), 0, interpolation="CLOSEST", association="MULTIPLIED")
    materials = [scenes.material(Emission(texture)), scenes.material(Diffuse(texture))]
    sun = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (1.0, 1.0, 1.0))
    images = (Image("decal", np.tile(np.array([0.6, 0.7, 0.8, 0.5], np.float32), (2, 2, 1)), "SRGB"),)
    return scenes.scene(parts, materials, scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0)), (sun,), images=images)


def rug():
    """On the left a floor and its copy under a sun; on the right two panels in one plane that shine differently."""
    left, right = (scenes.quad((x, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0)) for x in (-2.0, 0.0))
    parts = [left, left, replace(right, material=1), replace(right, material=2)]
    sun = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (1.0, 1.0, 1.0))
    materials = [scenes.diffuse(0.8, 0.6, 0.4), scenes.emission(0.2), scenes.emission(0.3)]
    return scenes.scene(parts, materials, scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0)), (sun,))


def wax():
    """A thick bright body that light scatters inside of, in a white world."""
    coat = scenes.material(Subsurface(scenes.color(0.95), scenes.color(0.05), Constant(0.5)))
    return scenes.scene(scenes.cube(), coat, scenes.orthographic(1, 1, 0.5, (0.0, 0.0, 5.0)), world=1.0)


class Cached:
    """A renderer that remembers its replicates, so that cases share what they have in common."""

    settings: dict = {}  # noqa: RUF012

    def __init__(self, name, renderer):
        self.name, self._renderer, self._done = name, renderer, {}

    def render(self, replicate, samples, progress, windows=None):
        key = replicate, samples
        if key not in self._done:
            self._done[key] = self._renderer.render(replicate, samples)
        return replace(self._done[key], windows=windows)


@functools.cache
def prepared(make):
    """The scene, its reference, and what may depart, all with remembered replicates."""
    scene = make()
    reference = ReferenceRenderer(scene, Options(threads=1, masking=masking(make)))
    found = alternatives(reference)
    renderer = functools.cache(lambda names: Cached("alternative", found.renderer(names)))
    return scene, Cached("reference", reference), Alternatives(found.departures, renderer)


# Scene: tolerance, samples per pixel, and the cells that are too noisy to tell anything.
SCENES = {
    furnace: (1.5e-3, 1024, {3, 8}),
    slope: (1e-2, 128, set()),
    soft_box: (3e-4, 4096, set()),
    documents: (5e-3, 512, set()),
    phong: (1e-2, 512, set()),
    window: (2e-2, 4096, set()),
    coats: (3e-3, 1024, set()),
    early: (5e-3, 64, set()),
    prism: (2e-2, 512, set()),
    films: (5e-3, 1024, set()),
    curved: (5e-3, 64, set()),
    rug: (1e-2, 64, set()),
    decal: (1e-2, 64, set()),
    wax: (1e-2, 256, set()),
}


def masking(make):
    """The reference's form of it."""
    return "separable" if make is documents else "correlated"


def cells(make):
    """Every pixel as a region of its own."""
    camera = prepared(make)[0].camera
    shape = camera.height, camera.width
    told = [k for k in range(shape[0] * shape[1]) if k not in SCENES[make][2]]
    return {"cell": [(f"{k}", np.eye(shape[0] * shape[1])[k].reshape(shape)) for k in told]}


def judged(make, candidate):
    scene, reference, among = prepared(make)
    tolerance, samples, _ = SCENES[make]
    options = CompareOptions(tolerance, time=None, samples=samples, replicates=REPLICATES)
    return compare(scene, reference, candidate, cells(make), options, among=among)


def planted(make, names, seed):
    scene, _, _ = prepared(make)
    options = Options(threads=1, seed=seed, masking=masking(make), departures=frozenset(names))
    return Cached("candidate", ReferenceRenderer(scene, options))


def cases():
    """Each scene's departures, alone and in pairs."""
    for make in SCENES:
        if make is wax:  # walks take too long to tell this one from noise; test_short_walks.py has its proof
            continue
        names = [d.name for d in relevant(make(), masking(make))]
        for size in (1, 2):
            for chosen in combinations(names, size):
                default = chosen in PAIRS or (chosen not in LONG and (size == 1 or make is not furnace))
                marks = () if default else pytest.mark.slow
                yield pytest.param(make, chosen, id=f"{make.__name__}: {' + '.join(chosen)}", marks=marks)


@pytest.mark.parametrize(("make", "names"), list(cases()))
def test_attribution_names_exactly_what_was_planted(make, names, seed):
    found = judged(make, planted(make, names, seed))
    assert found.explanation.chosen == names
    assert found.verdict.outcome is Outcome.EXPLAINED


@pytest.mark.parametrize("make", list(SCENES))
def test_departures_act_on_the_passes_that_the_catalogue_says(make):
    """The same random numbers with and without: what may not change is the same bit by bit, and something else is not."""
    scene = make()
    options = Options(threads=1, masking=masking(make))
    plain = ReferenceRenderer(scene, options, passes=tuple(LightPass)).render(0, 16).passes
    for departure in relevant(scene, masking(make)):
        changed = replace(options, departures=frozenset([departure.name]))
        other = ReferenceRenderer(scene, changed, passes=tuple(LightPass)).render(0, 16).passes
        acts = {name for name in LightPass if (plain[name] != other[name]).any()}
        assert acts <= departure.passes
        assert acts


def test_the_table_of_departures_by_pass_has_every_switch():
    """docs/departures_by_pass.md is made by a benchmark; a departure that is missing there has not been measured."""
    table = (Path(__file__).parents[3] / "docs" / "departures_by_pass.md").read_text(encoding="utf-8")
    planted_here = table.split("| departure |")[1]
    assert [row.split(" | ")[0].removeprefix("| ") for row in planted_here.splitlines() if row.startswith("| ")] == [
        departure.name for departure in DEPARTURES if departure.name in SWITCHES
    ]


def half_and_half():
    """A rough mirror by Beckmann beside a rough diffuse floor, under a sun."""
    parts = [scenes.quad((x, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), k) for k, x in enumerate((-2.0, 0.0))]
    materials = [scenes.glossy(0.5, distribution="BECKMANN"), scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0)]
    sun = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (1.0, 1.0, 1.0))
    scene = scenes.scene(parts, materials, scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0)), (sun,))
    return replace(scene, blender=(5, 2))


def test_the_passes_that_differ_cut_the_search_and_the_cause_stays_the_same(seed):
    scene = half_and_half()
    options, planted_name = CompareOptions(1e-3, time=None, samples=16, replicates=30), "Oren-Nayar colour"
    candidate = Options(threads=1, seed=seed, departures=frozenset([planted_name]))
    found = []
    for passes in ((), (LightPass.DIFFUSE_DIRECT, LightPass.GLOSSY_DIRECT)):
        sides = (ReferenceRenderer(scene, one, passes=passes) for one in (Options(threads=1), candidate))
        among = alternatives(ReferenceRenderer(scene, Options(threads=1)))
        found.append(compare(scene, *sides, {}, options, among=among, passes=passes).explanation)
    assert [why.chosen for why in found] == [(planted_name,)] * 2
    assert [sum(shares is not None for shares in why.shares) for why in found] == [3, 1]
    cut = {role for name, role in zip(found[1].departures, found[1].roles, strict=True) if name.name != planted_name}
    assert cut == {Role.UNTRIED}


@pytest.mark.slow
def test_all_that_cycles_does_at_once(seed):
    names = tuple(d.name for d in relevant(furnace()))
    assert len(names) == 7
    found = judged(furnace, planted(furnace, names, seed))
    assert found.explanation.chosen == names
    assert found.verdict.outcome is Outcome.EXPLAINED


def test_a_departure_of_another_blender_is_refused():
    scene = replace(early(), blender=(5, 3))
    told = "'Oren-Nayar colour' exists in Blender 4.3 to 5.2, and this scene comes from Blender 5.3; leave it out"
    with pytest.raises(EtalonError, match=told):
        ReferenceRenderer(scene, Options(departures=frozenset({"Oren-Nayar colour"})))
    assert {d.name for d in relevant(scene)} == set()
    for release, name in (((4, 2), "Oren-Nayar without multiple scattering"), ((4, 3), "Oren-Nayar colour")):
        assert [d.name for d in relevant(replace(scene, blender=release))] == [name]
    assert len(relevant(replace(scene, blender=None))) == 2


def test_every_switch_is_planted_or_has_a_proof_without_noise():
    assert {name for case in cases() for name in case.values[1]} == SWITCHES - {SHORT_WALKS}


def test_nothing_is_named_where_nothing_was_planted(seed):
    found = judged(slope, planted(slope, (), seed))
    assert found.explanation is None
    assert found.verdict.outcome is Outcome.EQUIVALENT


class Brighter:
    """A candidate that is brighter than the reference, for no reason that the catalogue knows."""

    name = "brighter"
    settings: dict = {}  # noqa: RUF012

    def __init__(self, renderer, factor):
        self._renderer, self._factor = renderer, np.asarray(factor)

    def render(self, *how):
        rendering = self._renderer.render(*how)
        return replace(rendering, radiance=rendering.radiance * self._factor)


def test_what_no_departure_explains_stays_different(seed):
    found = judged(slope, Brighter(planted(slope, (), seed), 1.05))
    assert found.verdict.outcome is Outcome.DIFFERENT
    assert found.explanation.chosen == ()
    assert not any(found.explanation.causes)
    assert found.stopped is Stop.DECIDED  # all that could explain it is ruled out: no need to go on
    # Both departures do much here, but in places the wrong way, and in others nothing.
    assert found.explanation.state is State.RULED_OUT
    assert "Unexplained: 10 regions differ, and no set of the departures that apply fits" in " ".join(sentences(found))


class Between:
    """A candidate part of the way from one renderer to another."""

    name = "between"
    settings: dict = {}  # noqa: RUF012

    def __init__(self, first, second, part):
        self._ends, self._part = (first, second), part

    def render(self, *how):
        first, second = (renderer.render(*how) for renderer in self._ends)
        return replace(first, radiance=(1.0 - self._part) * first.radiance + self._part * second.radiance)


@pytest.mark.parametrize("part", [0.2, 0.7])
def test_what_lies_between_none_and_all_of_what_rounding_decides_is_put_down_to_the_scene(part, seed):
    plain, all_of_it = (planted(rug, names, seed) for names in ((), ("faces in one plane", "other of two faces")))
    found = judged(rug, Between(plain, all_of_it, part))
    assert found.verdict.outcome is Outcome.EXPLAINED
    assert found.explanation.state is State.ROUNDED
    assert found.explanation.rounded[1:].all()
    assert "Explained by the scene: faces in one plane and other of two faces." in " ".join(sentences(found))


@pytest.mark.slow
def test_what_rounding_cannot_make_stays_unexplained(seed):
    """A floor brighter than with or without its copy."""
    found = judged(rug, Brighter(planted(rug, (), seed), np.where(np.arange(4) < 2, 1.05, 1.0)[:, None]))
    assert found.verdict.outcome is Outcome.DIFFERENT
    assert not found.explanation.rounded.any()


def test_half_an_explanation_names_the_regions_that_it_covers(seed):
    name = "Oren-Nayar colour"
    left = np.where(np.arange(4) < 2, 1.05, 1.0)[:, None]
    found = judged(slope, Brighter(planted(slope, (name,), seed), left))
    assert found.verdict.outcome is Outcome.DIFFERENT
    assert found.explanation.chosen == (name,)
    told = dict(
        zip(found.regions.names, zip(found.explanation.causes, found.verdict.outcomes, strict=True), strict=True)
    )
    assert found.explanation.state is State.PARTIAL
    assert all(told[cell] == ((name,), Outcome.EXPLAINED) for cell in "2367")
    assert all(told[cell] == ((), Outcome.DIFFERENT) for cell in "0145")


def test_shares_add_up(seed):
    """On the rough floor all of the difference is the one departure's, and nothing is left."""
    name = "Oren-Nayar colour"
    found = judged(slope, planted(slope, (name,), seed))
    k = [d.name for d in found.explanation.departures].index(name)
    cell = found.regions.names.index("2")
    assert found.explanation.shares[k].value[cell] == pytest.approx(1.0, abs=1e-9)
    assert np.abs(found.explanation.rest[cell]).max() < 1e-9
