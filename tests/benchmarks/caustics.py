# SPDX-License-Identifier: GPL-3.0-or-later
"""How often a verdict is wrong where light is rare.

Cycles without its caustics is compared with the reference, and both with them.

    python tests/benchmarks/caustics.py [--runs 25] [--time 10]

Four scenes with a small lamp over a dark floor: a mirror ball, a ball of clear glass, a standing mirror, and a ball
of narrow gold. What each cell truly lacks without caustics is known from a long pass of light tracing. A run is false
if a cell that lacks more than the tolerance is EQUIVALENT, or, with caustics on both sides, if any region is
DIFFERENT. Beside it stands what the verdicts do find: the part of the other cells that are EQUIVALENT.
"""

from __future__ import annotations

import argparse

import bpy
import numpy as np
from etalon.addon.cycles.renderer import neutral
from etalon.addon.cycles.settings import CyclesWith
from etalon.addon.host.quiet import quiet
from etalon.addon.job import export
from etalon.lib.comparison.caustics import caustics_in, scout
from etalon.lib.comparison.compare import CompareOptions, Comparison, compare
from etalon.lib.comparison.run import TimedRun
from etalon.lib.light_tracing.scouting import scout_caustics
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.coverage import coverage
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process
from etalon.reference_scenes import building

SIDE, TOLERANCE, LONG = 96, 0.01, 1 << 21
OFF = {"caustics_reflective": False, "caustics_refractive": False}


def glass(name: str) -> bpy.types.Material:
    """Clear glass of index 1.5 or so, Blender's default."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    glass, out = tree.nodes.new("ShaderNodeBsdfGlass"), tree.nodes.new("ShaderNodeOutputMaterial")
    glass.inputs["Roughness"].default_value = 0.0
    tree.links.new(glass.outputs[0], out.inputs[0])
    return made


def _mirror_ball() -> None:
    building.sphere("Ball", building.glossy("Mirror", "GGX", 0.0, (0.95,) * 3), (0.0, 0.45, 0.25), 0.25, 128, 64)


def _glass_ball() -> None:
    building.sphere("Ball", glass("Glass"), (0.0, 0.45, 0.3), 0.25, 128, 64)


def _standing_mirror() -> None:
    mirror = building.glossy("Mirror", "GGX", 0.0, (0.95,) * 3)
    building.rectangle("Mirror", mirror, (0.0, 1.0, 0.4), (0.8, 0.0, 0.0), (0.0, 0.0, 0.8))


def _gold_ball() -> None:
    building.sphere("Ball", building.glossy("Gold", "GGX", 0.02, (1.0, 0.78, 0.34)), (0.0, 0.45, 0.25), 0.25, 128, 64)


SCENES = {
    "mirror ball": _mirror_ball,
    "glass ball": _glass_ball,
    "standing mirror": _standing_mirror,
    "gold ball": _gold_ball,
}


def build(name: str) -> bpy.types.Scene:
    """The scene of that name: floor, lamp of 3 cm, camera, and what casts the caustic."""
    scene = building.start(name, SIDE, SIDE, 4)
    floor = building.diffuse("Floor", (0.05, 0.05, 0.05))
    building.rectangle("Floor", floor, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    SCENES[name]()
    building.sphere_light("Lamp", (0.0, -1.2, 2.75), 0.03, (11_000.0,) * 3)
    building.camera((0.0, -1.2, 1.6), (0.0, 0.05, 0.0), lens=60.0)
    return scene


def run(scene: bpy.types.Scene, exported: object, values: dict[str, bool], seed: int, seconds: float) -> Comparison:
    """One comparison, with `values` of Cycles' settings on the candidate's side."""
    reference = ReferenceRenderer(exported, Options(seed=2 * seed))
    candidate = CyclesWith(scene, values, seed=2 * seed + 1, threads=2)
    scouted = scout(reference.kernel, TimedRun(seconds, NO_PROGRESS))
    options = CompareOptions(time=seconds, tolerance=TOLERANCE)
    return compare(exported, reference, candidate, coverage(reference.kernel), options, scouted=scouted)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=25)
    parser.add_argument("--time", type=float, default=10.0)
    arguments = parser.parse_args()
    for name in SCENES:
        with quiet():
            scene = build(name)
            exported = export(scene)
            truth = scout_caustics(ReferenceRenderer(exported).kernel, LONG)
            results = {}
            with neutral(scene, threads=2):
                for kind, values in (("off", OFF), ("on", {})):
                    results[kind] = [
                        run(scene, exported, values, seed, arguments.time) for seed in range(arguments.runs)
                    ]
        report(name, results, truth)


def report(name: str, results: dict[str, list[Comparison]], truth: object) -> None:
    """One line for a scene."""
    missed, lacking, found, alarms = 0, [], [], 0
    for comparison in results["off"]:
        verdict = comparison.verdict
        share = caustics_in(truth, comparison.regions).share(verdict.reference, verdict.floor)
        lost, agree = share > 1.1 * TOLERANCE, verdict.outcomes == Outcome.EQUIVALENT
        missed += bool((lost & agree).any())
        lacking.append(int(lost.sum()))
        found.append(float(np.mean(agree[~lost])) if (~lost).any() else 1.0)
    for comparison in results["on"]:
        alarms += bool((comparison.verdict.outcomes == Outcome.DIFFERENT).any())
    runs = len(results["off"])
    print(
        f"{name:16} {np.median(lacking):4.0f} regions lack more than {TOLERANCE:.0%}; called EQUIVALENT in {missed} of {runs} runs; "
        f"of the others {np.mean(found):.0%} EQUIVALENT; with caustics on both sides a false DIFFERENT in {alarms} of {runs}",
        flush=True,
    )


if __name__ == "__main__":
    tune_process()
    main()
