# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan runs what a scene calls for: each effect with its cause, and without it."""

import ast
import re
from dataclasses import replace
from pathlib import Path

import etalon
import pytest
from etalon.lib.effects.catalogue import EFFECTS
from etalon.lib.effects.names import Effect, Stage
from etalon.lib.effects.plan import make_plan
from etalon.lib.errors import EtalonError
from etalon.lib.scene.expressions import ZERO, Math, ValueToColor
from etalon.lib.scene.materials import Diffuse, Emission, Glass, Transparent
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.effect_cases import CASES
from etalon.tests.effect_parts import CAMERA, CROWDED, HALF, PLAIN, POINT, of
from etalon.tests.scenes import color, cube, diffuse, floor, material, scene


@pytest.mark.parametrize("effect", [entry.effect for entry in EFFECTS])
def test_cause_and_effect(effect):
    assert effect in CASES, f"the effect '{effect}' has no scenes here that call for it and that do not"
    for the_scene in CASES[effect][0]:
        assert make_plan(the_scene).needs(effect)
    for the_scene in CASES[effect][1]:
        assert not make_plan(the_scene).needs(effect)


@pytest.mark.parametrize("effect", [entry.effect for entry in EFFECTS])
def test_every_decision_gives_its_reason(effect):
    """One line each, whether needed or not, and another one when the answer is another."""
    facts = {True: set(), False: set()}
    for answer, scenes in zip((True, False), CASES[effect], strict=True):
        for the_scene in scenes:
            (decision,) = [d for d in make_plan(the_scene).decisions if d.effect == effect]
            assert decision.needed == answer
            assert decision.fact
            assert "\n" not in decision.fact
            facts[answer].add(decision.fact)
    assert not facts[True] & facts[False]


def test_every_name_has_one_row():
    """In the order of the names, so that a plan reads like them."""
    assert [entry.effect for entry in EFFECTS] == list(Effect)


def bare_names(source):
    """Lines that ask a plan for an effect by a string, not by its name in the enum."""
    if not re.search(r"\b(needs|forcing|lap)\b", source):  # most files: reading takes longer than looking
        return []
    calls = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    asked = (node for node in calls if getattr(node.func, "attr", "") in ("needs", "forcing", "lap"))
    return [node.lineno for node in asked if any(isinstance(argument, ast.Constant) for argument in node.args)]


def test_effects_and_stages_are_asked_for_by_their_names():
    assert bare_names('plan.needs("emission")') == [1]
    root = Path(etalon.__file__).parent
    files = [path for room in ("lib", "addon") for path in sorted((root / room).rglob("*.py"))]
    assert not {path.name: lines for path in files if (lines := bare_names(path.read_text(encoding="utf-8")))}


def test_every_stage_of_an_effect_has_a_clock():
    """Stages are charged by the loop, and nothing else is.

    A stage that no lap names would show no time.
    """
    files = (Path(etalon.__file__).parent / "lib" / "wavefront").glob("*.py")
    source = "".join(file.read_text(encoding="utf-8") for file in files)
    assert {stage.name for stage in Stage} == set(re.findall(r"lap\(Stage\.([A-Z_]+)\)", source))


def test_an_effect_that_is_none_is_refused():
    with pytest.raises(EtalonError, match="no effect is called 'caustics'"):
        make_plan(PLAIN).needs("caustics")


def test_the_material_that_calls_for_it_is_named():
    the_scene = scene(
        [cube(), floor(2.0, -1.0, 1)],
        [material(Emission(), name="Lamp <1>"), material(Diffuse(), name="Floor")],
        CAMERA,
    )
    facts = {d.effect: d.fact for d in make_plan(the_scene).decisions}
    assert "'Lamp <1>'" in facts["emission"]
    assert "'Floor'" not in facts["emission"]
    assert "'Floor'" in facts["Lambert"]


def test_a_material_that_no_face_has_calls_for_nothing():
    unseen = scene(cube(), [diffuse(0.5), material(Emission(), Glass(), Transparent())], CAMERA)
    plan = make_plan(unseen)
    assert not any(plan.needs(effect) for effect in ("emission", "mesh lights", "glass", "transparent surfaces"))


def test_a_constant_behind_nodes_is_still_a_constant():
    """Folding: 0.5 * 0 is no roughness, and a world of constants is a constant world."""
    nothing = Math("MULTIPLY", HALF, ZERO, ZERO)
    assert make_plan(of(Diffuse(color(0.5), nothing))).needs("Lambert")
    world = World(ValueToColor(Math("ADD", HALF, HALF, ZERO)))
    assert make_plan(replace(PLAIN, world=world)).needs("constant world")


def test_what_is_not_called_for_is_not_run(seed):
    """The stage clock has no stage that the plan leaves out.

    No shadow ray is traced where none is needed.
    """

    def stages(the_scene):
        return ReferenceRenderer(the_scene, Options(seed=seed, threads=1)).render(0, 4).stages

    for outdoors in (PLAIN, CROWDED):
        assert not {"shadow rays", "pass through"} & set(stages(replace(outdoors, world=World(color(0.5)))))
    assert "shadow rays" in stages(replace(CROWDED, lights=(POINT,)))
    alone = replace(PLAIN, lights=(POINT,))
    assert not {"shadow rays", "advance"} & set(stages(alone))
    assert ReferenceRenderer(alone, Options(threads=1)).render(0, 4).rays == 16 * 4
    veiled = of(Diffuse(color(0.5)), Transparent(color(0.5)), world=0.5)
    assert "pass through" in stages(veiled)
