# SPDX-License-Identifier: GPL-3.0-or-later
"""Planted cases: attribution must name exactly the departures that were planted.

The candidate is the reference with one or two departures on, under other seeds. Each scene lets every departure act on
cells of its own, well beyond the tolerance.
"""

from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.departures import alternatives
from etalon.lib.comparison.run import Stop
from etalon.lib.departures.catalogue import DEPARTURES, SWITCHES, relevant
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.report.words import sentences
from etalon.lib.scene.lights import SunLight
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.causes import Role, State
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.moments import SHUTTER_ENDS
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.subsurface import SHORT_WALKS
from etalon.tests import scenes
from etalon.tests.lib.departures.planted_scenes import (
    SCENES,
    early,
    furnace,
    judged,
    masking,
    planted,
    rug,
    slope,
    trail,
    wax,
)

# Of the scene with most departures, pairs of neighbours, in a circle; all at once are a test of their own.
# Of the default run: these pairs and all alone, but for those that take longest; the others are slow tests.
PAIRS = (("multiple-scattering tables", "Oren-Nayar colour"),)
LONG = (
    ("Oren-Nayar colour",),
    ("multiple-scattering tables", "Oren-Nayar colour"),
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


def neighbours(names):
    """The pairs of names that follow each other, and the first and the last."""
    return {*pairwise(names), (names[0], names[-1])}


def cases():
    """Each scene's departures, alone and in pairs."""
    for make in SCENES:
        # It would take too long to tell these from noise; test_short_walks.py and test_moments.py have their proofs.
        if make in (wax, trail):
            continue
        found = relevant(make(), masking(make))
        names, forms = [d.name for d in found], [{d.name, d.form_of} for d in found]
        # Of two forms of one departure the other adds nothing.
        pairs = [pair for pair in combinations(names, 2) if set(pair) not in forms]
        if make is furnace:
            pairs = [pair for pair in pairs if pair in PAIRS or pair in neighbours(names)]
        for chosen in [*((name,) for name in names), *pairs]:
            default = chosen in PAIRS or (chosen not in LONG and (len(chosen) == 1 or make is not furnace))
            marks = () if default else pytest.mark.slow
            yield pytest.param(make, chosen, id=f"{make.__name__}: {' + '.join(chosen)}", marks=marks)


@pytest.mark.grid(6)
@pytest.mark.parametrize(("make", "names"), list(cases()))
def test_attribution_names_exactly_what_was_planted(make, names, seed):
    found = judged(make, planted(make, names, seed))
    assert found.explanation.chosen == names
    assert found.verdict.outcome is Outcome.EXPLAINED


@pytest.mark.grid(3)
@pytest.mark.parametrize("make", list(SCENES))
def test_departures_act_on_the_passes_that_the_catalogue_says(make):
    """The same random numbers with and without the departure.

    What may not change is the same bit for bit, and something else is not.
    """
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
    """docs/departures_by_pass.md is made by a benchmark.

    A departure that is missing there has not been measured.
    """
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
    assert {name for case in cases() for name in case.values[1]} == SWITCHES - {SHORT_WALKS, SHUTTER_ENDS}


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
