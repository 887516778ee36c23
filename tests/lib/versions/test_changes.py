# SPDX-License-Identifier: GPL-3.0-or-later
"""Versions whose images, noise and departures are known.

Tested are what changed, why, and which is nearer to the reference.
"""

import json
import math
from pathlib import Path

import etalon.lib.versions as package
import numpy as np
import pytest
from etalon.lib.comparison import run as run_module
from etalon.lib.comparison.compare import CompareOptions
from etalon.lib.comparison.run import Stop, TimedRun
from etalon.lib.departures.catalogue import DEPARTURES
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.rendering import Rendering
from etalon.lib.progress import Progress
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.versions.changes import Nearer, judge
from etalon.lib.versions.document import document, scene_figures
from etalon.lib.versions.measure import Measured
from etalon.lib.versions.page import pictures_of, write_versions
from etalon.lib.versions.programs import Blender
from etalon.lib.versions.rounds import Contestant, pairs_of, render_rounds
from jsonschema import Draft202012Validator

SCHEMA = json.loads((Path(package.__file__).parent / "versions.schema.json").read_text(encoding="utf-8"))
SHAPE = (40, 48)
LEFT = np.arange(SHAPE[1]) < 16
COVERAGE = {"material": [("Wall", np.broadcast_to(LEFT, SHAPE)), ("Floor", np.broadcast_to(~LEFT, SHAPE))]}
GLOSSY, DIFFUSE = LightPass.GLOSSY_DIRECT, LightPass.DIFFUSE_DIRECT
CAUSE = DEPARTURES[0]


class Painter:
    """Paints 1 times `factor` on the left, with noise that all of one `stream` share.

    Each call takes a second of `clock`.
    """

    name, settings = "Painter", {}

    def __init__(self, clock, seed, stream, factor=1.0, sigma=0.05, passes=()):
        self.clock, self.key, self.factor, self.sigma, self.passes = clock, [seed, stream], factor, sigma, passes

    def render(self, replicate, samples, progress, windows=None):
        rng = np.random.default_rng([*self.key, replicate])
        image = 1.0 + self.sigma / math.sqrt(samples) * rng.standard_normal((*SHAPE, 3))
        light = image * np.where(LEFT, self.factor, 1.0)[:, None]
        self.clock.now += 1.0
        progress.report(1.0)
        passes = {DIFFUSE: 0.5 * image, GLOSSY: light - 0.5 * image} if self.passes else {}
        return Rendering(light, np.zeros(SHAPE, int), 1.0, passes=passes)


class Clock:
    """Stands in for the module `time`."""

    now = 0.0

    def monotonic(self):
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(run_module.time, "monotonic", clock.monotonic)
    return clock


def measured(clock, seed, factors, known=None, passes=(), replicates=12, cancelled=lambda: False):
    """The rounds and changes of versions with these factors.

    `known` are those that their models say.
    """
    reference = Painter(clock, seed, 1, passes=passes)
    models = [None if known is None else Painter(clock, seed, 1, factor, passes=passes) for factor in known or factors]
    contestants = [
        Contestant(f"{5 + k}.0", Painter(clock, seed, 0, factor, passes=passes), reference, model)
        for k, (factor, model) in enumerate(zip(factors, models, strict=True))
    ]
    options = CompareOptions(time=1000.0, samples=4, replicates=replicates)
    run = TimedRun(options.time, Progress(is_cancelled=cancelled))
    rounds = render_rounds("Test", contestants, COVERAGE, passes, options, run)
    why = [() if known is None else (CAUSE,)] * len(rounds.pairs)
    labels = tuple(one.label for one in contestants)
    return Measured(labels, rounds, judge(rounds, why, options), True, {}, 1), options


def test_the_version_that_changed_is_found_with_where_and_which_is_nearer(clock, seed):
    found, _ = measured(clock, seed, (1.05, 1.05, 1.01))
    same, step, whole = found.changes
    assert pairs_of(3) == ((0, 1), (1, 2), (0, 2))
    assert same.is_same
    assert same.outcome is Outcome.EQUIVALENT
    names = found.rounds.regions.names
    for change in (step, whole):
        assert change.outcome is Outcome.DIFFERENT
        wall, floor = names.index("Wall"), names.index("Floor")
        assert (change.outcomes[wall], change.outcomes[floor]) == (Outcome.DIFFERENT, Outcome.EQUIVALENT)
        assert change.nearer[wall] is Nearer.SECOND
        assert change.low[wall].max() <= 1.01 / 1.05 - 1 <= change.high[wall].min()
        assert (change.map[:, LEFT] < 0).all()
        assert (change.map[:, ~LEFT] == 0).all()


