# SPDX-License-Identifier: GPL-3.0-or-later
"""What a plan leaves out was not needed.

The planned image is that with every effect forced on.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from etalon.lib.effects.names import Effect
from etalon.lib.effects.plan import Decision, Plan, make_plan
from etalon.lib.film.moments import Moments
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.sequential import SequentialTest
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.effect_cases import CASES
from etalon.tests.effect_parts import AREA, CAMERA, CROWDED, CROWDED_LAMP, LAMP, PLAIN, POINT, SLOPED, SUN
from etalon.tests.indoors import indoors, lit
from etalon.tests.neutral import NEUTRAL, TOGETHER
from etalon.tests.scenes import color, glossy, icosphere, scene

NAMES = list(Effect)
# Forced on, these bring another way of finding the same light: the mean stays, the noise does not.
OTHER_ESTIMATORS = ("environment table", "mesh lights")
SAME_SAMPLES = [name for name in NAMES if name not in OTHER_ESTIMATORS]


def small(one):
    """The scene with a coarse sampling table for its world, which is quickly made."""
    return replace(one, world=replace(one.world, table_resolution=(8, 4)))


def image(one, plan, seed, samples=8, replicate=0, **options):
    renderer = ReferenceRenderer(small(one), Options(threads=1, seed=seed, **options), plan)
    rendering = renderer.render(replicate, samples)
    assert not rendering.nonfinite.any()
    return rendering.radiance


def variants(effect, needed):
    """The effect's scenes, with a light.

    They come once more with a floor beneath, where they still need (or do not need) the effect.
    """
    scenes = [lit(one) for one in CASES[effect][0 if needed else 1]]
    scenes += [indoors(scenes[0])]
    return [one for one in scenes if make_plan(one).needs(effect) is needed]


# The default run takes the first scene of one effect in nine.
EACH = pytest.mark.parametrize(
    ("effect", "most"),
    [
        *(pytest.param(name, 1, id=f"{name}-first") for name in NAMES[::9]),
        *(pytest.param(name, 99, id=f"{name}-all", marks=pytest.mark.slow) for name in NAMES),
    ],
)


@EACH
def test_a_scene_that_needs_it(effect, most, seed):
    """All other effects forced on change no bit."""
    assert effect in CASES, f"the effect '{effect}' has no scenes in effect_cases.py"
    for one in variants(effect, True)[:most]:
        plan = make_plan(one)
        planned = image(one, plan, seed)
        np.testing.assert_array_equal(image(one, plan.forcing(*SAME_SAMPLES), seed), planned)
    assert planned.any()


@EACH
def test_a_scene_that_does_not(effect, most, seed):
    """The effect forced on at its neutral value changes no digit that counts.

    All others with it change none either.
    """
    assert effect in NEUTRAL, f"the effect '{effect}' has no neutral value in neutral.py"
    for one in variants(effect, False)[:most]:
        planned = image(one, make_plan(one), seed)
        np.testing.assert_array_equal(image(one, make_plan(one).forcing(*SAME_SAMPLES), seed), planned)
        if effect not in OTHER_ESTIMATORS:
            neutral = NEUTRAL[effect](one)
            forced = image(neutral, make_plan(neutral).forcing(effect, *TOGETHER.get(effect, ())), seed)
            np.testing.assert_allclose(forced, planned, rtol=1e-7, atol=1e-7 * planned.max())


SMOOTH = scene(icosphere(smooth=True, subdivisions=1), glossy(0.3), CAMERA, (POINT, AREA), bounces=1)


@pytest.mark.parametrize(
    "options",
    [{"direct": "lights"}, {"direct": "bsdf"}, {"departures": frozenset({"light below the face"})}],
    ids=["lights", "bsdf", "light below the face"],
)
def test_under_other_options(options, seed):
    """Plans are made before options are known, and hold under all of them."""
    scenes = [SMOOTH, indoors(SMOOTH), CROWDED_LAMP, replace(CROWDED, lights=(AREA, SUN)), replace(PLAIN, world=SLOPED)]
    for one in scenes:
        plan = make_plan(one)
        planned = image(one, plan, seed, **options)
        assert planned.any()
        np.testing.assert_array_equal(image(one, plan.forcing(*SAME_SAMPLES), seed, **options), planned)


NOISY = {
    "constant world": replace(PLAIN, world=World(color(0.2, 0.5, 0.9))),
    "constant world, partly hidden": replace(CROWDED, world=World(color(0.2, 0.5, 0.9))),
    "a body that glows in the sun": replace(LAMP, lights=(SUN,)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", NOISY)
def test_other_ways_of_finding_the_same_light(name, seed):
    """Everything forced on: EQUIVALENT at 0.1 % by the verdict's own test."""
    one = NOISY[name]
    plan = make_plan(one)
    samples = 4096 if "hidden" in name else 1024
    sides = []
    for run, offset in ((plan, 0), (plan.forcing(), 100)):
        means = [image(one, run, seed, samples, offset + k).mean(axis=(0, 1)) for k in range(8)]
        means = np.array(means)[:, None]
        mean = means.mean(axis=0)
        sides.append(Moments(len(means), mean, ((means - mean) ** 2).sum(axis=0)))
    test = SequentialTest(1, 0.001, 0.99)
    test.look(*sides, last=True)
    assert test.outcomes[0] is Outcome.EQUIVALENT


@dataclass(frozen=True)
class Recorder(Plan):
    """A plan that remembers what it was asked."""

    asked: ClassVar[set[str]] = set()

    def needs(self, effect):
        self.asked.add(effect)
        return super().needs(effect)


def asked_by_the_integrator():
    one = small(lit(PLAIN))
    ReferenceRenderer(one, Options(threads=1), Recorder(make_plan(one).decisions)).render(0, 1)
    return sorted(Recorder.asked)


ASKED = asked_by_the_integrator()


def test_every_transport_effect_is_asked_for():
    """What the plan says about light's way decides what runs.

    Lobes, textures and light objects run where there are any.
    """
    effects = list(Effect)
    transport = effects[effects.index(Effect.LIGHT_SAMPLING) :]
    switched = {Effect.DEPTH_OF_FIELD, Effect.HIDDEN_OBJECTS, *transport}
    assert switched <= set(ASKED)


@pytest.mark.grid(3)
@pytest.mark.parametrize("effect", ASKED)
def test_a_plan_that_leaves_out_what_is_needed_is_caught(effect, seed):
    caught = False
    for one in variants(effect, True):
        plan = make_plan(one)
        wrong = Plan(tuple(Decision(d.effect, d.needed and d.effect != effect, d.fact) for d in plan.decisions))
        caught |= not np.array_equal(image(one, wrong, seed), image(one, plan, seed))
    assert caught


def test_planned_scenes_that_nothing_is_left_out_of():
    """Forcing names an effect, or all; a name that is none is refused."""
    forced = make_plan(CROWDED).forcing()
    assert all(forced.needs(name) for name in NAMES)
    only = make_plan(CROWDED).forcing("GGX")
    assert [d.effect for d in only.decisions if d.fact == "forced"] == ["GGX"]
