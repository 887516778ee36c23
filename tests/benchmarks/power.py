# SPDX-License-Identifier: GPL-3.0-or-later
"""How often a verdict is right, with the real renderers.

Measured are false alarms, and a planted bias found at the cost that was forecast.

    python tests/benchmarks/power.py [--runs 100] [--bias 0.01] [--tolerance 0.005]

Two glossy strips side by side under a lamp. In a null run both renderers get the same scene: the reference against
itself under other seeds, Cycles against itself, and Cycles against the reference. In a planted run the second one's
right-hand strip is brighter by the bias. Each run looks after eight replicates, takes the forecast that it is given
there, and begins anew with fresh seeds and as many replicates as the forecast's upper end names (27 where all was
decided, 300 at most); found means: the strip DIFFERENT and the other one not.
"""

from __future__ import annotations

import argparse
import math

import bpy
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.job import export
from etalon.lib.comparison.compare import CompareOptions, Comparison, Renderer, compare
from etalon.lib.comparison.run import Stop
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.coverage import coverage
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process
from etalon.reference_scenes import building

SIDE, SAMPLES, FIRST, NULL, MOST = 32, 32, 8, 27, 300
COLOR = 0.8


def strips(factor: float) -> bpy.types.Scene:
    """Two strips; the right one's colour times `factor`."""
    scene = building.start("strips", SIDE, SIDE, 1)
    building.world((0.2, 0.2, 0.2))
    for k, (name, part) in enumerate((("Left", 1.0), ("Right", factor))):
        material = building.glossy(name, "GGX", 0.3, (COLOR * part,) * 3)
        building.rectangle(name, material, (k - 0.5, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    building.area_light("Lamp", (0.0, 1.5, 1.5), (0.0, 0.0, 0.0), (1.0, 1.0), (4.0, 4.0, 4.0))
    building.camera((0.0, -3.0, 3.0), (0.0, 0.0, 0.0), lens=80.0)
    return scene


def verdict(first: Renderer, second: Renderer, exported: object, replicates: int, tolerance: float) -> Comparison:
    """One comparison of so many replicates."""
    regions = coverage(first.kernel) if isinstance(first, ReferenceRenderer) else {}
    options = CompareOptions(time=None, samples=SAMPLES, replicates=replicates, tolerance=tolerance)
    return compare(exported, first, second, regions, options)


def run(pair: str, factor: float, seed: int, tolerance: float) -> tuple[Comparison, int]:
    """The second comparison of one run, and its replicates."""
    plain = export(strips(1.0))
    if pair == "reference, reference":
        planted = export(strips(factor))
        made = [
            lambda s: ReferenceRenderer(plain, Options(seed=s)),
            lambda s: ReferenceRenderer(planted, Options(seed=s + 1)),
        ]
    elif pair == "reference, Cycles":
        scene = strips(factor)
        made = [lambda s: ReferenceRenderer(plain, Options(seed=s)), lambda s: CyclesRenderer(scene, seed=s, threads=2)]
    else:
        scene = strips(1.0)
        made = [
            lambda s: CyclesRenderer(scene, seed=s, threads=2),
            lambda s: CyclesRenderer(scene, seed=s + 1, threads=2),
        ]
    with neutral(bpy.context.scene, threads=2):
        pilot = verdict(*(make(4 * seed) for make in made), plain, FIRST, tolerance)
        told = pilot.verdict.forecast
        replicates = NULL if told is None else min(math.ceil(FIRST * told.high), MOST)
        return verdict(*(make(4 * seed + 2) for make in made), plain, replicates, tolerance), replicates


def found(comparison: Comparison) -> bool:
    """Whether the right-hand strip, and not the other, is DIFFERENT."""
    named = {
        name: outcome
        for kind, name, outcome in zip(
            comparison.regions.kinds, comparison.regions.names, comparison.verdict.outcomes, strict=True
        )
        if kind == "material"
    }
    return named["Right"] is Outcome.DIFFERENT and named["Left"] is not Outcome.DIFFERENT


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--bias", type=float, default=0.01)
    parser.add_argument("--tolerance", type=float, default=0.005)
    arguments = parser.parse_args()
    for pair, factors in (
        ("reference, reference", (1.0, 1.0 + arguments.bias)),
        ("Cycles, Cycles", (1.0,)),
        ("reference, Cycles", (1.0, 1.0 + arguments.bias)),
    ):
        for factor in factors:
            results = [run(pair, factor, seed, arguments.tolerance) for seed in range(arguments.runs)]
            spent = sorted(replicates for _, replicates in results)
            alarms = sum(Outcome.DIFFERENT in set(c.verdict.outcomes) for c, _ in results)
            hits = f"found in {sum(found(c) for c, _ in results)}" if factor != 1.0 else f"false alarms in {alarms}"
            decided = sum(c.stopped is Stop.DECIDED for c, _ in results)
            print(
                f"{pair:21} bias {factor - 1:.1%}: {hits} of {arguments.runs} runs; all decided in {decided}; "
                f"forecast {spent[len(spent) // 2]} replicates of {SAMPLES} samples in the median",
                flush=True,
            )


if __name__ == "__main__":
    tune_process()
    main()
