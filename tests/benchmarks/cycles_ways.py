# SPDX-License-Identifier: GPL-3.0-or-later
"""Which unbiased settings of Cycles need the least time for the same noise in the verdict's regions.

    python tests/benchmarks/cycles_ways.py [SCENE ...] [--runs 12] [--samples 32] [--size 50]

Each way is the neutral state with some settings of Cycles changed that change noise and not the mean. The ways take turns.
Efficiency is one over variance times seconds of the processor, over that of the neutral state. The variance is that of means of
blocks of 16 x 16 pixels, over their mean squared, averaged over the blocks that are lit. The last column is the mean over all
pixels beside that of the neutral state, with the standard error of the difference: a way without bias stays within some three
of them.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import bpy
import numpy as np
from etalon.addon.command.opening import open_target
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.lib.wavefront.tuning import tune_process

SCENES = ("glossy_spheres", "veach_plates", "cornell_glossy", "lambert_analytic")
HALLS = {f"hall of {count} lamps": count for count in (4, 16, 64)}
WAYS: dict[str, dict[str, Any]] = {
    "neutral": {},
    "light tree off": {"use_light_tree": False},
    "threshold off too": {"use_light_tree": False, "light_sampling_threshold": 0.0},
}
BLOCK = 16


def make_hall(count: int) -> None:
    """A floor and a back wall of 40 m below `count` small lamps."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = 256, 192
    mesh = bpy.data.meshes.new("hall")
    corners = [(-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0), (20, 20, 3), (-20, 20, 3)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3), (3, 2, 4, 5)])
    scene.collection.objects.link(bpy.data.objects.new("hall", mesh))
    for k, (x, y) in enumerate(np.random.default_rng(1).uniform(-20.0, 20.0, (count, 2))):
        lamp = bpy.data.lights.new(f"lamp {k}", "POINT")
        lamp.energy, lamp.shadow_soft_size = 20.0, 0.05
        placed = bpy.data.objects.new(lamp.name, lamp)
        placed.location = (x, y, 2.0)
        scene.collection.objects.link(placed)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.0, -18.0, 2.5), (1.37, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera


def blocks(image: np.ndarray) -> np.ndarray:
    """Means of whole blocks (rows, columns, 3)."""
    rows, columns = (side // BLOCK for side in image.shape[:2])
    whole = image[: rows * BLOCK, : columns * BLOCK]
    return whole.reshape(rows, BLOCK, columns, BLOCK, 3).mean(axis=(1, 3))


def measure(name: str, runs: int, samples: int, size: int) -> None:
    """Print a row for each way."""
    if name in HALLS:
        make_hall(HALLS[name])
    else:
        open_target(name)
    scene = bpy.context.scene
    scene.render.resolution_percentage = size
    means: dict[str, list[np.ndarray]] = {way: [] for way in WAYS}
    seconds = dict.fromkeys(WAYS, 0.0)
    with neutral(scene, threads=2):
        renderer = CyclesRenderer(scene, threads=2)
        usual = {key: getattr(scene.cycles, key) for settings in WAYS.values() for key in settings}
        for run in range(runs + 1):  # the first sets up
            for way, settings in WAYS.items():
                for key, value in {**usual, **settings}.items():
                    setattr(scene.cycles, key, value)
                begin = time.process_time()
                image = renderer.render(run, samples).radiance
                if run:
                    seconds[way] += time.process_time() - begin
                    means[way].append(blocks(image))
        for key, value in usual.items():
            setattr(scene.cycles, key, value)
    lit = np.mean(means["neutral"], axis=0) > 1e-3 * np.mean(means["neutral"])
    noise = {
        way: (np.var(found, axis=0, ddof=1) / np.mean(found, axis=0) ** 2)[lit].mean() for way, found in means.items()
    }
    whole = {way: np.array([image.mean() for image in found]) for way, found in means.items()}
    for way in WAYS:
        fewer, longer = noise["neutral"] / noise[way], seconds[way] / seconds["neutral"]
        apart = whole[way] - whole["neutral"]
        error = np.sqrt((whole[way].var(ddof=1) + whole["neutral"].var(ddof=1)) / runs)
        relative = 100.0 / whole["neutral"].mean()
        print(
            f"{name:18} {way:18} variance / {fewer:5.2f}   seconds x {longer:.2f}   efficiency x {fewer / longer:.2f}"
            f"   mean {apart.mean() * relative:+.3f} % +- {error * relative:.3f} %",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", default=(*SCENES, *HALLS))
    parser.add_argument("--runs", type=int, default=12)
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--size", type=int, default=50, help="per cent of each scene's resolution")
    given = parser.parse_args()
    for name in given.scenes:
        measure(name, given.runs, given.samples, given.size)


if __name__ == "__main__":
    tune_process()
    main()