def test_a_change_away_from_the_reference_says_so(clock, seed):
    found, _ = measured(clock, seed, (1.0, 0.9))
    assert found.changes[0].nearer[found.rounds.regions.names.index("Wall")] is Nearer.FIRST


def test_a_change_that_departures_predict_is_explained_and_another_is_not(clock, seed):
    predicted, _ = measured(clock, seed, (1.05, 1.0), known=(1.05, 1.0))
    assert predicted.changes[0].outcome is Outcome.EXPLAINED
    half, _ = measured(clock, seed, (1.05, 1.0), known=(1.025, 1.0))
    assert half.changes[0].outcome is Outcome.DIFFERENT


def test_the_light_pass_that_changed_is_named(clock, seed):
    found, _ = measured(clock, seed, (1.0, 1.1), passes=(DIFFUSE, GLOSSY))
    passes = found.changes[0].passes
    assert (passes[DIFFUSE].outcomes == Outcome.EQUIVALENT).all()
    assert (passes[GLOSSY].outcomes == Outcome.DIFFERENT).any()
    figures = scene_figures("Test", [], found, "")
    assert "Parts of the light that changed: glossy direct." in figures["changes"][0]["sentences"]


def test_independent_noise_without_a_change_is_no_change(clock, seed):
    """The level holds for all regions and pairs together.

    It is 1 %, so that none of 20 runs may err more than once.
    """
    wrong = 0
    for k in range(20):
        contestants = [
            Contestant(str(n), Painter(clock, seed + k, n + 2, sigma=0.3), Painter(clock, seed + k, 1))
            for n in range(3)
        ]
        options = CompareOptions(time=1000.0, samples=4, replicates=6, tolerance=0.001)
        rounds = render_rounds("Test", contestants, COVERAGE, (), options, TimedRun(None, Progress()))
        changes = judge(rounds, [()] * 3, options)
        wrong += any(change.has_changed or (change.nearer != Nearer.OPEN).any() for change in changes)
    assert wrong <= 1


def test_one_round_decides_nothing_and_no_round_is_an_error(clock, seed):
    found, _ = measured(clock, seed, (1.0, 2.0), replicates=1)
    assert found.changes[0].outcome is Outcome.UNDECIDED
    with pytest.raises(EtalonError, match="there is nothing to tell"):
        measured(clock, seed, (1.0, 2.0), cancelled=lambda: True)


def test_cancelling_keeps_the_rounds_that_are_complete(clock, seed):
    found, _ = measured(clock, seed, (1.0, 1.1), cancelled=lambda: clock.now > 30)
    assert found.rounds.stopped is Stop.CANCELLED
    assert 2 <= found.rounds.count < 12


def test_page_and_json_say_the_same(clock, seed, tmp_path):
    found, options = measured(clock, seed, (1.05, 1.0, 1.0), known=(1.05, 1.0, 1.0))
    version = {
        "status": "finished",
        "message": "",
        "verdict": "EQUIVALENT",
        "bound": 0.004,
        "report": "a/b/report.html",
    }
    version |= {"image": {}, "causes": {"state": None, "names": []}}
    versions = [{"label": label, **version} for label in found.labels]
    name = "<b>room</b>"
    figures = document(
        [scene_figures(name, versions, found, "")],
        [Blender(label, (), (5, k, 0), "build", label) for k, label in enumerate(found.labels)],
        options,
        60.0,
        "etalon versions",
    )
    assert (figures["verdict"], figures["exit_code"]) == ("EXPLAINED", 4)
    write_versions(figures, {name: pictures_of(found, options.tolerance)}, tmp_path)
    page = (tmp_path / "versions.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "versions.json").read_text(encoding="utf-8")) == figures
    Draft202012Validator.check_schema(SCHEMA)
    Draft202012Validator(SCHEMA).validate(figures)
    assert not Draft202012Validator(SCHEMA).is_valid(figures | {"scenes": [{}]})
    assert figures["summary"].replace("<b>room</b>", "&lt;b&gt;room&lt;/b&gt;") in page
    assert "<b>room</b>" not in page
    for change in figures["scenes"][0]["changes"]:
        for sentence in change["sentences"]:
            assert sentence.replace("'", "&#39;") in page


@pytest.mark.parametrize(("error", "status"), [("no such camera", "finished"), ("", "refused")])
def test_what_could_not_be_compared_ends_with_exit_code_2(clock, seed, error, status):
    found, options = measured(clock, seed, (1.0, 1.0))
    versions = [{"label": "5.0", "status": status, "message": "x", "verdict": None, "bound": None, "report": None}]
    scene = scene_figures("room", versions, None if error else found, error)
    assert document([scene], [], options, 1.0, "")["exit_code"] == 2
