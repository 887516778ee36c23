# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera samples per second, the reference beside Cycles: measures and prints.

Both have the same scene, threads and bounces.

    python tests/benchmarks/throughput.py [SCENE ...] [--threads 2] [--runs 5] [--samples 64]

The two take turns, A B A B, so that a machine that speeds up or slows down does so for both; the ratio is the median
of the pairs'. The clock runs around rendering alone: for Cycles around the render call (its scene synchronisation
included, the file's writing too), for the reference around a replicate.
"""

from __future__ import annotations

import argparse
import statistics

from etalon.addon.command.opening import open_target
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.job import export
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process

SCENES = ("glossy_spheres", "veach_plates", "cornell_glossy")


def measure(name: str, threads: int, runs: int, samples: int) -> None:
    import bpy

    open_target(name)
    scene = bpy.context.scene
    exported = export(scene)
    with neutral(scene, threads=threads):
        candidate = CyclesRenderer(scene, threads=threads)
        reference = ReferenceRenderer(exported, Options(threads=threads))
        for renderer in (reference, candidate):
            renderer.render(1 << 20, 1)
        rates: dict[str, list[float]] = {"reference": [], "Cycles": []}
        stages: dict[str, float] = {}
        for replicate in range(runs):
            for label, renderer in (("reference", reference), ("Cycles", candidate)):
                done = renderer.render(replicate, samples)
                rates[label].append(done.camera_samples / done.seconds / 1e6)
                if label == "reference":
                    stages = done.stages
    ratios = [a / b for a, b in zip(rates["reference"], rates["Cycles"], strict=True)]
    total = sum(stages.values())
    embree = (stages.get("intersect", 0.0) + stages.get("shadow rays", 0.0)) / total
    print(
        f"{name:16} reference {statistics.median(rates['reference']):6.3f} M/s   Cycles {statistics.median(rates['Cycles']):6.3f} M/s"
        f"   ratio {statistics.median(ratios):5.2f} ({min(ratios):.2f} to {max(ratios):.2f})   ray queries {embree:4.0%}"
    )
    print(
        "   "
        + ", ".join(f"{stage} {seconds / total:.0%}" for stage, seconds in sorted(stages.items(), key=lambda x: -x[1]))
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--samples", type=int, default=64)
    arguments = parser.parse_args()
    for name in arguments.scenes:
        measure(name, arguments.threads, arguments.runs, arguments.samples)


if __name__ == "__main__":
    tune_process()
    main()
