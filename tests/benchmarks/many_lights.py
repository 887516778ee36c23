# SPDX-License-Identifier: GPL-3.0-or-later
"""What the choice of lights by place gains over a choice by power: measures and prints.

    python tests/benchmarks/many_lights.py [--runs 8] [--samples 16]

A hall of 40 x 40 m with lamps below its ceiling, and `veach_plates`. Efficiency is one over variance times seconds of the
processor, by place over by power; the two take turns.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from etalon.addon.command.opening import open_target
from etalon.addon.job import export
from etalon.lib.lights.selection import LightSelection
from etalon.lib.scene.lights import PointLight, SphereLight
from etalon.lib.scene.materials import Diffuse
from etalon.lib.scene.scene import Scene
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process
from etalon.tests.scenes import color, floor, material, perspective, quad, scene


def hall(count: int, radius: float) -> Scene:
    """A floor and three walls below `count` lamps of `radius` in metres, points where it is 0."""
    places = np.random.default_rng(1).uniform(-20.0, 20.0, (count, 2))
    lights = [
        SphereLight(f"lamp {k}", (float(x), float(y), 2.0), radius, (40.0, 40.0, 40.0))
        if radius
        else PointLight(f"lamp {k}", (float(x), float(y), 2.0), (1.0, 1.0, 1.0))
        for k, (x, y) in enumerate(places)
    ]
    walls = [
        quad((-20.0, -20.0, 0.0), (0.0, 40.0, 0.0), (0.0, 0.0, 3.0), 0),
        quad((20.0, -20.0, 0.0), (0.0, 40.0, 0.0), (0.0, 0.0, 3.0), 0),
        quad((-20.0, 20.0, 0.0), (40.0, 0.0, 0.0), (0.0, 0.0, 3.0), 0),
    ]
    camera = perspective(64, 48, 1.2, (0.0, -18.0, 2.5), (0.0, 1.0, -0.2))
    return scene([floor(20.0), *walls], [material(Diffuse(color(0.8, 0.7, 0.6)))], camera, lights, bounces=3)


def reference(built: Scene, by_place: bool) -> ReferenceRenderer:
    """A renderer that chooses lights by place, or by power."""
    renderer = ReferenceRenderer(built, Options(threads=1))
    if not by_place:
        kernel = renderer.kernel
        kernel._selection = LightSelection(kernel.lights)
    return renderer


def measure(name: str, built: Scene, runs: int, samples: int) -> None:
    """Print the ratios of variance, seconds and efficiency for one scene."""
    ways = {by_place: reference(built, by_place) for by_place in (False, True)}
    images: dict[bool, list[np.ndarray]] = {way: [] for way in ways}
    seconds = dict.fromkeys(ways, 0.0)
    for run in range(runs + 1):  # the first sets up
        for way, renderer in ways.items():
            begin = time.process_time()
            image = renderer.render(run, samples).radiance
            if run:
                seconds[way] += time.process_time() - begin
                images[way].append(image)
    variance = {way: np.var(images[way], axis=0, ddof=1).mean() for way in ways}
    fewer, longer = variance[False] / variance[True], seconds[True] / seconds[False]
    print(f"{name:28} variance / {fewer:5.1f}   seconds x {longer:.2f}   efficiency x {fewer / longer:.1f}", flush=True)


def main() -> None:
    import bpy

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--samples", type=int, default=16)
    given = parser.parse_args()
    for count, radius in ((4, 0.1), (16, 0.1), (64, 0.1), (64, 0.0), (256, 0.0), (1000, 0.0)):
        kind = "spheres" if radius else "points"
        measure(f"hall, {count} {kind}", hall(count, radius), given.runs, given.samples)
    open_target("veach_plates")
    bpy.context.scene.render.resolution_percentage = 25
    measure("veach_plates, a quarter", export(bpy.context.scene), given.runs, given.samples)


if __name__ == "__main__":
    tune_process()
    main()
